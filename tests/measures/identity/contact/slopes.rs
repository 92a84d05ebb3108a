//! Programs of one ball on a slope or a belt, where the normal, the surface's velocity or gravity is otherwise.

use super::{contact, found, parsed};
use crate::identity::{Precision, Rows, Scene};

type Vector = [f64; 3];

const H: f64 = 0.01;
const SLOPE: Vector = [-0.5, 0.0, 0.866_025_403_784_438_6];

fn dot(a: Vector, b: Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn plus(x: Vector, h: f64, v: Vector) -> Vector {
    [0, 1, 2].map(|i| x[i] + h * v[i])
}

/// A ball of 1 kg without extent, beside a plane through the origin.
struct Program {
    x: Vector,
    v: Vector,
    normal: Vector,
    belt: Vector,
    e: f64,
    mu: f64,
    g: f64,
}

impl Program {
    fn scene(&self) -> Scene {
        let Self {
            x,
            v,
            normal,
            belt,
            e,
            mu,
            ..
        } = self;
        parsed(&format!(
            "solver: {{type: rk4, timestep: {H}, gravity: -9.81}}\nduration: 10\n\
             particles: [{{pos: {x:?}, vel: {v:?}, mass: 1, radius: 0}}]\n\
             colliders: [{{plane: {{normal: {normal:?}}}, restitution: {e}, friction: {mu}, \
             driven: {{velocity: {belt:?}}}}}]\n"
        ))
    }

    /// Newton's restitution and Coulomb's friction.
    fn turned(&self, v: Vector) -> Vector {
        let u = plus(v, -1.0, self.belt);
        let parting = dot(u, self.normal);
        if parting >= 0.0 {
            return v;
        }
        let impulse = -(1.0 + self.e) * parting;
        let along = plus(u, -parting, self.normal);
        let fast = dot(along, along).sqrt();
        let kept = if fast > 0.0 {
            (1.0 - self.mu * impulse / fast).max(0.0)
        } else {
            1.0
        };
        plus(plus(self.belt, kept, along), -self.e * parting, self.normal)
    }

    fn rows(&self, next: &dyn Fn(Vector, Vector) -> (Vector, Vector), steps: u64) -> Rows {
        let mut all = vec![(self.x, self.v)];
        for _ in 0..steps {
            let (x, v) = all[all.len() - 1];
            all.push(next(x, plus(v, H, [0.0, 0.0, -self.g])));
        }
        Rows {
            timestep: H,
            dim: 3,
            steps: (0..=steps).collect(),
            x: all.iter().flat_map(|(x, _)| *x).collect(),
            v: Some(all.iter().flat_map(|(_, v)| *v).collect()),
            precision: Precision::Double,
            precision_v: Precision::Double,
            cut: false,
        }
    }

    /// Symplectic Euler, turned at the end of a step and put on the plane of this normal.
    fn clamped(&self, plane: Vector, steps: u64) -> Rows {
        let next = |x: Vector, v: Vector| {
            let x = plus(x, H, v);
            match dot(x, plane) {
                gap if gap < 0.0 => (plus(x, -gap, plane), self.turned(v)),
                _ => (x, v),
            }
        };
        self.rows(&next, steps)
    }

    /// Moreau's step: a velocity that closes the gap and no more, and Coulomb's friction of its impulse.
    fn stepped(&self, steps: u64) -> Rows {
        let next = |x: Vector, v: Vector| {
            let parting = dot(v, self.normal);
            let pushed = (-dot(x, self.normal) / H - parting).max(0.0);
            let along = plus(v, -parting, self.normal);
            let fast = dot(along, along).sqrt();
            let kept = if fast > 0.0 {
                (1.0 - self.mu * pushed / fast).max(0.0)
            } else {
                1.0
            };
            let lost = plus(along, -kept, along);
            let v = plus(plus(v, pushed, self.normal), -1.0, lost);
            (plus(x, H, v), v)
        };
        self.rows(&next, steps)
    }
}

fn mistakes(scene: &Scene, rows: &Rows) -> Vec<String> {
    let found = found(scene, rows, None);
    let treated = contact(&found).unwrap_or_else(|| panic!("no contact: {found:#?}"));
    assert!(treated.treatment.is_some(), "{found:#?}");
    treated.mistakes.clone()
}

#[test]
fn a_belt_that_runs_otherwise_is_named() {
    let asked = Program {
        x: [0.0, 0.0, 0.1],
        v: [0.3, 0.2, 0.0],
        normal: [0.0, 0.0, 1.0],
        belt: [4.0, 0.0, 0.0],
        e: 0.5,
        mu: 0.2,
        g: 9.81,
    };
    let scene = asked.scene();
    for (factor, wrong) in [
        (1.0, None),
        (0.0, Some("obstacle_at_rest")),
        (-1.0, Some("obstacle_backwards")),
    ] {
        let own = Program {
            belt: asked.belt.map(|u| factor * u),
            ..asked
        };
        let named = mistakes(&scene, &own.clamped(own.normal, 100));
        assert_eq!(named, wrong.into_iter().collect::<Vec<_>>(), "{factor}");
    }
}

#[test]
fn a_slope_whose_normal_is_taken_to_be_upright_is_named() {
    let asked = Program {
        x: [0.0, 0.0, 0.5],
        v: [0.3, 0.2, 0.0],
        normal: SLOPE,
        belt: [0.0; 3],
        e: 0.6,
        mu: 0.2,
        g: 9.81,
    };
    let scene = asked.scene();
    assert!(mistakes(&scene, &asked.clamped(SLOPE, 100)).is_empty());
    let own = Program {
        normal: [0.0, 0.0, 1.0],
        ..asked
    };
    assert_eq!(
        mistakes(&scene, &own.clamped(SLOPE, 100)),
        ["normal_along_axis"]
    );
}

/// a = g (sin - µ cos) is one number of both: 9.8 m/s² at µ = 0.2 slides as 9.81 does at 0.200385.
#[test]
fn gravity_along_a_slope_is_told_from_friction_by_numbers_that_are_written() {
    let asked = Program {
        x: [0.0; 3],
        v: [0.0; 3],
        normal: SLOPE,
        belt: [0.0; 3],
        e: 0.0,
        mu: 0.2,
        g: 9.81,
    };
    let scene = asked.scene();
    assert!(mistakes(&scene, &asked.stepped(100)).is_empty());
    let own = Program { mu: 0.3, ..asked };
    assert_eq!(mistakes(&scene, &own.stepped(100)), ["friction"]);
    let found = found(&scene, &Program { g: 9.8, ..asked }.stepped(100), None);
    let explained = found
        .explained
        .as_ref()
        .unwrap_or_else(|| panic!("{found:#?}"));
    let one = &explained.deviations[0];
    assert!(
        found.identity.is_none() && one.what == "gravity",
        "{found:#?}"
    );
    // A factor of a fit to doubles: the worst of its conditions is 1e3 of their rounding.
    assert!((one.factor * 9.81 - 9.8).abs() < 1e-12, "{found:#?}");
    assert!(one.sentence.contains("friction of 0.2003"), "{found:#?}");
}
