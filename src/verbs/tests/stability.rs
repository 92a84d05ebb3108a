//! Reports of limits, maps and admissible places.

use super::plain;
use super::samples::{Reach, empty};
use crate::report::{terminal, verdict::verdict};
use crate::verbs::tests::data::*;

fn row(engine: &str, predicted: Option<f64>, measured: Option<f64>) -> StabilityRow {
    StabilityRow {
        engine: engine.into(),
        kind: SolverKind::Integrator,
        unsupported: false,
        predicted_limit_s: predicted,
        measured_limit_s: measured,
        measured_between_s: None,
        unconditional: predicted.is_none(),
        measured_unconditional: measured.is_none(),
        growth_per_s: (predicted == Some(0.0)).then_some(0.2494),
        measured_growth_per_s: (measured == Some(0.0)).then_some(0.2494),
        smooth_below_s: None,
        measured_smooth_below_s: None,
        tightest: None,
        reason: None,
        remarks: Vec::new(),
    }
}

/// The oscillator's limits: z < 2 and z < 2 sqrt(2) over w = 7.071 rad/s.
pub fn limits() -> Report {
    let mut report = empty("circle");
    report.header.checks.clear();
    let mut rapier = row("rapier", None, None);
    rapier.kind = SolverKind::Rapier;
    rapier.unconditional = false;
    let mut material = row("linearized_implicit_material", Some(0.2828), Some(0.2829));
    for row in [&mut material, &mut rapier] {
        row.remarks.push("its sweeps are not converged".into());
    }
    let stability = Stability {
        omega_max_rad_s: Some(50_f64.sqrt()),
        unsure: false,
        horizon_s: 5.0,
        timestep_s: 0.01,
        linear: true,
        excluded: vec!["2 rigid translations".into()],
        rows: vec![
            row("symplectic_euler", Some(0.282842), Some(0.282715)),
            row("explicit_euler", Some(0.0), Some(0.0)),
            row("rk4", Some(0.4), Some(0.3999)),
            row("implicit_euler", None, None),
            material,
            rapier,
        ],
        map: None,
        largest: None,
        admissible: None,
    };
    report.body = Body::Stability {
        outcomes: [],
        stability,
    };
    report.series = SeriesState::Nothing;
    report
}

fn panel(
    engine: &str,
    values: usize,
    timesteps: usize,
    cell: impl Fn(usize, usize) -> Cell,
) -> MapPanel {
    let column = |i| (0..timesteps).map(|j| Some(cell(i, j))).collect();
    MapPanel {
        engine: engine.into(),
        cells: (0..values).map(column).collect(),
        predicted_limit_s: (0..values)
            .map(|i| Some(10_f64.powf(-0.25 * i as f64)))
            .collect(),
    }
}

/// A map of every engine there is.
pub fn mapped() -> Report {
    let mut report = limits();
    let names = crate::integrators::ids(crate::integrators::fixed())
        .into_iter()
        .chain(["rapier", "rapier(iterations=8,pgs=4)"]);
    let cell = |shift: usize| {
        move |i: usize, j: usize| match i + j + shift % 5 {
            n if n < 14 => Cell::Stable,
            n if n < 18 => Cell::Dissipating,
            n if n < 30 => Cell::Growing,
            _ => Cell::Failed,
        }
    };
    let powers = |first: f64, step: f64| {
        (0..20)
            .map(|i| 10_f64.powf(first + step * f64::from(i)))
            .collect()
    };
    {
        let stability = report.stability_mut();
        stability.map = Some(StabilityMap {
            vary: "springs.stiffness".into(),
            unit: "N/m".into(),
            values: powers(2.0, 0.3),
            timesteps_s: powers(-4.0, 0.2),
            steps_per_cell: 2_042,
            engines: names
                .enumerate()
                .map(|(at, name)| panel(name, 20, 20, cell(at)))
                .collect(),
        });
    }
    report
}

/// Two stiffnesses, one of which admits half of all places.
pub fn pair() -> Report {
    let mut report = limits();
    let axis: Vec<f64> = (0..12).map(|i| 0.5 * f64::from(i) - 2.75).collect();
    let panels = [1.0, 5.0].map(|stiffness| AdmissiblePanel {
        stiffness_n_m: stiffness,
        share: 0.5,
        admitted: vec!["110011001100".into(); 12],
    });
    {
        let stability = report.stability_mut();
        stability.admissible = Some(Admissible {
            engine: "explicit_euler".into(),
            timestep_s: 0.5,
            masses_kg: [1.0, 2.0],
            rest_length_m: 1.0,
            x1_m: axis.clone(),
            x2_m: axis,
            panels: panels.into(),
        });
    }
    report
}

/// Long names, a single value, ragged and empty cells, limits far outside, a linear axis from 0.
pub fn odd() -> Report {
    let mut report = pair();
    let nasty = "a|b<c>&\"d\" `e` \u{1b}[31m 漢字 ".repeat(8);
    let stability = report.stability_mut();
    stability.timestep_s = f64::MIN_POSITIVE;
    stability.linear = false;
    stability.omega_max_rad_s = None;
    stability.excluded = vec![nasty.clone(); 3];
    for row in &mut stability.rows {
        row.engine += &nasty;
        row.predicted_limit_s = Some(f64::MAX);
        row.measured_limit_s = Some(f64::MIN_POSITIVE);
        row.growth_per_s = Some(f64::MAX);
        row.smooth_below_s = Some(1e-300);
        row.measured_smooth_below_s = Some(1e300);
        row.tightest = Some(TightestLimit {
            limit_s: 1e-300,
            t_s: 1e300,
        });
        row.remarks = vec![nasty.clone(), nasty.repeat(4)];
    }
    let mut ragged = panel(&nasty, 2, 3, |_, _| Cell::Failed);
    ragged.cells[1].clear();
    ragged.predicted_limit_s = vec![Some(1e300), None];
    stability.map = Some(StabilityMap {
        vary: nasty.clone(),
        unit: "N/m".into(),
        values: vec![0.0, 1e18],
        timesteps_s: vec![1e-30, 1.0, 1e12],
        steps_per_cell: u64::MAX,
        engines: vec![ragged.clone(), ragged],
    });
    if let Some(admissible) = &mut stability.admissible {
        admissible.panels[0].admitted = vec![String::new(), "1".repeat(99)];
        admissible.rest_length_m = 1e12;
    }
    report
}

#[test]
fn limits_read_at_a_glance() {
    let text = plain(&terminal::render(limits().view()));
    insta::assert_snapshot!(text, @r"
    circle  2 particles, 1 spring, 5 s at h = 0.01 s, symplectic_euler
    A spring of rest length 0, started sideways: the truth is an ellipse.

    symplectic_euler is stable up to h = 0.2827 s, and 0.01 s is inside; never stable: explicit_euler.

                                    predicted   measured           growth/s  growth/s  at h =
      engine                        limit (s)  limit (s)   ratio  predicted  measured  0.01 s
    ─────────────────────────────────────────────────────────────────────────────────────────
    ▸ symplectic_euler                 0.2828     0.2827  0.9996          -         -  inside
      explicit_euler                    never      never       -     0.2494    0.2494  beyond
      rk4                              0.4000     0.3999  0.9997          -         -  inside
      implicit_euler                   always     always       -          -         -  inside
      linearized_implicit_material     0.2828     0.2829  1.0004          -         -  inside
      rapier                                -     always       -          -         -  inside
    ▸ own integrator | never, always: no step is stable, every step is | ratio: measured over predicted

    - linearized_implicit_material and rapier: its sweeps are not converged

    linear   fastest mode 7.071 rad/s; every force is linear: limits are the same wherever the state is
    left out 2 rigid translations
    ");
}

#[test]
fn files_of_two_verbs_do_not_meet() {
    assert_eq!(limits().stem(), "stability");
    assert_eq!(empty("run").stem(), "report");
}

#[test]
fn only_what_was_asked_for_is_drawn() {
    let drawn =
        |report: &Report| -> Vec<&str> { report.svg().into_iter().map(|(file, _)| file).collect() };
    assert!(drawn(&limits()).is_empty());
    assert_eq!(drawn(&mapped()), ["stability_map.svg"]);
    assert_eq!(drawn(&pair()), ["admissible.svg"]);
    assert_eq!(drawn(&odd()), ["stability_map.svg", "admissible.svg"]);
}

/// Every cell is covered by the colour of what became of it, once: the areas of the paths add up.
#[test]
fn the_map_shows_each_cell_in_its_colour() {
    let mut report = mapped();
    let map = report.stability_mut().map.as_mut().unwrap();
    map.engines.truncate(1);
    let cells = map.engines[0].cells.clone();
    let count = |wanted| {
        cells
            .iter()
            .flatten()
            .filter(|cell| **cell == Some(wanted))
            .count() as f64
    };
    let svg = &report.svg()[0].1;
    let document = roxmltree::Document::parse(svg).unwrap();
    let areas: Vec<f64> = document
        .descendants()
        .filter(|node| node.attribute("shape-rendering").is_some())
        .map(|node| area(node.attribute("d").unwrap()))
        .collect();
    assert_eq!(areas.len(), 4);
    let whole: f64 = areas.iter().sum();
    let kinds = [Cell::Stable, Cell::Dissipating, Cell::Growing, Cell::Failed];
    for (kind, area) in kinds.into_iter().zip(areas) {
        // Corners are rounded to 0.1 pixels of cells about 10 to 15 wide: 2 % of each at most.
        let share = area / whole - count(kind) / 400.0;
        assert!(
            share.abs() < 0.02 * count(kind) / 400.0,
            "{kind:?}: {share}"
        );
    }
}

/// Of rectangles written `Mx yHxVyHxZ`.
fn area(data: &str) -> f64 {
    let rectangle = |text: &str| {
        let numbers: Vec<f64> = text
            .split(|c: char| c.is_alphabetic() || c == ' ')
            .filter_map(|n| n.parse().ok())
            .collect();
        (numbers[2] - numbers[0]) * (numbers[1] - numbers[3])
    };
    data.split('Z')
        .filter(|text| !text.is_empty())
        .map(rectangle)
        .sum()
}

/// Light to dark by at least a sixth of the scale from one to the next, so that a grey print tells them.
#[test]
fn colours_of_cells_differ_in_grey() {
    let svg = &mapped().svg()[0].1;
    let document = roxmltree::Document::parse(svg).unwrap();
    let fills: Vec<f64> = document
        .descendants()
        .filter(|node| node.attribute("shape-rendering").is_some())
        .take(4)
        .map(|node| grey(node.attribute("fill").unwrap()))
        .collect();
    for pair in fills.windows(2) {
        assert!(pair[0] - pair[1] > 1.0 / 6.0, "{fills:?}");
    }
}

/// Luma of `#rrggbb` (ITU-R BT.601), 0 to 1.
fn grey(colour: &str) -> f64 {
    let part = |at: usize| f64::from(u8::from_str_radix(&colour[at..at + 2], 16).unwrap());
    (0.299 * part(1) + 0.587 * part(3) + 0.114 * part(5)) / 255.0
}

#[test]
fn the_verdict_puts_the_scenes_own_step_first() {
    let mut report = limits();
    assert!(verdict(&report.view()).starts_with("symplectic_euler is stable up to h = 0.2827 s"));
    report.stability_mut().timestep_s = 0.3;
    let text = verdict(&report.view());
    assert!(
        text.starts_with("symplectic_euler IS UNSTABLE at h = 0.3 s"),
        "{text}"
    );
    // The limit itself, known to a thousandth, is inside.
    report.stability_mut().timestep_s = 0.2828;
    assert!(verdict(&report.view()).contains("is inside"));
}

#[test]
fn markdown_says_equal_things_once() {
    let text = limits().markdown();
    assert_eq!(text.matches("sweeps are not converged").count(), 1);
    assert!(
        text.contains("**linearized_implicit_material and rapier**"),
        "{text}"
    );
}
