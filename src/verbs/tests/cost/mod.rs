//! Reports of costs: each claim of the text and of the figures against the data.

mod figures;
pub mod samples;

use super::plain;
use super::samples::Reach;
use crate::report::json::{self, Tool};
use crate::report::{terminal, verdict::verdict};
use crate::verbs::tests::data::*;
use samples::*;

#[test]
fn costs_read_at_a_glance() {
    let text = plain(&terminal::render(priced().view()));
    insta::assert_snapshot!(text, @r"
    circle  2 particles, 1 spring, 5 s at h = 0.01 s, symplectic_euler
    A spring of rest length 0, started sideways: the truth is an ellipse.

    cheapest to 1e-6 m: pefrl at h = 0.0126 s, 95.5 µs; no integrator reaches 1e-15 m.

    1e-2 m: pefrl at h = 0.172 s, 6.96 µs (116 evaluations); velocity_verlet 1.1x; rk4 1.7x; dopri5
      3.6x; symplectic_euler 13x; explicit_euler 76x; beside them, not ranked: rapier at h = 0.00523 s,
      1.91 ms, 270x; not reached by rapier-forces (isotropic damping has no joint)

    1e-6 m: pefrl at h = 0.0126 s, 95.5 µs (1,592 evaluations); dopri5 1.7x; rk4 1.7x; velocity_verlet
      15x; not reached by symplectic_euler (nearest 9.7e-5 m at the settings tried), explicit_euler
      (5.8e-4); not reached by rapier (nearest 1.0e-3 m at the settings tried), rapier-forces (isotropic
      damping has no joint)

    1e-15 m: no integrator reaches it: symplectic_euler (nearest 9.7e-5 m at the settings tried),
      explicit_euler (5.8e-4), velocity_verlet (7.5e-9), rk4 (4.2e-13), pefrl (3.3e-13), dopri5
      (8.0e-10); not reached by rapier (nearest 1.0e-3 m at the settings tried), rapier-forces
      (isotropic damping has no joint)

                                                   1e-2 m             1e-6 m   smallest   energy
      engine            order  slope          h (s), time        h (s), time  error (m)    error
    ────────────────────────────────────────────────────────────────────────────────────────────
    ▸ symplectic_euler      1   1.00     0.00218  91.7 µs                  -     9.7e-5   2.9e-5
      explicit_euler        1   1.00     3.79e-4   528 µs                  -     5.8e-4   1.7e-4
      velocity_verlet       2   2.00      0.0301  7.47 µs   1.58e-4  1.43 ms     7.5e-9   2.2e-9
      rk4                   4   4.00      0.0725  11.6 µs   0.00523   161 µs      floor  1.3e-13
      pefrl                 4   4.00       0.172  6.96 µs    0.0126  95.5 µs      floor  1.0e-13
      dopri5                5   5.02  tol 1e-3  ≤ 25.2 µs  tol 1e-7   158 µs    8.0e-10  2.0e-10
    † rapier                -      -     0.00523  1.91 ms                  -     1.0e-3   9.1e-4
    † rapier-forces         -      -                    -                  -          -        -
    ▸ own integrator | order: as stated | slope: of error over step, as found | tol: tolerance of an
    adaptive pair | ≤: at the coarsest setting tried | floor: not told from the truth | † explained, not
    ranked | left out for width: settings

    error (m) over wall time (median)
        1e0┤ a          b
           │  c   a   d a    b A  b  A
           │       c         a    a    b  A  b A
       1e-2┤┈┈┈┈┈┈┈┈┈┈┈┈c┈┈┈┈┈┈┈f┈┈┈┈┈┈a┈┈┈┈┈a┈┈┈┈b┈┈A┈b┈┈A┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈ 1e-2 m
           │               d  c   f               a          b A     A              A rapier
           │                 e     c                   a     a    b                 b explicit_euler
       1e-4┤                    d    f  c                         a                 a symplectic_euler
           │                            f     c
       1e-6┤┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈e┈┈┈d┈┈┈┈┈┈┈┈┈┈┈┈c┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈ 1e-6 m
           │                               f            c
           │                            e  d  f              c
       1e-8┤                                    f                  c                c velocity_verlet
           │                                 e  d
           │                                       f                                f dopri5
      1e-10┤                                      e   d
           │
           │════════════════════════════════════════════e══d═══════════════════════ floor
      1e-12┤                                                 e  d e  d  e  d e      d rk4
           │                                                                        e pefrl
           │
      1e-14┤
           │┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈ 1e-15 m
           └┴─────────────┴─────────────┴─────────────┴─────────────┴─────────────┴
          1 µs          10 µs        100 µs         1 ms          10 ms        100 ms
    where several meet, the first of them is shown | ┈ target | ═ floor

    - symplectic_euler, velocity_verlet, rk4 and pefrl: diverged at h = 0.417 s
    - explicit_euler: diverged at h = 0.417, 0.172 and 0.0725 s
    - rapier: its spring joint is linearly implicit Euler at h = dt/4 and dissipates by design; its
      bodies are in single precision
    - rapier-forces: unsupported: isotropic damping has no joint

    truth    closed form, harmonic oscillator, good to 4.0e-13 m up to 5 s
    errors   the largest distance of a particle from the truth up to 5 s, the whole run
    floor    4e-12 m: errors below ten times the truth's own bar are not told apart
    ");
}

#[test]
fn verdict_leads_with_the_hardest_target_somebody_reaches() {
    insta::assert_snapshot!(verdict(&priced().view()), @r"cheapest to 1e-6 m: pefrl at h = 0.0126 s, 95.5 µs; symplectic_euler, the scene's own, does not reach it; to 1e-2 m: pefrl at h = 0.172 s, 6.96 µs; no integrator reaches 1e-15 m.");
    insta::assert_snapshot!(verdict(&untrue().view()), @r"nobody can be said to reach 1e-3 and 1e-6 m: there is no truth: it is chaotic from the start.");
    let mut report = priced();
    report.cost_mut().targets.remove(2);
    report.header.scene.own_integrator = "velocity_verlet".into();
    insta::assert_snapshot!(verdict(&report.view()), @r"cheapest to 1e-6 m: pefrl at h = 0.0126 s, 95.5 µs; velocity_verlet, the scene's own, takes 15x the time; to 1e-2 m: pefrl at h = 0.172 s, 6.96 µs.");
    report.cost_mut().targets.clear();
    assert_eq!(verdict(&report.view()), "no target was asked about.");
}

#[test]
fn files_and_figures_are_those_of_costs() {
    assert_eq!(priced().stem(), "cost");
    let drawn = |report: &Report| -> Vec<&str> {
        let figures = report.svg().into_iter();
        figures.map(|(file, _)| file).collect()
    };
    let [time, evaluations, energy] = ["cost_time.svg", "cost_evaluations.svg", "cost_energy.svg"];
    assert_eq!(drawn(&priced()), [time, evaluations, energy]);
    assert_eq!(drawn(&counted()), [evaluations, energy]);
    assert_eq!(drawn(&untrue()), [energy]);
    assert_eq!(
        drawn(&classic()),
        [time, evaluations, energy, "cost_panels.svg"]
    );
}

/// The text after the label of a target's paragraph, its lines joined.
fn paragraph(report: &Report, label: &str) -> String {
    let text = plain(&terminal::render(report.view()));
    let lines = text
        .lines()
        .skip_while(|line| !line.starts_with(&format!("{label}: ")));
    let lines: Vec<&str> = lines.take_while(|line| !line.is_empty()).collect();
    let joined: Vec<&str> = lines.iter().map(|line| line.trim()).collect();
    joined.join(" ")
}

/// Who is named in the paragraph's clauses or a table's rows comes as in the data, also if the data's
/// order is not that of the prices.
#[test]
fn rankings_keep_the_order_of_the_data() {
    let mut report = priced();
    for turn in 0..2 {
        if turn == 1 {
            let cost = report.cost_mut();
            cost.targets[0].ranking.reverse();
        }
        let ranking = &report.cost().unwrap().targets[0].ranking;
        let names: Vec<&str> = ranking.iter().map(|rank| rank.engine.as_str()).collect();
        let text = paragraph(&report, "1e-2 m");
        let clauses: Vec<&str> = text["1e-2 m: ".len()..].split("; ").collect();
        for (name, clause) in names.iter().zip(&clauses) {
            assert!(clause.starts_with(&format!("{name} ")), "{name}: {clause}");
        }
        let text = report.markdown();
        let table = text.split("## To 1e-2 m").nth(1).unwrap();
        let rows = table.lines().filter(|line| line.starts_with("| ")).skip(1);
        for (name, row) in names.iter().zip(rows) {
            let cell = row.split('|').nth(2).unwrap();
            assert_eq!(cell.trim().trim_matches('*'), *name);
        }
    }
}

#[test]
fn who_does_not_reach_a_target_is_named_with_the_reason_once() {
    let report = priced();
    let text = paragraph(&report, "1e-15 m");
    assert!(
        text.starts_with("1e-15 m: no integrator reaches it: "),
        "{text}"
    );
    assert_eq!(text.matches("symplectic_euler").count(), 1);
    assert_eq!(
        text.matches("(nearest 9.7e-5 m at the settings tried)")
            .count(),
        1
    );
    let mut report = priced();
    for rank in &mut report.cost_mut().targets[2].ranking {
        rank.reason = Some("the budget ended".into());
    }
    let text = paragraph(&report, "1e-15 m");
    assert_eq!(text.matches("the budget ended").count(), 1, "{text}");
    assert!(
        text.contains("pefrl and dopri5 (the budget ended)"),
        "{text}"
    );
}

#[test]
fn unjudged_targets_are_one_paragraph() {
    let text = paragraph(&untrue(), "1e-3 and 1e-6 m");
    assert_eq!(
        text,
        "1e-3 and 1e-6 m: there is no truth: it is chaotic from the start"
    );
    assert!(!untrue().markdown().contains("## To "));
}

#[test]
fn fewest_evaluations_are_said_where_somebody_else_is_fastest() {
    let mut report = priced();
    let text = paragraph(&report, "1e-6 m");
    assert!(!text.contains("fewest"), "{text}");
    let target = &mut report.cost_mut().targets[1];
    target.fewest_evaluations = target.ranking[1].reached.clone();
    let text = paragraph(&report, "1e-6 m");
    let said =
        "fewest evaluations: dopri5 at tolerance 1e-7 (mean h = 0.0133 s), 2,265 evaluations";
    assert!(text.contains(said), "{text}");
}

/// One engine with points that lie on decades of both axes.
fn decades(engine: &str, cost: &[(f64, f64)]) -> CostCurve {
    let mut curve = curve(LINES[0]);
    curve.engine = engine.into();
    curve.points = cost
        .iter()
        .map(|(seconds, error)| {
            let mut point = point(0.1, 10);
            point.error_m = Some(*error);
            point.wall_s = Some(WallTime {
                min: *seconds,
                median: *seconds,
                mad: None,
            });
            point
        })
        .collect();
    curve
}

/// A letter stands in the line of its error's label and above the tick of its time's; where two meet,
/// the first is shown, which is the scene's own.
#[test]
fn letters_stand_where_the_axes_say() {
    let mut report = priced();
    let cost = report.cost_mut();
    (cost.targets, cost.floor_m) = (Vec::new(), None);
    cost.curves = vec![
        decades("rk4", &[(1e-6, 1.0), (1e-3, 1e-4), (1.0, 1e-11)]),
        decades("symplectic_euler", &[(1e-3, 1e-4)]),
    ];
    let text = plain(&terminal::render(report.view()));
    let lines: Vec<Vec<char>> = text.lines().map(|line| line.chars().collect()).collect();
    let axis = lines.iter().position(|line| line.contains(&'└')).unwrap();
    let tick = |label: &str| {
        let labels: String = lines[axis + 1].iter().collect();
        let at = labels.find(label).unwrap_or_else(|| panic!("{labels}"));
        let at = labels[..at].chars().count();
        let ticks = lines[axis].iter().enumerate();
        let near = ticks.filter(|(_, c)| **c == '┴').map(|(column, _)| column);
        near.min_by_key(|column| column.abs_diff(at + label.chars().count() / 2))
            .unwrap()
    };
    let line = |label: &str| {
        let starts = |line: &&Vec<char>| {
            let text: String = line.iter().collect();
            text.trim_start().starts_with(&format!("{label}┤"))
        };
        lines
            .iter()
            .find(starts)
            .unwrap_or_else(|| panic!("{label}"))
    };
    assert_eq!(line("1e0")[tick("1 µs")], 'b');
    assert_eq!(line("1e-4")[tick("1 ms")], 'a');
    // Each is named once, at its end.
    for name in ["a symplectic_euler", "b rk4"] {
        assert_eq!(text.matches(name).count(), 1, "{text}");
    }
    // The last one's decade may have no label of its own.
    assert_eq!(lines[axis - 1][tick("1 s")], 'b');
    let field = lines[axis - 22..axis].iter().flatten();
    assert_eq!(field.filter(|c| **c == 'b').count(), 3);
}

#[test]
fn json_has_the_keys_of_costs_and_no_curves() {
    let value: serde_json::Value =
        serde_json::from_str(&json::render(&Tool::this(), &[classic()])).unwrap();
    let cost = &value["reports"][0]["cost"];
    for key in ["duration_s", "horizon_s", "floor_m", "targets", "curves"] {
        assert!(!cost[key].is_null(), "{key}");
    }
    assert!(cost["panels"].is_null());
    assert_eq!(value["reports"][0]["series"], true);
    assert_eq!(cost["targets"][1]["cheapest"]["engine"], "pefrl");
    assert!(cost["targets"][2]["cheapest"].is_null());
    assert_eq!(cost["curves"][0]["points"][0]["status"], "diverged");
}

/// A failed check is said before anything else.
#[test]
fn a_failed_check_comes_first() {
    let mut report = priced();
    let check = super::samples::twin("twin_forces", CheckStatus::Fail);
    report.header.checks.push(check);
    assert!(verdict(&report.view()).starts_with("THE TWIN PROOF FAILS"));
    assert!(plain(&terminal::render(report.view())).contains("FAIL"));
    assert!(report.markdown().contains("**fail**"));
}

/// The largest number rounds to one there is none of: 1.80e308.
#[test]
fn the_largest_number_stays_a_number() {
    let text = plain(&terminal::render(odd().view()));
    assert!(text.contains("of 1.80e308 s"), "{text}");
    assert!(!text.contains("inf") && !text.contains("NaN"));
}
