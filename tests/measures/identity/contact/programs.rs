//! Programs of one ball above a floor, from textbook formulas.

use super::{Precision, Rows, Scene};

pub type Vector = [f64; 3];

/// A ball of 1 kg and a radius of 0.1 m above the floor z = 0.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    pub x: Vector,
    pub v: Vector,
    pub e: f64,
    pub mu: f64,
}

pub const RADIUS: f64 = 0.1;

impl Ball {
    pub fn new(e: f64, mu: f64) -> Self {
        Self {
            x: [0.0, 0.0, 1.0],
            v: [2.0, 0.7, 0.0],
            e,
            mu,
        }
    }
}

/// Gravity of 9.81 m/s², drag, N s/m, and a spring of rest length 0 to (0, 0, 3), N/m.
#[derive(Clone, Copy, Debug, Default)]
pub struct Forces {
    pub drag: f64,
    pub stiffness: f64,
    /// A penalty: stiffness, damping, and whether it never pulls.
    pub penalty: Option<(f64, f64, bool)>,
}

impl Forces {
    pub fn acceleration(&self, x: Vector, v: Vector, mu: f64) -> Vector {
        let mut a = [0.0, 0.0, -9.81];
        let anchor = [0.0, 0.0, 3.0];
        for i in 0..3 {
            a[i] += self.stiffness * (anchor[i] - x[i]) - self.drag * v[i];
        }
        let depth = RADIUS - x[2];
        if let Some((k, c, clipped)) = self.penalty
            && depth > 0.0
        {
            let push = k * depth - c * v[2];
            let push = if clipped { push.max(0.0) } else { push };
            let fast = v[0].hypot(v[1]);
            a[2] += push;
            if fast > 0.0 {
                a[0] -= mu * push * v[0] / fast;
                a[1] -= mu * push * v[1] / fast;
            }
        }
        a
    }
}

pub fn plus(x: Vector, h: f64, v: Vector) -> Vector {
    [0, 1, 2].map(|i| x[i] + h * v[i])
}

pub type Point = (Vector, Vector);
pub type Step = fn(&dyn Fn(Vector, Vector) -> Vector, f64, Point) -> Point;

pub const METHODS: [(&str, Step); 3] = [
    ("symplectic_euler", |a, h, (x, v)| {
        let v = plus(v, h, a(x, v));
        (plus(x, h, v), v)
    }),
    ("velocity_verlet", |a, h, (x, v)| {
        let half = plus(v, 0.5 * h, a(x, v));
        let x = plus(x, h, half);
        (x, plus(half, 0.5 * h, a(x, half)))
    }),
    ("rk4", |a, h, (x, v)| {
        let k1 = (v, a(x, v));
        let at = |k: Point, h: f64| {
            let (x, v) = (plus(x, h, k.0), plus(v, h, k.1));
            (v, a(x, v))
        };
        let k2 = at(k1, 0.5 * h);
        let k3 = at(k2, 0.5 * h);
        let k4 = at(k3, h);
        let sum = |k: [Vector; 4]| {
            [0, 1, 2].map(|i| h / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]))
        };
        (
            plus(x, 1.0, sum([k1.0, k2.0, k3.0, k4.0])),
            plus(v, 1.0, sum([k1.1, k2.1, k3.1, k4.1])),
        )
    }),
];

/// When velocities are turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    Event,
    End,
    EndClamped,
    EndMirrored,
    Start,
    AfterKick,
    BeforeKick,
    /// By forces alone, or not at all.
    Never,
}

/// What becomes of a velocity with v_z < 0: from v, e, µ, h.
pub type Turn = fn(Vector, f64, f64, f64) -> Vector;

/// Newton's restitution and Coulomb's friction.
pub fn bounce(v: Vector, e: f64, mu: f64, _: f64) -> Vector {
    let impulse = (1.0 + e) * -v[2];
    let fast = v[0].hypot(v[1]);
    let kept = if fast > 0.0 {
        (1.0 - mu * impulse / fast).max(0.0)
    } else {
        1.0
    };
    [kept * v[0], kept * v[1], -e * v[2]]
}

/// Rows of a program: method, rule, and how it turns velocities.
pub fn rows(
    scene: &Scene,
    ball: &Ball,
    forces: &Forces,
    step: Step,
    (rule, turn): (Rule, Turn),
    steps: u64,
) -> Rows {
    let h = scene.solver.timestep;
    let a = |x: Vector, v: Vector| forces.acceleration(x, v, ball.mu);
    let turn = |v: Vector| turn(v, ball.e, ball.mu, h);
    let meets = |x: Vector, v: Vector| x[2] <= RADIUS && v[2] < 0.0;
    let next = |(mut x, mut v): Point| {
        match rule {
            Rule::Never => (x, v) = step(&a, h, (x, v)),
            Rule::Event => (x, v) = located(&|h, at| step(&a, h, at), &turn, h, (x, v)),
            Rule::End | Rule::EndClamped | Rule::EndMirrored => {
                (x, v) = step(&a, h, (x, v));
                let depth = RADIUS - x[2];
                if meets(x, v) {
                    v = turn(v);
                }
                match rule {
                    Rule::EndClamped if depth > 0.0 => x[2] = RADIUS,
                    Rule::EndMirrored if depth > 0.0 => x[2] = RADIUS + depth,
                    _ => {}
                }
            }
            Rule::Start => {
                if meets(x, v) {
                    v = turn(v);
                }
                (x, v) = step(&a, h, (x, v));
            }
            Rule::AfterKick => {
                v = plus(v, h, a(x, v));
                if meets(x, v) {
                    v = turn(v);
                }
                x = plus(x, h, v);
            }
            Rule::BeforeKick => {
                v = if meets(x, v) {
                    turn(v)
                } else {
                    plus(v, h, a(x, v))
                };
                x = plus(x, h, v);
            }
        }
        (x, v)
    };
    recorded(h, ball, &next, steps)
}

/// Rows of steps of a ball beside a fixed particle.
pub fn recorded(h: f64, ball: &Ball, next: &dyn Fn(Point) -> Point, steps: u64) -> Rows {
    let mut all = vec![(ball.x, ball.v)];
    for _ in 0..steps {
        all.push(next(all[all.len() - 1]));
    }
    let fixed = [0.0, 0.0, 3.0];
    Rows {
        timestep: h,
        dim: 6,
        steps: (0..=steps).collect(),
        x: all.iter().flat_map(|(x, _)| [*x, fixed].concat()).collect(),
        v: Some(
            all.iter()
                .flat_map(|(_, v)| [*v, [0.0; 3]].concat())
                .collect(),
        ),
        precision: Precision::Double,
        precision_v: Precision::Double,
        cut: false,
    }
}

/// A step that is cut at impacts, each found by bisection of its length.
fn located(
    step: &dyn Fn(f64, Point) -> Point,
    turn: &dyn Fn(Vector) -> Vector,
    h: f64,
    mut at: Point,
) -> Point {
    let mut left = h;
    for _ in 0..100 {
        let end = step(left, at);
        if end.0[2] >= RADIUS {
            return end;
        }
        let (mut low, mut high) = (0.0, left);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if step(middle, at).0[2] >= RADIUS {
                low = middle;
            } else {
                high = middle;
            }
        }
        let (x, v) = step(low, at);
        at = (x, turn(v));
        left -= low;
    }
    panic!("bounces accumulate: take fewer steps");
}
