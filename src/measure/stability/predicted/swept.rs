//! Limits of methods that sweep over dampers which share particles: by the method's own steps of the linearised
//! scene, since its map depends on every damper and not on their sum alone.

use super::Limit;
use crate::integrators::{Method, Settings, Stable, bisect};
use crate::physics::{
    Dampers, ForceKinds, Jacobian, Linearization, Power, State, Sweep, System, Triplets,
};
use faer::Mat;

/// The scan's steps, in parts of h, and how far it goes, in units of the undamped limit.
const CELL: f64 = 0.02;
const FAR: f64 = 4.0;
/// Eigenvalues so near 1 are those of motion at rest, split by the root of rounding.
const AT_REST: f64 = 1e-6;
/// A modulus beyond 1 by more than this is growth.
const GROWING: f64 = 1e-9;

/// The limit of a method whose undamped limit at the fastest mode, of `omega` rad/s, is known.
pub(super) fn limit<S: System + ?Sized>(
    system: &S,
    state: &State,
    method: &Method,
    omega: f64,
) -> Limit {
    let Stable::Below(z) = method.oscillator.stable else {
        return unknown();
    };
    let linear = Linear::new(system, state);
    let stable = |h: f64| is_stable(&linear, method, h);
    let guess = z / omega;
    let (mut low, mut high) = (0.05 * guess, 0.05 * guess);
    while stable(high) {
        low = high;
        high *= 1.0 + CELL;
        if high > FAR * guess {
            return unknown();
        }
    }
    if low == high {
        return unknown();
    }
    Limit::At(bisect(low, high, 1e-10, stable))
}

fn unknown() -> Limit {
    Limit::Unknown(
        "no limit is seen between a twentieth and four times the undamped one".to_owned(),
    )
}

/// Whether no motion of the linearised scene grows in the method's steps.
fn is_stable<S: System + ?Sized>(linear: &Linear<S>, method: &Method, h: f64) -> bool {
    let weights = linear.inverse_mass();
    let free: Vec<usize> = (0..weights.len()).filter(|&i| weights[i] > 0.0).collect();
    let m = free.len();
    let mut map = Mat::<f64>::zeros(2 * m, 2 * m);
    for column in 0..2 * m {
        let rest = vec![0.0; weights.len()];
        let mut state = State::new(rest.clone(), rest);
        let at = free[column % m];
        // Velocities in units of x / h.
        if column < m {
            state.x[at] = 1.0;
        } else {
            state.v[at] = 1.0 / h;
        }
        let stepped = method
            .build(&Settings::default())
            .step(linear, h, &mut state);
        if stepped.is_err() {
            return false;
        }
        for (row, &at) in free.iter().enumerate() {
            map[(row, column)] = state.x[at];
            map[(m + row, column)] = state.v[at] * h;
        }
    }
    let all = map.eigenvalues();
    all.is_ok_and(|all| {
        let moving = all.iter().filter(|z| (z.re - 1.0).hypot(z.im) > AT_REST);
        moving
            .map(|z| z.re.hypot(z.im))
            .all(|modulus| modulus <= 1.0 + GROWING)
    })
}

/// The linearised scene: constant derivatives, and dampers along the directions they have in the state.
struct Linear<'a, S: ?Sized> {
    of: &'a S,
    x: &'a [f64],
    jacobian: Jacobian,
}

impl<'a, S: System + ?Sized> Linear<'a, S> {
    fn new(of: &'a S, state: &'a State) -> Self {
        let mut jacobian = Jacobian::default();
        of.jacobian(
            state.t,
            &state.x,
            &state.v,
            Linearization::Exact,
            &mut jacobian,
        );
        Self {
            of,
            x: &state.x,
            jacobian,
        }
    }

    fn add(&self, triplets: &Triplets, x: &[f64], a: &mut [f64]) {
        for &(row, column, value) in triplets {
            a[row] += self.inverse_mass()[row] * value * x[column];
        }
    }
}

impl<S: System + ?Sized> System for Linear<'_, S> {
    fn inverse_mass(&self) -> &[f64] {
        self.of.inverse_mass()
    }

    fn kinds(&self) -> ForceKinds {
        self.of.kinds().without(ForceKinds::DRIVEN)
    }

    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        self.damping(t, x, v, a);
        self.add(&self.jacobian.position, x, a);
        Power::default()
    }

    fn damping(&self, _t: f64, _x: &[f64], w: &[f64], a: &mut [f64]) {
        a.fill(0.0);
        self.add(&self.jacobian.velocity, w, a);
    }

    fn dampers(&self) -> Dampers {
        self.of.dampers()
    }

    fn sweep(&self, sweep: &mut Sweep) {
        sweep.elsewhere(self.x, |sweep| self.of.sweep(sweep));
    }

    fn potential(&self, _t: f64, _x: &[f64]) -> f64 {
        0.0
    }
}
