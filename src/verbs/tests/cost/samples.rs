//! Reports of costs: lines as theory draws them, with what goes wrong at both ends.

use crate::verbs::tests::data::*;
use crate::verbs::tests::samples::{Reach, empty};

/// Below ten times the truth's bar.
const FLOOR: f64 = 4e-12;
/// 2 pi / w of the oscillator, as `limits()` has it.
const OMEGA: f64 = 7.0710678118654755;

/// One method's line: error = scale (w h)^order + rounding.
#[derive(Clone, Copy)]
pub struct Line {
    pub engine: &'static str,
    pub order: u32,
    pub scale: f64,
    /// Force evaluations of one step.
    pub evaluations: u64,
    /// Nanoseconds one evaluation takes.
    pub nanoseconds: f64,
    /// Largest stable w h.
    pub limit: f64,
}

pub const LINES: [Line; 5] = [
    line("symplectic_euler", 1, 0.5, 1, 40.0, 2.0),
    line("explicit_euler", 1, 3.0, 1, 40.0, 0.3),
    line("velocity_verlet", 2, 0.2, 1, 45.0, 2.0),
    line("rk4", 4, 0.04, 4, 42.0, 2.8),
    line("pefrl", 4, 0.002, 4, 60.0, 2.9),
];

const fn line(
    engine: &'static str,
    order: u32,
    scale: f64,
    evaluations: u64,
    nanoseconds: f64,
    limit: f64,
) -> Line {
    Line {
        engine,
        order,
        scale,
        evaluations,
        nanoseconds,
        limit,
    }
}

/// The steps 5 s are cut into, coarse to fine.
fn counts() -> impl Iterator<Item = u64> {
    (0..12).map(|i| (12.0 * 2.4_f64.powi(i)).round() as u64)
}

pub fn point(timestep: f64, steps: u64) -> CostPoint {
    CostPoint {
        timestep,
        tolerance: None,
        steps,
        status: Status::Completed,
        reason: None,
        error_m: None,
        error_final_m: None,
        energy_error: None,
        at_floor: false,
        wall_s: None,
        force_evaluations: None,
        linear_solves: Some(0),
        newton_iterations: Some(0),
    }
}

fn wall(median: f64) -> Option<WallTime> {
    Some(WallTime {
        min: 0.97 * median,
        median,
        mad: Some(0.02 * median),
    })
}

/// Diverged beyond the limit, rounding that grows with the root of the steps below.
pub fn curve(line: Line) -> CostCurve {
    let points: Vec<CostPoint> = counts()
        .map(|n| {
            let h = 5.0 / n as f64;
            let mut point = point(h, n);
            let z = OMEGA * h;
            point.force_evaluations = Some(line.evaluations * n);
            if z > line.limit {
                point.status = Status::Diverged;
                point.reason = Some(format!("energy passed the limit at {:.2} s", 10.0 * h));
                return point;
            }
            let error = line.scale * z.powi(line.order as i32) + 2e-15 * (n as f64).sqrt();
            point.error_m = Some(error);
            point.error_final_m = Some(0.7 * error);
            point.energy_error = Some(0.3 * error);
            point.at_floor = error < FLOOR;
            point.wall_s = wall(1e-9 * line.nanoseconds * (line.evaluations * n) as f64);
            point
        })
        .collect();
    CostCurve {
        engine: line.engine.into(),
        kind: SolverKind::Integrator,
        order: Some(line.order),
        observed_order: Some(f64::from(line.order) + 0.004),
        slope_points: (4..8).collect(),
        pareto: front(&points),
        points,
        explanation: None,
    }
}

fn front(points: &[CostPoint]) -> Vec<usize> {
    let known = |at: &usize| points[*at].error_m.is_some();
    let better = |a: &CostPoint, b: &CostPoint| a.error_m < b.error_m && a.work() < b.work();
    let beaten = |at: &usize| {
        points
            .iter()
            .any(|p| p.error_m.is_some() && better(p, &points[*at]))
    };
    (0..points.len())
        .filter(|at| known(at) && !beaten(at))
        .collect()
}

/// An embedded pair over its tolerances.
fn pair() -> CostCurve {
    let points: Vec<CostPoint> = (3..11)
        .map(|digits| {
            let tolerance = 10_f64.powi(-digits);
            let n = (60.0 * tolerance.powf(-0.2) / 4.0).round() as u64;
            let mut point = point(5.0 / n as f64, n);
            point.tolerance = Some(tolerance);
            point.error_m = Some(8.0 * tolerance);
            point.error_final_m = Some(5.0 * tolerance);
            point.energy_error = Some(2.0 * tolerance);
            point.force_evaluations = Some(6 * n + 3);
            point.wall_s = wall(1e-9 * 70.0 * (6 * n) as f64);
            point
        })
        .collect();
    CostCurve {
        engine: "dopri5".into(),
        kind: SolverKind::Integrator,
        order: Some(5),
        observed_order: Some(5.02),
        slope_points: (1..7).collect(),
        pareto: front(&points),
        points,
        explanation: None,
    }
}

fn rapier(engine: &str, best: f64) -> CostCurve {
    let points: Vec<CostPoint> = counts()
        .take(8)
        .map(|n| {
            let h = 5.0 / n as f64;
            let mut point = point(h, n);
            point.error_m = Some(0.8 * h + best);
            point.error_final_m = Some(0.5 * h + best);
            point.energy_error = Some(h.min(0.9));
            point.wall_s = wall(2e-6 * n as f64);
            point.linear_solves = None;
            point.newton_iterations = None;
            point
        })
        .collect();
    CostCurve {
        engine: engine.into(),
        kind: SolverKind::Rapier,
        order: None,
        observed_order: None,
        slope_points: Vec::new(),
        pareto: front(&points),
        points,
        explanation: Some(
            "its spring joint is linearly implicit Euler at h = dt/4 and dissipates by design; its bodies are in \
             single precision"
                .into(),
        ),
    }
}

fn unsupported() -> CostCurve {
    let mut only = point(0.01, 0);
    only.status = Status::Unsupported;
    only.reason = Some("isotropic damping has no joint".into());
    CostCurve {
        engine: "rapier-forces".into(),
        kind: SolverKind::Rapier,
        order: None,
        observed_order: None,
        slope_points: Vec::new(),
        points: vec![only],
        pareto: Vec::new(),
        explanation: None,
    }
}

/// The coarsest of the finest points that all reach the target.
fn rank(curve: &CostCurve, target: f64) -> CostRank {
    let near = |p: &&CostPoint| p.error_m.is_some_and(|e| e <= target);
    let count = curve.points.iter().rev().take_while(near).count();
    let from = curve.points.len() - count;
    let errors = curve.points.iter().filter_map(|p| p.error_m);
    let nearest = errors.fold(f64::INFINITY, f64::min);
    let reason = match curve.points.last().and_then(|p| p.reason.clone()) {
        Some(reason) => reason,
        None => format!("nearest {nearest:.1e} m at the settings tried"),
    };
    CostRank {
        engine: curve.engine.clone(),
        reached: curve.points.get(from).map(|p| CostReached {
            at_most: from == 0,
            engine: curve.engine.clone(),
            timestep: p.timestep,
            tolerance: p.tolerance,
            error_m: p.error_m.unwrap(),
            wall_median_s: p.wall_s.as_ref().map(|wall| wall.median),
            force_evaluations: p.force_evaluations,
        }),
        wall_ratio: None,
        reason: (count == 0).then_some(reason),
        more_steps: None,
        extrapolated_wall_ratio: None,
    }
}

pub fn target(curves: &[CostCurve], error: f64) -> CostTarget {
    let ranks = |ranked| {
        let curves = curves.iter().filter(move |c| c.is_ranked() == ranked);
        curves.map(|c| rank(c, error)).collect::<Vec<CostRank>>()
    };
    let (mut ranking, mut reference) = (ranks(true), ranks(false));
    let time = |rank: &CostRank| {
        let reached = rank.reached.as_ref();
        let paid = |r: &CostReached| r.wall_median_s.or(r.force_evaluations.map(|n| n as f64));
        reached.and_then(paid).unwrap_or(f64::MAX)
    };
    ranking.sort_by(|a, b| time(a).total_cmp(&time(b)));
    let cheapest = ranking[0].reached.clone();
    let least = cheapest.as_ref().and_then(|c| c.wall_median_s);
    for rank in ranking.iter_mut().chain(&mut reference) {
        let own = rank.reached.as_ref().and_then(|r| r.wall_median_s);
        rank.wall_ratio = own.zip(least).map(|(own, least)| own / least);
    }
    let reached = ranking.iter().filter_map(|rank| rank.reached.as_ref());
    let fewest = reached.min_by_key(|r| r.force_evaluations);
    CostTarget {
        error_m: error,
        fewest_evaluations: fewest.cloned(),
        cheapest,
        ranking,
        reference,
        reason: None,
    }
}

fn report(name: &str, curves: Vec<CostCurve>, targets: &[f64]) -> Report {
    let mut report = empty(name);
    report.header.checks.clear();
    report.header.truth = TruthFacts {
        kind: TruthKind::ClosedForm,
        method: Some("harmonic oscillator".into()),
        error_bound_m: Some(FLOOR / 10.0),
        horizon_s: Some(5.0),
        reason: None,
    };
    let cost = Cost {
        duration_s: 5.0,
        horizon_s: Some(5.0),
        floor_m: Some(FLOOR),
        targets: targets.iter().map(|e| target(&curves, *e)).collect(),
        curves,
    };
    report.body = Body::Cost { outcomes: [], cost };
    report.series = SeriesState::Nothing;
    report
}

/// Five methods, a pair and rapier, with a target nobody reaches.
pub fn priced() -> Report {
    let mut curves: Vec<CostCurve> = LINES.into_iter().map(curve).collect();
    curves.extend([pair(), rapier("rapier", 3.1e-4), unsupported()]);
    report("circle", curves, &[1e-2, 1e-6, 1e-15])
}

/// Every integrator there is, and what stands beside them.
pub fn full() -> Report {
    let ids = crate::integrators::ids(crate::integrators::fixed());
    let mut curves: Vec<CostCurve> = ids
        .into_iter()
        .enumerate()
        .map(|(at, id)| {
            let mut line = LINES[at % LINES.len()];
            line.scale *= 1.0 + at as f64;
            line.nanoseconds *= 1.0 + 0.2 * at as f64;
            let mut curve = curve(line);
            curve.engine = id.into();
            curve
        })
        .collect();
    curves.extend([pair(), rapier("rapier", 3.1e-4), unsupported()]);
    curves.push(rapier("rapier(dt=0.001,iterations=8,pgs=4)", 1e-5));
    curves.push(rapier("rapier(iterations=16)", 2e-6));
    let mut report = report("circle", curves, &[1e-3, 1e-6, 1e-9]);
    report.series = SeriesState::Loaded(Series::Panels(panels(&report).unwrap()));
    report
}

/// Nothing timed, as where only counts were asked for.
pub fn counted() -> Report {
    let mut curves: Vec<CostCurve> = LINES.into_iter().map(curve).collect();
    for curve in &mut curves {
        for point in &mut curve.points {
            point.wall_s = None;
        }
    }
    report("counted", curves, &[1e-3, 1e-6])
}

/// No truth: energy alone.
pub fn untrue() -> Report {
    let mut curves: Vec<CostCurve> = LINES.into_iter().map(curve).collect();
    for curve in &mut curves {
        for point in &mut curve.points {
            (point.error_m, point.error_final_m, point.at_floor) = (None, None, false);
        }
        (curve.observed_order, curve.slope_points, curve.pareto) = (None, vec![], vec![]);
    }
    let mut report = report("untrue", curves, &[]);
    report.header.truth = empty("untrue").header.truth;
    let cost = report.cost_mut();
    (cost.horizon_s, cost.floor_m) = (None, None);
    let reason = "there is no truth: it is chaotic from the start";
    cost.targets = [1e-3, 1e-6]
        .map(|error_m| CostTarget {
            error_m,
            cheapest: None,
            fewest_evaluations: None,
            ranking: Vec::new(),
            reference: Vec::new(),
            reason: Some(reason.into()),
        })
        .into();
    report
}

/// The oscillator at three steps under three methods.
pub fn classic() -> Report {
    let mut report = priced();
    report.series = SeriesState::Loaded(Series::Panels(panels(&report).unwrap()));
    report
}

/// Real curves: an ellipse's coordinate under amplitude and phase errors.
fn panels(report: &Report) -> Option<CostPanels> {
    let truth = |t: f64| 0.5 * (OMEGA * t).cos();
    let times = |h: f64| (0..=(5.0 / h).round() as usize).map(move |i| i as f64 * h);
    let line = |at: usize, h: f64| {
        let growth = [0.0, 0.5 * OMEGA * OMEGA * h, 0.0, -2.0 * h][at % 4];
        let detuned = OMEGA * (1.0 - [0.0, 0.0, 1.0, 0.1][at % 4] * h * h);
        let curve: Vec<[f64; 2]> = times(h)
            .map(|t| [t, 0.5 * (growth * t).exp() * (detuned * t).cos()])
            .collect();
        let grown = growth > 3.0;
        CostLine {
            timestep: h,
            status: if grown {
                Status::Diverged
            } else {
                Status::Completed
            },
            difference: curve.iter().map(|[t, x]| [*t, x - truth(*t)]).collect(),
            curve,
        }
    };
    let engines = report.cost()?.curves.iter().map(|curve| &curve.engine);
    let panel = |(at, engine): (usize, &String)| CostPanel {
        engine: engine.clone(),
        lines: [0.15, 0.05, 0.01].map(|h| line(at, h)).into(),
    };
    Some(CostPanels {
        label: "particle 1, x (m)".into(),
        truth: times(0.01).map(|t| [t, truth(t)]).collect(),
        panels: engines.enumerate().map(panel).collect(),
    })
}

/// Long names, numbers at both ends of the range, indices beyond the points, empty lists.
pub fn odd() -> Report {
    let mut report = classic();
    let nasty = "a|b<c>&\"d\" `e` *f*\n#g \u{1b}[31m \u{e0102}\u{202e} 漢字 ".repeat(8);
    report.header.scene.own_integrator = nasty.clone();
    let cost = report.cost_mut();
    let sizes = [f64::MAX, f64::MIN_POSITIVE, 0.0, 1e-300, 1e300, 5e-324];
    (cost.duration_s, cost.horizon_s) = (f64::MAX, Some(1e-300));
    cost.floor_m = Some(f64::MIN_POSITIVE);
    for (at, curve) in cost.curves.iter_mut().enumerate() {
        curve.engine = format!("{at} {nasty}");
        curve.observed_order = Some(sizes[at % sizes.len()]);
        curve.order = Some(u32::MAX);
        curve.pareto.push(9_999);
        curve.slope_points.push(9_999);
        curve.explanation = Some(nasty.repeat(2));
        for (i, point) in curve.points.iter_mut().enumerate() {
            let size = |shift: usize| sizes[(i + at + shift) % sizes.len()];
            (point.timestep, point.steps) = (size(0), u64::MAX);
            point.tolerance = (i % 2 == 0).then_some(size(1));
            (point.error_m, point.energy_error) = (Some(size(2)), Some(size(3)));
            point.wall_s = Some(WallTime {
                min: size(4),
                median: size(5),
                mad: Some(size(0)),
            });
            point.force_evaluations = [None, Some(0), Some(u64::MAX)][i % 3];
            point.reason = (i % 4 == 0).then(|| nasty.clone());
        }
    }
    cost.curves[0].engine = nasty.clone();
    cost.curves[2].points.clear();
    let mut empty = cost.curves[2].clone();
    (empty.engine, empty.kind) = (String::new(), SolverKind::External);
    cost.curves.push(empty);
    for target in &mut cost.targets {
        target.error_m = f64::MAX;
        for rank in target.ranking.iter_mut().chain(&mut target.reference) {
            rank.engine = nasty.clone();
            rank.wall_ratio = Some(f64::MAX);
            rank.reason = Some(nasty.repeat(2));
            if let Some(reached) = &mut rank.reached {
                reached.timestep = 5e-324;
                reached.tolerance = Some(f64::MAX);
                reached.engine = nasty.clone();
                reached.force_evaluations = Some(u64::MAX);
            }
        }
    }
    {
        let panels = report.panels_mut();
        panels.label = nasty.clone();
        panels.truth.truncate(1);
        let lines = |at: usize| panels.panels.get(at).map(|p| p.lines.len());
        assert_eq!(lines(0), Some(3));
        panels.panels[0].lines.clear();
        panels.panels[1].lines[0].curve = vec![[f64::MAX, -f64::MAX], [-f64::MAX, f64::MAX]];
        panels.panels[1].lines[0].difference.clear();
        panels.panels[2].lines[0].curve = vec![[0.0, 0.0]; 3];
        panels.panels[2].engine = nasty;
        let many = panels.panels[3].lines[0].clone();
        panels.panels[3].lines = vec![many; 40];
    }
    report
}
