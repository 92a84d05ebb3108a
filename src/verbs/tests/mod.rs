mod cost;
mod hostile;
mod json;
mod motion;
mod read;
mod rest;
mod samples;
mod shape;
mod stability;

use crate::report::json::Tool;
use crate::report::{terminal, verdict::verdict};
use crate::verbs::formats::{FORMATS, format};
use crate::verbs::tests::data::*;
use hostile::{extreme, hostile};
use samples::{Reach, crowd, empty, oscillator, outcome, twin, upright};
use unicode_width::UnicodeWidthStr;

/// Reports of every kind the renderers meet.
fn all() -> Vec<Report> {
    let mut bare = empty("bare");
    bare.header.checks.clear();
    bare.header.scene.effects.clear();
    let mut unsupported = empty("unsupported");
    let mut rapier = outcome("rapier", SolverKind::Rapier, 0.01);
    rapier.status = Status::Unsupported;
    rapier.reason = Some("isotropic damping has no joint".into());
    unsupported.outcomes_mut().push(rapier);
    vec![
        extreme(),
        bare,
        unsupported,
        oscillator(&[0.01], 5.0, 8),
        oscillator(&[0.01, 0.05, 0.15], 5.0, 8),
        oscillator(&[0.15], 30.0, 9),
        oscillator(&[0.0005], 5.0, 9),
        hostile(),
        upright(),
        crowd(),
        stability::limits(),
        stability::mapped(),
        stability::pair(),
        stability::odd(),
        rest::found(),
        rest::falling(),
        cost::samples::priced(),
        cost::samples::full(),
        cost::samples::counted(),
        cost::samples::untrue(),
        cost::samples::classic(),
        cost::samples::odd(),
    ]
}

/// The text without its ANSI sequences, which the terminal reports write as `ESC [ ... m`.
fn plain(text: &str) -> String {
    let mut parts = text.split('\u{1b}');
    let mut plain = parts.next().unwrap().to_string();
    for part in parts {
        plain += part.split_once('m').unwrap().1;
    }
    plain
}

#[test]
fn terminal_lines_fit() {
    for report in all() {
        for line in plain(&terminal::render(report.view())).lines() {
            assert!(
                line.width() <= terminal::WIDTH,
                "{} columns: {line}",
                line.width()
            );
            assert!(!line.contains(|c: char| c.is_control()), "{line:?}");
        }
    }
}

#[test]
fn rendering_is_repeatable() {
    for report in all() {
        let reports = [report];
        for format in FORMATS {
            assert_eq!(
                (format.render)(&Tool::this(), &reports),
                (format.render)(&Tool::this(), &reports),
                "{}",
                format.id
            );
        }
        assert_eq!(reports[0].svg(), reports[0].svg());
    }
}

#[test]
fn formats_are_found_by_their_id() {
    for row in FORMATS {
        assert_eq!(format(row.id).unwrap().extension, row.extension);
    }
    assert!(format("no such").is_none());
}

#[test]
fn figures_are_well_formed_and_small() {
    for report in all() {
        for (file, svg) in report.svg() {
            roxmltree::Document::parse(&svg).unwrap_or_else(|e| panic!("{file}: {e}"));
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{file}");
            // Panels of 25 methods take most, some 12 kB each.
            assert!(svg.len() < 340_000, "{file}: {} bytes", svg.len());
        }
    }
}

#[test]
fn long_series_stay_small_and_keep_their_peak() {
    let mut report = oscillator(&[0.01], 5.0, 8);
    for curves in &mut report.series_mut().curves {
        curves.t = (0..2_000).map(|i| f64::from(i) / 400.0).collect();
        curves.energy = curves.t.iter().map(|t| (9_973.0 * t).sin()).collect();
        curves.plot = curves.energy.clone();
        curves.plot[1_234] = 7.0;
        let path: Vec<[f64; 2]> = curves
            .t
            .iter()
            .map(|t| [(999.0 * t).sin(), (777.0 * t).cos()])
            .collect();
        curves.paths = vec![path; 12];
    }
    report.series_mut().plot.as_mut().unwrap().y_range = Some([-7.0, 7.0]);
    for (file, svg) in report.svg() {
        assert!(svg.len() < 300_000, "{file}: {} bytes", svg.len());
        // The panel's upper edge, y = 40, is where 7 lies: the one sample there was not thinned out.
        assert!(
            file != "plot.svg" || svg.matches(" 40L").count() >= 8,
            "{file}"
        );
    }
}

#[test]
fn markdown_links_the_figures_and_keeps_its_tables() {
    for report in all() {
        let text = report.markdown();
        for (file, _) in report.svg() {
            assert!(text.contains(&format!("]({file})")), "{file}");
        }
        let bars = |line: &str| line.replace("\\|", "").matches('|').count();
        let mut width = 0;
        for line in text.lines() {
            if !line.starts_with('|') {
                width = 0;
            } else if width == 0 {
                width = bars(line);
            } else {
                assert_eq!(bars(line), width, "{line}");
            }
        }
        assert!(!text.contains("<c>"), "HTML left alive");
    }
}

#[test]
fn verdict_names_a_failed_proof_first() {
    let mut report = oscillator(&[0.01], 5.0, 8);
    insta::assert_snapshot!(verdict(&report.view()), @r"symplectic_euler is off by at most 0.71 % of its energy; growing: explicit_euler; dissipating: implicit_euler; 5 others bounded; twin proof holds (2 of 2).");
    report
        .header
        .checks
        .push(twin("twin_forces", CheckStatus::Fail));
    assert!(verdict(&report.view()).starts_with("THE TWIN PROOF FAILS"));
}

#[test]
fn terminal_reads_at_a_glance() {
    let text = plain(&terminal::render(oscillator(&[0.01], 5.0, 8).view()));
    insta::assert_snapshot!(text, @r"
    circle  2 particles, 1 spring, 5 s at h = 0.01 s, symplectic_euler
    A spring of rest length 0, started sideways: the truth is an ellipse.

    symplectic_euler is off by at most 0.71 % of its energy; growing: explicit_euler; twin proof holds.

                                                        m from         m from  force
      engine            status     energy               rapier  rapier-forces  evals          time
    ──────────────────────────────────────────────────────────────────────────────────────────────
    ▸ symplectic_euler  completed  bounded     ±7.1e-3    0.13              0    500  1.23 ms ±16%
      explicit_euler    completed  growing     +11         1.3            1.2    500  1.23 ms ±16%
      midpoint          completed  bounded     ±3.1e-3    0.13          0.017    500  1.23 ms ±16%
      velocity_verlet   completed  bounded     ±2.0e-4    0.13          0.018    500  1.23 ms ±16%
      rk4               completed  steady      ±8.7e-7    0.13          0.021    500  1.23 ms ±16%
      implicit_euler    completed  dissipating -0.92      0.22           0.35    500  1.23 ms ±16%
      rapier, dt/4      completed  bounded     ±0.46         -           0.13      -  1.23 ms ±16%
      rapier-forces     completed  bounded     ±7.1e-3    0.13              -    500  1.23 ms ±16%
    ▸ own integrator | energy: largest error in units of the scene's energy S = 10.75 J | steady: off by
    less than a millionth of S | m from: largest distance of a particle

    - rapier: its spring joint is linearly implicit Euler at h = dt/4 and dissipates by design;
      symplectic_euler does not.

    pass  twin_forces     rapier-forces = symplectic_euler, 20 steps  1.1e-16 <= 3.0e-13
    pass  twin_converged  rapier-forces = symplectic_euler, 20 steps  1.1e-16 <= 3.0e-13

    truth    none (not asked for)
    effects  springs on 1: 70,000 evaluations, 11.4 ns each
    ");
}

/// `SPRINGCHECK_PICTURES=dir cargo test pictures`: everything rendered, to look at.
#[test]
fn pictures() {
    let Ok(directory) = std::env::var("SPRINGCHECK_PICTURES") else {
        return;
    };
    for (i, report) in all().iter().enumerate() {
        for (file, svg) in report.svg() {
            std::fs::write(format!("{directory}/{i}-{file}"), svg).unwrap();
        }
        std::fs::write(format!("{directory}/{i}.md"), report.markdown()).unwrap();
        std::fs::write(
            format!("{directory}/{i}.txt"),
            terminal::render(report.view()),
        )
        .unwrap();
    }
}

/// Everything reports are made of.
mod data {
    pub use crate::measure::stability::{Cell, TightestLimit};
    pub use crate::measure::{Check, CheckStatus, Deviation, Energy, EnergyClass, ErrorSummary};
    pub use crate::report::{EffectUse, Header, SceneFacts, TruthFacts};
    pub use crate::solvers::{SolverKind, Status};
    pub use crate::truth::TruthKind;
    pub use crate::verbs::clock::WallTime;
    pub use crate::verbs::cost::{
        Cost, CostCurve, CostLine, CostPanel, CostPanels, CostPoint, CostRank, CostReached,
        CostTarget,
    };
    pub use crate::verbs::rest::{AtRest, Balance, Moved, Oscillation, Refined, Trend};
    pub use crate::verbs::run::{Curves, Outcome, PlotAxis, RunSeries, WorkSummary};
    pub use crate::verbs::stability::{
        Admissible, AdmissiblePanel, MapPanel, Stability, StabilityMap, StabilityRow,
    };
    pub use crate::verbs::{Body, Report, Series, SeriesState};
}
