//! The rest of one scene, with all that is said of it.

use crate::measure::rest::{self, Mode, Modes, Rest, RestError};
use crate::measure::{Reaction, Statics, Strain};
use crate::physics::{ForceKinds, ParticleSystem, State};
use crate::report::words::{self, listed};
use crate::scene::Scene;
use crate::verbs::rest::{Balance, Moved, Oscillation, Pull};

/// Motions that a report has: of those that grow, that cost nothing and that oscillate, the softest.
const SHOWN: [usize; 3] = [3, 2, 8];
/// A particle that has moved by a smaller part of the scene's size has not.
const MOVED: f64 = 1e-12;

/// Finds the rest of a scene, and what is said of it.
///
/// # Errors
/// [`RestError`].
pub fn find(scene: &Scene) -> Result<(Rest, Balance), RestError> {
    let held = rest::held(scene);
    let system = ParticleSystem::new(&held);
    let start = ParticleSystem::initial_state(&held);
    let found = rest::find(&held)?;
    let state = State::new(found.x.clone(), vec![0.0; found.x.len()]);
    let statics = Statics::new(&held);
    let tensions = statics.tensions(&state).into_iter().enumerate();
    let tensions = tensions.map(|(spring, tension_n)| Pull {
        tension_n,
        spring: Some(spring),
        rod: None,
        particles: held.springs[spring].ends,
    });
    let rods = statics.rod_tensions(&state).into_iter().enumerate();
    let rods = rods.map(|(rod, tension_n)| Pull {
        tension_n,
        spring: None,
        rod: Some(rod),
        particles: held.rods[rod].ends,
    });
    let tensions = tensions.chain(rods);
    let finite = tensions.filter(|pull| pull.tension_n.is_finite());
    let order = |a: &Pull, b: &Pull| a.tension_n.total_cmp(&b.tension_n);
    let reactions = statics.reactions(&state);
    let fixed = held.particles.iter().enumerate().filter(|(_, p)| p.fixed);
    let reactions = fixed.map(|(particle, _)| Reaction {
        particle,
        force_n: [0, 1, 2].map(|axis| reactions[3 * particle + axis]),
    });
    let (particle, distance) = rest::farthest(&start.x, &found.x);
    let by_m = [0, 1, 2].map(|axis| found.x[3 * particle + axis] - start.x[3 * particle + axis]);
    let potential = system.effects().iter().map(|(row, effect)| {
        let energies = [&start.x, &found.x].map(|x| effect.potential(0.0, x));
        (row.id.to_owned(), energies)
    });
    let modes = rest::modes_of(&held, &found.x);
    let balance = Balance {
        farthest: (distance > MOVED * rest::size(&held)).then_some(Moved { particle, by_m }),
        force_left_n: found.force_left,
        newton_iterations: found.iterations,
        potential_j: potential.collect(),
        tension_max: finite.clone().max_by(order),
        tension_min: finite.min_by(order),
        reactions: reactions.collect(),
        growing: modes.as_ref().map_or(0, Modes::unstable),
        free: modes.as_ref().map_or(0, Modes::free),
        counted: modes.as_ref().is_some_and(Modes::counted),
        oscillations: modes.as_ref().map(oscillations).unwrap_or_default(),
        left_out: left_out(&system, modes.is_none())
            .into_iter()
            .chain(beyond_limit(&held, &found.x))
            .collect(),
    };
    Ok((found, balance))
}

fn oscillations(modes: &Modes) -> Vec<Oscillation> {
    let kind = |mode: &&Mode| match mode.stiffness {
        k if k < 0.0 => 0,
        0.0 => 1,
        _ => 2,
    };
    let of = |which: usize| modes.lowest.iter().filter(move |mode| kind(mode) == which);
    let shown = SHOWN.into_iter().enumerate();
    shown
        .flat_map(|(which, most)| of(which).take(most))
        .map(oscillation)
        .collect()
}

/// That the rest leaves out the strain limit, where a spring is beyond it there.
fn beyond_limit(scene: &Scene, x: &[f64]) -> Option<String> {
    let strain = Strain::at(scene, x)?;
    let (most, limit) = (
        words::percent(strain.largest?),
        words::percent(strain.ratio),
    );
    (!strain.met).then(|| {
        format!(
            "the strain limit of {limit} is left out: spring {} is at {most} here, so that the limit holds the scene \
             elsewhere",
            strain.spring
        )
    })
}

/// What oscillations of this system leave out.
fn left_out(system: &ParticleSystem, unknown: bool) -> Vec<String> {
    let kinds = |of: ForceKinds| {
        let effects = system.effects().iter();
        let of: Vec<String> = effects
            .filter(|(_, effect)| effect.kinds().has(of))
            .map(|(row, _)| row.id.to_owned())
            .collect();
        (!of.is_empty()).then(|| listed(&of))
    };
    let turning = kinds(ForceKinds::GYROSCOPIC)
        .map(|id| format!("{id} turns what moves, which the frequencies leave out"));
    let pulling = kinds(ForceKinds::NON_LINEAR).map(|id| {
        format!("of {id} the frequencies have the symmetric part alone: flutter is not seen")
    });
    let none = unknown.then(|| "no frequency was found".to_owned());
    turning.into_iter().chain(pulling).chain(none).collect()
}

fn oscillation(mode: &Mode) -> Oscillation {
    let rate = mode.stiffness.abs().sqrt();
    let shape = mode.shape.iter().enumerate();
    // Of equal ones the first.
    let most = shape.fold((0, 0.0_f64), |most, (at, c)| {
        if c.abs() > most.1 {
            (at, c.abs())
        } else {
            most
        }
    });
    Oscillation {
        omega_rad_s: (mode.stiffness >= 0.0).then_some(rate),
        growth_per_s: (mode.stiffness < 0.0).then_some(rate),
        particle: most.0 / 3,
        axis: most.0 % 3,
    }
}
