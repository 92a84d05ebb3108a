//! The effects that rapier has itself, each with a row that adds it to a world.
//!
//! rapier lacks an effect without a row here, and a scene that calls for it is [`Unsupported`].

use super::world::{End, NEGLIGIBLE, World, unsupported};
use crate::physics::ParticleSystem;
use crate::scene::{DampingModel, Scene, Spring};
use crate::solvers::Unsupported;
use rapier3d::dynamics::{
    GenericJoint, GenericJointBuilder, JointAxesMask, JointAxis, MotorModel, SpringJointBuilder,
};

/// An effect, expressed by rapier's own joints, gravity or forces.
struct Mirror {
    /// The effect's id in `effects::REGISTRY`.
    effect: &'static str,
    /// Adds the effect to a world with substeps of this many seconds.
    add: fn(&Scene, f64, &mut World) -> Result<(), Unsupported>,
}

static MIRRORS: &[Mirror] = &[
    Mirror {
        effect: "gravity",
        add: |scene, _, world| {
            world.set_gravity(scene.gravity());
            Ok(())
        },
    },
    Mirror {
        effect: "springs",
        add: springs,
    },
    Mirror {
        effect: "drag",
        add: drag,
    },
    Mirror {
        effect: "driven",
        // The bodies of driven particles are kinematic from the start.
        add: |_, _, _| Ok(()),
    },
    Mirror {
        effect: "wind",
        add: wind,
    },
];

/// Adds every effect of the system to the world, in registry order.
pub(super) fn add_all(
    scene: &Scene,
    system: &ParticleSystem,
    substep: f64,
    world: &mut World,
) -> Result<(), Unsupported> {
    for (row, _) in system.effects() {
        let Some(mirror) = MIRRORS.iter().find(|mirror| mirror.effect == row.id) else {
            return Err(unsupported(format!(
                "rapier has no native `{}`; rapier-forces takes it",
                row.id
            )));
        };
        (mirror.add)(scene, substep, world)?;
    }
    rods(scene, world);
    Ok(())
}

/// The stiffness of a joint that stands for a rod, N/m. Ropes and spherical joints lose energy, locked ones weld:
/// rapier's rope loses a fifth of a pendulum's energy in 10 s at 60 Hz.
const ROD_STIFFNESS: f64 = 1e9;

/// The springs whose joints stand for a scene's rods.
pub fn stand_ins(scene: &Scene) -> impl Iterator<Item = Spring> {
    scene.rods.iter().map(|rod| Spring {
        ends: rod.ends,
        rest_length: rod.length,
        stiffness: ROD_STIFFNESS,
        ..Spring::default()
    })
}

fn rods(scene: &Scene, world: &mut World) {
    for stiff in stand_ins(scene) {
        world.join(stiff.ends.map(End::Particle), spring_joint(&stiff, 0.0));
    }
}

/// Adds a spring joint for each spring. An axial damper is part of the joint; an isotropic one is a motor of
/// its own.
fn springs(scene: &Scene, substep: f64, world: &mut World) -> Result<(), Unsupported> {
    let starts = scene.starts();
    for (id, spring) in scene.springs.iter().enumerate() {
        let [a, b] = spring.ends;
        if scene.particles[a].fixed && scene.particles[b].fixed {
            continue;
        }
        if spring.rest_length > 0.0 && starts[a] == starts[b] {
            return Err(unsupported(format!(
                "spring {id} starts with both ends in one place but has a rest length: rapier's \
                 joint has no direction to push it in"
            )));
        }
        let ends = spring.ends.map(End::Particle);
        let isotropic = scene.damping_model == DampingModel::Isotropic;
        let axial = if isotropic { 0.0 } else { spring.damping };
        if has_effect(id, spring.stiffness, axial, substep)? {
            world.join(ends, spring_joint(spring, axial));
        }
        if isotropic && has_effect(id, 0.0, spring.damping, substep)? {
            world.join(ends, velocity_motor(spring.damping, [0.0; 3]));
        }
    }
    Ok(())
}

/// Whether a joint of this stiffness and damping has an effect. rapier treats 1/(h² k + h c) as 0 when the sum
/// is not above 1e-20, and the joint is then *rigid*. So there is no joint where both are 0, and softer
/// joints are unsupported.
fn has_effect(id: usize, k: f64, c: f64, h: f64) -> Result<bool, Unsupported> {
    let softness = h * h * k + h * c;
    if k == 0.0 && c == 0.0 {
        Ok(false)
    } else if softness > NEGLIGIBLE && h * k + c > NEGLIGIBLE {
        Ok(true)
    } else {
        Err(unsupported(format!(
            "spring {id} is so soft (h² k + h c = {softness:.1e} kg) that rapier would make it rigid"
        )))
    }
}

fn spring_joint(spring: &Spring, damping: f64) -> GenericJoint {
    SpringJointBuilder::new(spring.rest_length, spring.stiffness, damping)
        .contacts_enabled(false)
        .spring_model(MotorModel::ForceBased)
        .into()
}

/// A damper of the velocity of the second body relative to the first, less `target`, N s/m: three motors. It is a
/// joint of its own, since rapier ignores single-axis motors on the axes that a spring joint couples.
fn velocity_motor(damping: f64, target: [f64; 3]) -> GenericJoint {
    let axes = [JointAxis::LinX, JointAxis::LinY, JointAxis::LinZ];
    let start = GenericJointBuilder::new(JointAxesMask::empty()).contacts_enabled(false);
    axes.into_iter()
        .zip(target)
        .fold(start, |joint, (axis, target)| {
            joint
                .motor_model(axis, MotorModel::ForceBased)
                .set_motor(axis, 0.0, target, 0.0, damping)
        })
        .into()
}

/// Adds motors that bring each particle to the velocity of the air. Their other end is a body at rest, and the air's
/// velocity their target. Not to be confused with rapier's `linear_damping`,
/// which scales the velocity once a step, for any number of substeps.
fn drag(scene: &Scene, substep: f64, world: &mut World) -> Result<(), Unsupported> {
    for (i, particle) in scene.particles.iter().enumerate() {
        if particle.fixed || particle.drag <= 0.0 {
            continue;
        }
        if substep * particle.drag <= NEGLIGIBLE {
            return Err(unsupported(format!(
                "particle {i}'s drag of {} N s/m is so small that rapier would stop it dead",
                particle.drag
            )));
        }
        let motor = velocity_motor(particle.drag, scene.air().velocity);
        world.join([End::Air, End::Particle(i)], motor);
    }
    Ok(())
}

/// Adds the constant force of wind. rapier keeps a body's forces until they are reset.
fn wind(scene: &Scene, _: f64, world: &mut World) -> Result<(), Unsupported> {
    if let Some(wind) = &scene.wind {
        world.add_force_to_all(wind.direction.map(|d| wind.strength * d));
    }
    Ok(())
}
