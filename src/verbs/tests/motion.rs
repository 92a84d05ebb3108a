//! A planar oscillator under textbook schemes.

use crate::solvers::SolverKind;

/// k / m of the oscillator, 1/s².
const K: f64 = 50.0;

/// One step of (x, v) in the plane; each scheme is linear and acts on the axes alike.
pub type Step = fn(f64, [f64; 2]) -> [f64; 2];

pub const SCHEMES: [(&str, SolverKind, f64, Step); 9] = [
    ("symplectic_euler", SolverKind::Integrator, 1.0, symplectic),
    (
        "explicit_euler",
        SolverKind::Integrator,
        1.0,
        |h, [x, v]| [x + h * v, v - h * K * x],
    ),
    ("midpoint", SolverKind::Integrator, 1.0, |h, [x, v]| {
        let (xm, vm) = (x + h / 2.0 * v, v - h / 2.0 * K * x);
        [x + h * vm, v - h * K * xm]
    }),
    (
        "velocity_verlet",
        SolverKind::Integrator,
        1.0,
        |h, [x, v]| {
            let half = v - h / 2.0 * K * x;
            let x = x + h * half;
            [x, half - h / 2.0 * K * x]
        },
    ),
    ("rk4", SolverKind::Integrator, 1.0, rk4),
    ("implicit_euler", SolverKind::Integrator, 1.0, implicit),
    ("rapier", SolverKind::Rapier, 4.0, implicit),
    ("rapier-forces", SolverKind::Rapier, 1.0, symplectic),
    (
        "symplectic_euler_drift_first",
        SolverKind::Integrator,
        1.0,
        |h, [x, v]| {
            let x = x + h * v;
            [x, v - h * K * x]
        },
    ),
];

pub fn symplectic(h: f64, [x, v]: [f64; 2]) -> [f64; 2] {
    let v = v - h * K * x;
    [x + h * v, v]
}

pub fn implicit(h: f64, [x, v]: [f64; 2]) -> [f64; 2] {
    let v = (v - h * K * x) / (1.0 + h * h * K);
    [x + h * v, v]
}

fn rk4(h: f64, [x, v]: [f64; 2]) -> [f64; 2] {
    let f = |[x, v]: [f64; 2]| [v, -K * x];
    let plus = |a: [f64; 2], s: f64, b: [f64; 2]| [a[0] + s * b[0], a[1] + s * b[1]];
    let k1 = f([x, v]);
    let k2 = f(plus([x, v], h / 2.0, k1));
    let k3 = f(plus([x, v], h / 2.0, k2));
    let k4 = f(plus([x, v], h, k3));
    let sum = plus(plus(plus(k1, 2.0, k2), 2.0, k3), 1.0, k4);
    plus([x, v], h / 6.0, sum)
}

pub struct Run {
    pub t: Vec<f64>,
    pub energy: Vec<f64>,
    pub path: Vec<[f64; 2]>,
    pub diverged: bool,
}

/// An ellipse started at (0.5, 0) with speed (0, 3).
pub fn motion(h: f64, duration: f64, substeps: f64, step: Step) -> Run {
    let [mut x, mut y] = [[0.5, 0.0], [0.0, 3.0]];
    let energy = |x: [f64; 2], y: [f64; 2]| {
        0.5 * (x[1] * x[1] + y[1] * y[1] + K * (x[0] * x[0] + y[0] * y[0]))
    };
    let start = energy(x, y);
    let mut run = Run {
        t: vec![],
        energy: vec![],
        path: vec![],
        diverged: false,
    };
    for n in 0..=(duration / h - 1e-9).ceil() as u64 {
        let error = energy(x, y) / start - 1.0;
        run.t.push(n as f64 * h);
        run.energy.push(error);
        run.path.push([x[0], y[0]]);
        if error > 1e12 {
            run.diverged = true;
            break;
        }
        for _ in 0..substeps as u32 {
            (x, y) = (step(h / substeps, x), step(h / substeps, y));
        }
    }
    run
}
