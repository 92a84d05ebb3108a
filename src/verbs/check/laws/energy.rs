//! Energy: bounded for symplectic methods inside their limit, and never dissipated backwards.

use super::{Instant, Ran, Row, Subject};
use crate::conformance::systems::Oscillator;
use crate::integrators::{self, Coefficients, Method, Settings, Stage};
use crate::measure::stability::is_linear;
use crate::measure::{Check, EnergySeries};
use crate::physics::{ForceKinds, Jacobian, Linearization, State, System};
use crate::trajectory::Trajectory;

pub(super) const BOUNDED: Row = Row {
    id: "energy-bounded",
    requires: "without damping, a symplectic method inside its limit keeps the energy within a band for ever",
    derivation: "3 (R - 1) D: R is the ratio of the largest to the smallest energy on the method's orbit of an \
                 oscillator at z = h w, w the largest frequency (of forces that are not linear a bound of it, by row \
                 sums at every instant, and R that of Verlet for methods of order 2 and more); D the largest of \
                 K + a·M a / (2 w²); rounding beside it",
    remedy: "a force of another time or place in the kick, a step that changes, or a force without a potential",
    judge: Some(|ran| {
        // A drive feeds energy in and out, and at resonance without end. On rods motion is none of oscillators, and what a
        // strain limit or an obstacle does is not symplectic.
        let system = ran.system();
        let kinds = system.kinds();
        let limited = system.strain_limiter().is_some() || system.obstacles().is_some();
        let steady = system.drives().is_empty() && !limited;
        if kinds.depends_on_velocity() || !steady || kinds.has(ForceKinds::CONSTRAINED) {
            return Vec::new();
        }
        let judged = |(subject, run, method): (Subject, &Trajectory, &'static Method)| {
            let inside = method.symplectic && ran.inside(method, subject.case.label.timestep);
            bounded(ran, &subject, run, method).filter(|_| inside)
        };
        ran.whole().filter_map(judged).collect()
    }),
};

/// The largest frequency along a run, rad/s: of linear forces itself, else the square root of the largest row sum of
/// M^-1/2 (df/dx) M^-1/2 (Gershgorin).
fn fastest(ran: &Ran, run: &Trajectory) -> Option<f64> {
    if is_linear(ran.scene()) {
        return ran.linearised.as_ref()?.omega_max();
    }
    let system = ran.system();
    let weights: Vec<f64> = system.inverse_mass().iter().map(|w| w.sqrt()).collect();
    let mut jacobian = Jacobian::default();
    let mut most = 0.0_f64;
    for k in 0..run.len() {
        jacobian.clear();
        let (x, v) = (run.x(k), run.v(k));
        system.jacobian(run.time(k), x, v, Linearization::Exact, &mut jacobian);
        let mut rows = vec![0.0; x.len()];
        for &(i, j, slope) in &jacobian.position {
            rows[i] += slope.abs() * weights[i] * weights[j];
        }
        most = rows.into_iter().fold(most, f64::max);
    }
    Some(most.sqrt())
}

fn bounded(
    ran: &Ran,
    subject: &Subject,
    run: &Trajectory,
    method: &'static Method,
) -> Option<Check> {
    let h = subject.case.label.timestep;
    let w = fastest(ran, run).filter(|w| *w > 0.0)?;
    // Errors of methods of higher order hold terms of forces that are not linear, which no oscillator shows.
    let like = match method.order {
        2.. if !is_linear(ran.scene()) => integrators::find("velocity_verlet")?,
        _ => method,
    };
    let ratio = orbit(like, h * w)?;
    let system = ran.system();
    let series = EnergySeries::new(system, run)?;
    let dynamic = |k: usize| {
        let (x, v) = (run.x(k), run.v(k));
        let mut a = vec![0.0; x.len()];
        system.acceleration(run.time(k), x, v, &mut a);
        system.kinetic(v) + system.kinetic(&a) / (w * w)
    };
    let most = series
        .instants
        .iter()
        .map(|&k| dynamic(k))
        .fold(0.0, f64::max);
    let rounding = ran.rounding(subject, run);
    let size = series
        .balance
        .iter()
        .fold(most, |most, b| most.max(b.abs()));
    let band = 3.0 * (ratio - 1.0) * most;
    let instants = series
        .error(1.0)
        .into_iter()
        .zip(&series.t)
        .zip(&series.instants);
    let instants = instants.map(|((error, t), &k)| Instant {
        t: *t,
        found: error.abs(),
        bound: band + rounding * size * run.step(k) as f64,
    });
    BOUNDED.over_time(
        &subject.outcome.engine,
        "the energy is off by (J)",
        instants,
    )
}

/// The largest ratio of two energies on the orbit of x'' = -x under steps of z or less; None where it is no ellipse.
fn orbit(method: &Method, z: f64) -> Option<f64> {
    let parts = (1..=32).map(|part| ellipse(method, z * f64::from(part) / 32.0));
    parts
        .collect::<Option<Vec<f64>>>()?
        .into_iter()
        .reduce(f64::max)
}

/// The map of one step is a matrix M of determinant 1, which keeps -c x² + (a - d) x v + b v²; on its ellipse the
/// energy (x² + v²) / 2 runs between those of its axes.
fn ellipse(method: &Method, h: f64) -> Option<f64> {
    let system = Oscillator { w: 1.0, zeta: 0.0 };
    let column = |x: f64, v: f64| {
        let mut state = State::new(vec![x], vec![v]);
        method
            .build(&Settings::default())
            .step(&system, h, &mut state)
            .ok()?;
        Some((state.x[0], state.v[0]))
    };
    let ((a, c), (b, d)) = (column(1.0, 0.0)?, column(0.0, 1.0)?);
    let (p, q, r) = (-c, 0.5 * (a - d), b);
    let middle = 0.5 * (p + r);
    let spread = (0.25 * (p - r) * (p - r) + q * q).sqrt();
    let (small, large) = (middle.abs() - spread, middle.abs() + spread);
    (small > 0.0 && (a + d).abs() < 2.0).then(|| large / small)
}

pub(super) const DISSIPATION: Row = Row {
    id: "dissipation",
    requires: "dampers and drag take energy out, at no time back",
    derivation: "the power c v² is never negative; 8 roundings a step of what was dissipated",
    remedy: "a damper acts on a velocity of the wrong sign, or the work is booked at another velocity",
    judge: Some(|ran| {
        if !ran.system().kinds().damps() {
            return Vec::new();
        }
        let own = ran.whole().filter(|(subject, ..)| !subject.is_other());
        let whole = own.filter(|(_, _, method)| !goes_back(method));
        let check = |(subject, run, _): (Subject, &Trajectory, &'static Method)| {
            let mut most = 0.0_f64;
            let instants = (0..run.len()).map(|k| {
                let now = run.work(k).dissipated;
                let found = (most - now).max(0.0);
                most = most.max(now);
                let bound = 8.0 * f64::EPSILON * run.step(k) as f64 * most;
                Instant {
                    t: run.time(k),
                    found,
                    bound,
                }
            });
            DISSIPATION.over_time(&subject.outcome.engine, "energy given back (J)", instants)
        };
        whole.filter_map(check).collect()
    }),
};

/// Whether some of its substeps go back in time: what dampers take in them is less than nothing.
fn goes_back(method: &Method) -> bool {
    match method.coefficients {
        Coefficients::Composition(stages, _) => stages.iter().any(|stage| match stage {
            Stage::Kick(part) | Stage::Drift(part) => *part < 0.0,
        }),
        _ => false,
    }
}
