//! A reference made of another formula than any method under test: Gauss-Legendre with three stages,
//! order 6.

use springcheck::physics::{State, System};
use springcheck::truth::{Motion, States};
use std::sync::Mutex;

/// Nodes and matrix of the three-stage Gauss method (Hairer, Lubich, Wanner, Geometric Numerical
/// Integration, II.1.3), with r = sqrt(15).
fn tableau() -> ([[f64; 3]; 3], [f64; 3], [f64; 3]) {
    let r = 15_f64.sqrt();
    let b = [5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0];
    let a = [
        [b[0] / 2.0, b[1] / 2.0 - r / 15.0, b[2] / 2.0 - r / 30.0],
        [b[0] / 2.0 + r / 24.0, b[1] / 2.0, b[2] / 2.0 - r / 24.0],
        [b[0] / 2.0 + r / 30.0, b[1] / 2.0 + r / 15.0, b[2] / 2.0],
    ];
    (a, b, [0.5 - r / 10.0, 0.5, 0.5 + r / 10.0])
}

/// One step over h, its stages found by iterating to rounding: for forces that are not stiff.
fn step(system: &dyn System, h: f64, state: &mut State) {
    let (a, b, c) = tableau();
    let n = state.x.len();
    let zero = || vec![vec![0.0; n]; 3];
    let (mut slopes, mut forces) = (zero(), zero());
    for _ in 0..12 {
        let (before, kicks) = (slopes.clone(), forces.clone());
        for stage in 0..3 {
            let (mut x, mut v) = (state.x.clone(), state.v.clone());
            for other in 0..3 {
                for i in 0..n {
                    x[i] += h * a[stage][other] * before[other][i];
                    v[i] += h * a[stage][other] * kicks[other][i];
                }
            }
            system.acceleration(state.t + c[stage] * h, &x, &v, &mut forces[stage]);
            slopes[stage] = v;
        }
    }
    for stage in 0..3 {
        for i in 0..n {
            state.x[i] += h * b[stage] * slopes[stage][i];
            state.v[i] += h * b[stage] * forces[stage][i];
        }
    }
}

/// The motion as steps of at most `h` give it; its bar is the distance from steps twice as large.
pub struct Gauss<'a> {
    system: &'a (dyn System + Sync),
    start: State,
    h: f64,
    bar: f64,
    /// What was asked for before: every method of an order study asks for the same times.
    known: Mutex<Vec<(Vec<f64>, States)>>,
}

impl<'a> Gauss<'a> {
    pub fn new(system: &'a (dyn System + Sync), start: State, until: f64, h: f64) -> Self {
        let mut fine = Self {
            system,
            start,
            h,
            bar: 0.0,
            known: Mutex::default(),
        };
        let times: Vec<f64> = (1..=50).map(|k| until * f64::from(k) / 50.0).collect();
        let ours = fine.integrate(&times);
        fine.h = 2.0 * h;
        fine.bar = super::distance(&ours.x, &fine.integrate(&times).x);
        fine.h = h;
        fine
    }

    fn integrate(&self, times: &[f64]) -> States {
        let mut state = self.start.clone();
        let mut states = States {
            dim: state.x.len(),
            ..States::default()
        };
        for &time in times {
            let from = state.t;
            let steps = ((time - from) / self.h).ceil();
            for k in 0..steps as usize {
                state.t = from + (time - from) * (k as f64 / steps);
                step(self.system, (time - from) / steps, &mut state);
            }
            state.t = time;
            states.x.extend_from_slice(&state.x);
            states.v.extend_from_slice(&state.v);
        }
        states
    }
}

impl Motion for Gauss<'_> {
    fn states(&self, times: &[f64]) -> States {
        let mut known = self.known.lock().expect("no panic");
        if let Some((_, states)) = known.iter().find(|(asked, _)| asked == times) {
            return states.clone();
        }
        let states = self.integrate(times);
        known.push((times.to_vec(), states.clone()));
        states
    }

    fn error_bar(&self, _t: f64) -> f64 {
        self.bar
    }
}
