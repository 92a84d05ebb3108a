//! Springs computed wrongly: laws of force that are not the scene's.

use crate::physics::effects::{Effect, Springs};
use crate::physics::{ForceKinds, Jacobian, Linearization, ParticleSystem, Power};
use crate::scene::{DampingModel, Scene, Spring};

/// A spring's pull on its first end and on its second, N, from the vector between them and their velocities.
type Law = fn(&Spring, DampingModel, Ends) -> [[f64; 3]; 2];

/// The ends of a spring.
#[derive(Clone, Copy)]
struct Ends {
    /// From the first to the second, m.
    apart: [f64; 3],
    length: f64,
    /// m/s.
    velocities: [[f64; 3]; 2],
}

/// Springs with a law of their own.
struct Wrong {
    springs: Vec<Spring>,
    damping: DampingModel,
    law: Law,
    /// As the right ones' at the same state.
    right: Springs,
}

/// The scene with this law for its springs.
fn system(scene: &Scene, law: Law) -> Option<ParticleSystem> {
    Springs::new(scene)?;
    Some(ParticleSystem::with(scene, &|row| {
        if row.id != "springs" {
            return (row.build)(scene);
        }
        Some(Box::new(Wrong {
            springs: scene.springs.clone(),
            damping: scene.damping_model,
            law,
            right: Springs::new(scene)?,
        }))
    }))
}

pub(super) fn not_normalised(scene: &Scene) -> Option<ParticleSystem> {
    system(scene, |spring, model, ends| {
        let pull = pull(spring, ends).map(|f| f * ends.length);
        pair(add(pull, damper(spring, model, ends)))
    })
}

pub(super) fn tension_only(scene: &Scene) -> Option<ParticleSystem> {
    system(scene, |spring, model, ends| {
        let pulls = ends.length > spring.rest_length;
        let pull = pull(spring, ends).map(|f| if pulls { f } else { 0.0 });
        pair(add(pull, damper(spring, model, ends)))
    })
}

pub(super) fn own_velocity(scene: &Scene) -> Option<ParticleSystem> {
    scene
        .springs
        .iter()
        .any(|s| s.damping != 0.0)
        .then_some(())?;
    system(scene, |spring, model, ends| {
        let own = |end: usize| {
            let mut velocities = [[0.0; 3]; 2];
            velocities[end] = ends.velocities[end];
            let force = damper(spring, model, Ends { velocities, ..ends });
            if end == 0 { force } else { force.map(|f| -f) }
        };
        let [first, second] = pair(pull(spring, ends));
        [add(first, own(0)), add(second, own(1))]
    })
}

pub(super) fn first_end_only(scene: &Scene) -> Option<ParticleSystem> {
    system(scene, |spring, model, ends| {
        let [first, _] = pair(add(pull(spring, ends), damper(spring, model, ends)));
        [first, [0.0; 3]]
    })
}

pub(super) fn second_end_only(scene: &Scene) -> Option<ParticleSystem> {
    system(scene, |spring, model, ends| {
        let [_, second] = pair(add(pull(spring, ends), damper(spring, model, ends)));
        [[0.0; 3], second]
    })
}

pub(super) fn both_ends_alike(scene: &Scene) -> Option<ParticleSystem> {
    system(scene, |spring, model, ends| {
        let [first, _] = pair(add(pull(spring, ends), damper(spring, model, ends)));
        [first, first]
    })
}

/// The linear spring's force on the first end.
fn pull(spring: &Spring, ends: Ends) -> [f64; 3] {
    let size = spring.stiffness * (ends.length - spring.rest_length);
    ends.apart
        .map(|d| size * (d / ends.length.max(f64::MIN_POSITIVE)))
}

/// The damper's force on the first end.
fn damper(spring: &Spring, model: DampingModel, ends: Ends) -> [f64; 3] {
    let [first, second] = ends.velocities;
    let relative = [0, 1, 2].map(|axis| second[axis] - first[axis]);
    match model {
        DampingModel::Isotropic => relative.map(|v| spring.damping * v),
        DampingModel::Axial => {
            let n = ends.apart.map(|d| d / ends.length.max(f64::MIN_POSITIVE));
            let along = n[0] * relative[0] + n[1] * relative[1] + n[2] * relative[2];
            n.map(|n| spring.damping * along * n)
        }
    }
}

fn pair(force: [f64; 3]) -> [[f64; 3]; 2] {
    [force, force.map(|f| -f)]
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|axis| a[axis] + b[axis])
}

impl Wrong {
    /// The forces on both ends of a spring with its ends' coordinates moved: `by` of coordinate `of`, 0 to 5
    /// for positions and 6 to 11 for velocities.
    fn forces(&self, spring: &Spring, x: &[f64], v: &[f64], of: usize, by: f64) -> [f64; 6] {
        let moved = |values: &[f64], first: usize| {
            [0, 1].map(|end| {
                [0, 1, 2].map(|axis| {
                    let here = first + 3 * end + axis == of;
                    values[3 * spring.ends[end] + axis] + if here { by } else { 0.0 }
                })
            })
        };
        let [first, second] = moved(x, 0);
        let apart = [0, 1, 2].map(|axis| second[axis] - first[axis]);
        let squared: f64 = apart.iter().map(|d| d * d).sum();
        let ends = Ends {
            apart,
            length: squared.sqrt(),
            velocities: moved(v, 6),
        };
        let [first, second] = (self.law)(spring, self.damping, ends);
        [
            first[0], first[1], first[2], second[0], second[1], second[2],
        ]
    }
}

impl Effect for Wrong {
    fn members(&self) -> usize {
        self.springs.len()
    }

    fn kinds(&self) -> ForceKinds {
        self.right.kinds()
    }

    fn add_force(&self, _t: f64, x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        for spring in &self.springs {
            for (at, force) in self.forces(spring, x, v, 12, 0.0).into_iter().enumerate() {
                f[3 * spring.ends[at / 3] + at % 3] += force;
            }
        }
        Power::default()
    }

    fn add_rounding(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        self.right.add_rounding(t, x, v, f);
    }

    fn add_damping(&self, x: &[f64], w: &[f64], f: &mut [f64]) {
        let rest = vec![0.0; w.len()];
        let mut without = rest.clone();
        self.add_force(0.0, x, &rest, &mut without);
        self.add_force(0.0, x, w, f);
        for (f, without) in f.iter_mut().zip(without) {
            *f -= without;
        }
    }

    /// By central differences: enough for Newton's iteration to converge.
    fn add_jacobian(&self, _t: f64, x: &[f64], v: &[f64], _: Linearization, out: &mut Jacobian) {
        const STEP: f64 = 1e-6;
        for spring in &self.springs {
            let place = |at: usize| 3 * spring.ends[at % 6 / 3] + at % 3;
            for column in 0..12 {
                let [plus, minus] = [STEP, -STEP].map(|by| self.forces(spring, x, v, column, by));
                let slopes = if column < 6 {
                    &mut out.position
                } else {
                    &mut out.velocity
                };
                for (row, (plus, minus)) in plus.iter().zip(minus).enumerate() {
                    slopes.push((place(row), place(column), (plus - minus) / (2.0 * STEP)));
                }
            }
        }
    }
}
