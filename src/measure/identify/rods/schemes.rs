//! The schemes of scenes with rods that are no rows of the registry, the likelier ones first.

use crate::integrators::{self, StepError};
use crate::measure::identify::altered::Around;
use crate::measure::identify::candidate::{Candidate, Forces};
use crate::measure::identify::keeping::{Keeping, Kept, Moved};
use crate::measure::identify::step::Step;
use crate::measure::identify::treated::{explicit, treated, two_kicks};
use crate::physics::{ParticleSystem, State, System};
use crate::scene::{Constraints, Scene, Stabilisation};
use crate::vector::axpy;
use std::sync::Arc;

/// How a method may be stabilised otherwise than the scene says: the id's form, and what that is.
const STABILISED: [(Stabilisation, &str, &str); 3] = [
    (
        Stabilisation::None,
        "unstabilised",
        "rods are kept by their forces alone: nothing is done about drift",
    ),
    (Stabilisation::Project, "projected", PROJECTED),
    (
        Stabilisation::Baumgarte,
        "baumgarte",
        "Baumgarte's forces pull rods back",
    ),
];

const PROJECTED: &str =
    "positions and velocities are moved onto the rods after each step, each particle by its 1/m";
/// How positions are moved onto rods that share particles: the ids' ending, and what that is.
const PROJECTIONS: [(Moved, &str, &str); 3] = [
    (Moved::Solved, "", ""),
    (
        Moved::Straight,
        "_straight",
        ", along the directions that rods have before it",
    ),
    (
        Moved::SweptOut,
        "_by_sweeps",
        ", one rod after the other until all lengths hold",
    ),
];

/// Sweeps of position-based dynamics that are tried.
const SWEEPS: [u32; 36] = {
    let mut all = [0; 36];
    let mut k = 0;
    while k < 32 {
        all[k] = k as u32 + 1;
        k += 1;
    }
    (all[32], all[33], all[34], all[35]) = (40, 50, 64, 100);
    all
};
/// Substeps of position-based dynamics, and sweeps in each of them.
const SUBSTEPS: std::ops::RangeInclusive<u32> = 2..=20;
const FEW: [u32; 6] = [1, 2, 3, 4, 5, 10];

/// Methods that take rods, in this many substeps, stabilised otherwise than the scene says.
pub(in super::super) fn restabilised(
    scene: &Scene,
    system: &ParticleSystem,
    substeps: u32,
) -> Vec<Candidate> {
    if system.rods().is_none() {
        return Vec::new();
    }
    let own = scene.constraints.clone().unwrap_or_default();
    let others = STABILISED
        .iter()
        .filter(|(by, ..)| *by != own.stabilisation);
    let methods = Candidate::plain(system, substeps).filter(|c| !c.keeps_rods());
    let treated = treated(system).into_iter().chain(two_kicks(system));
    let treated = treated.filter(|_| substeps == 1);
    let methods: Vec<Candidate> = methods.chain(treated).collect();
    let each = others.flat_map(|(by, id, says)| {
        let keeping = Keeping::Stabilised(Constraints {
            stabilisation: *by,
            ..own.clone()
        });
        methods.iter().map(move |method| {
            let id = format!("{id}({})", method.id);
            method.clone().keeping(system, &keeping).named(id, *says)
        })
    });
    each.collect()
}

/// Every composed scheme of rods.
pub(in super::super) fn composed(system: &ParticleSystem) -> Vec<Candidate> {
    if system.rods().is_none() {
        return Vec::new();
    }
    let mut all = two_kicks(system);
    all.extend(differences(system));
    all.extend(position_based(system));
    for (positions, id, how) in PROJECTIONS {
        let kept = Kept {
            positions,
            ..Kept::PROJECTED
        };
        if positions != Moved::Solved && coupled(system) {
            let says = format!("{PROJECTED}{how}");
            all.extend(forced(system, kept, &format!("projected{id}"), &says));
        }
        if positions == Moved::Solved || coupled(system) {
            let says = format!("rods have no forces: {PROJECTED}{how}");
            let kept = Kept {
                forces: false,
                ..kept
            };
            all.extend(alone(system, kept, &format!("projected_alone{id}"), &says));
        }
    }
    all
}

/// Methods that keep rods so, where that differs from a projection by masses: those that take rods, with their forces,
/// or explicit ones without them.
pub(in super::super) fn kept(
    system: &ParticleSystem,
    kept: Kept,
    id: &'static str,
    says: &'static str,
) -> Vec<Candidate> {
    let swept = matches!(kept.positions, Moved::Swept(_));
    if (swept && !coupled(system)) || (!kept.masses && !weighs(system)) {
        return Vec::new();
    }
    if kept.forces {
        forced(system, kept, id, says)
    } else {
        alone(system, kept, id, says)
    }
}

/// Methods that take rods, with forces of rods.
fn forced(system: &ParticleSystem, kept: Kept, id: &str, says: &str) -> Vec<Candidate> {
    let Some(keeping) = Keeping::by(kept, system) else {
        return Vec::new();
    };
    let methods = Candidate::plain(system, 1).filter(|c| !c.keeps_rods());
    let named = |method: Candidate| {
        let id = format!("{id}({})", method.id);
        method.keeping(system, &keeping).named(id, says.to_owned())
    };
    methods.map(named).collect()
}

/// Explicit methods without forces of rods.
fn alone(system: &ParticleSystem, kept: Kept, id: &str, says: &str) -> Vec<Candidate> {
    let Some(keeping) = Keeping::by(kept, system) else {
        return Vec::new();
    };
    let free = system.clone().with_rods(|_| None);
    let forces: Forces = Arc::new(free.clone());
    let methods = explicit(free.kinds()).map(|method| {
        let candidate = Candidate::new(&forces, Step::Method(method), method.id);
        let id = format!("{id}({})", method.id);
        candidate
            .keeping(system, &keeping)
            .named(id, says.to_owned())
    });
    methods.collect()
}

/// Whether sweeps have to be repeated: two rods share a particle that moves.
pub(super) fn coupled(system: &ParticleSystem) -> bool {
    let Some(rods) = system.rods() else {
        return false;
    };
    let mut held = vec![false; rods.weights().len()];
    let ends = rods.ends().iter().flatten();
    let mut moving = ends.filter(|end| rods.weights()[**end] > 0.0);
    moving.any(|end| std::mem::replace(&mut held[*end], true))
}

/// Position-based dynamics: v + h a, x + h v, moved onto the rods; v is what x moved by, over h.
fn position_based(system: &ParticleSystem) -> Vec<Candidate> {
    let named = |kept: Kept, id: String, says: String, substeps| {
        let candidate = euler(system, kept)?.in_substeps(substeps);
        Some(candidate.named(id, says))
    };
    let coupled = coupled(system);
    let solved = |how, says: &str, substeps| {
        let says = format!("position-based dynamics, {says}");
        named(Kept::position_based(how), "pbd".to_owned(), says, substeps)
    };
    let out = |k| match coupled {
        true => solved(Moved::SweptOut, "swept over rods until all lengths hold", k),
        false => solved(Moved::Solved, "solved to rounding", k),
    };
    let swept = |sweeps, substeps| {
        let says = format!("position-based dynamics with {}", times(sweeps));
        let kept = Kept::position_based(Moved::Swept(sweeps));
        named(kept, format!("pbd({sweeps})"), says, substeps)
    };
    let massless = |positions, id: String| {
        let says = "position-based dynamics in which both ends of a rod move by the same, whatever \
                    their mass: each moves by its 1/m";
        let kept = Kept {
            masses: false,
            ..Kept::position_based(positions)
        };
        named(kept, id, says.to_owned(), 1)
    };
    let mut all: Vec<Option<Candidate>> = vec![out(1)];
    if coupled {
        let says = "solved for all rods at once by Newton's method";
        all.push(solved(Moved::Solved, says, 1));
        all.extend(SWEEPS.map(|sweeps| swept(sweeps, 1)));
    }
    all.extend(SUBSTEPS.map(out));
    if coupled {
        all.extend(FEW.iter().flat_map(|n| SUBSTEPS.map(|k| swept(*n, k))));
    }
    if weighs(system) {
        let id = "pbd_without_masses";
        let out = if coupled {
            Moved::SweptOut
        } else {
            Moved::Solved
        };
        all.push(massless(out, id.to_owned()));
        let swept = SWEEPS.iter().filter(|_| coupled);
        all.extend(swept.map(|n| massless(Moved::Swept(*n), format!("{id}({n})"))));
    }
    all.into_iter().flatten().collect()
}

/// "4 sweeps over the rods a step".
pub(super) fn times(sweeps: u32) -> String {
    let s = if sweeps == 1 { "" } else { "s" };
    format!("{sweeps} sweep{s} over the rods a step")
}

/// Whether some rod has two free ends of different masses.
fn weighs(system: &ParticleSystem) -> bool {
    let Some(rods) = system.rods() else {
        return false;
    };
    rods.ends().iter().any(|ends| {
        let [a, b] = ends.map(|end| rods.weights()[end]);
        a > 0.0 && b > 0.0 && a != b
    })
}

/// Symplectic Euler without forces of rods, kept so.
pub(super) fn euler(system: &ParticleSystem, kept: Kept) -> Option<Candidate> {
    let keeping = Keeping::by(kept, system)?;
    let method = integrators::find("symplectic_euler")?;
    let forces: Forces = Arc::new(system.clone());
    let candidate = Candidate::new(&forces, Step::Method(method), method.id);
    Some(candidate.keeping(system, &keeping))
}

/// SHAKE in positions, whose velocities are differences, and Verlet on rods with dampers at the velocity before each kick.
fn differences(system: &ParticleSystem) -> Vec<Candidate> {
    let forces: Forces = Arc::new(system.clone());
    let one = |id, meant, velocities, around: Around, says| {
        let kept = Kept {
            positions: Moved::Not,
            velocities,
            ..Kept::PROJECTED
        };
        let step = Step::Method(integrators::find(meant)?);
        let candidate = Candidate::new(&forces, step, meant).around(Some(around));
        let candidate = candidate.keeping(system, &Keeping::by(kept, system)?);
        Some(candidate.named(id, says))
    };
    let mut all = vec![
        one(
            "shake_staggered",
            "shake",
            Moved::Differences,
            |_, f, h, _, s| shake(f, h, h, s),
            "SHAKE as a leapfrog: velocities are (x1 - x0) / h, those of the middle of a step",
        ),
        one(
            "shake_staggered",
            "shake",
            Moved::Differences,
            |_, f, h, _, s| shake(f, if s.t == 0.0 { 0.5 * h } else { h }, h, s),
            "SHAKE as a leapfrog begun with half a kick: velocities are (x1 - x0) / h, those of the middle of a step",
        ),
    ];
    if system.kinds().depends_on_velocity() {
        const DAMPED: &str =
            "each half kick takes the dampers at the velocity before it, which is of order 1";
        all.push(one(
            "rattle_explicit_damping",
            "rattle",
            Moved::Not,
            |_, f, h, _, s| {
                shake(f, 0.5 * h, h, s)?;
                kick(f, 0.5 * h, s);
                let rods = f.rods().ok_or(NO_RODS)?;
                Ok(rods.still(&s.x, &mut s.v)?)
            },
            DAMPED,
        ));
        all.push(one(
            "shake_explicit_damping",
            "shake",
            Moved::Not,
            |_, f, h, _, s| {
                shake(f, 0.5 * h, h, s)?;
                kick(f, 0.5 * h, s);
                Ok(())
            },
            DAMPED,
        ));
    }
    all.into_iter().flatten().collect()
}

const NO_RODS: StepError = StepError::NotFinite { particle: 0 };

/// v + seconds a, without rods.
fn kick(system: &dyn System, seconds: f64, state: &mut State) {
    let mut a = vec![0.0; state.x.len()];
    system.free_acceleration(state.t, &state.x, &state.v, &mut a);
    axpy(&mut state.v, seconds, &a);
}

/// A kick of `kicked` seconds and a drift of `h` that ends on the rods, by impulses along their old directions.
fn shake(system: &dyn System, kicked: f64, h: f64, state: &mut State) -> Result<(), StepError> {
    let rods = system.rods().ok_or(NO_RODS)?;
    kick(system, kicked, state);
    let end = state.t + h;
    let mut old = rods.at(&state.x)?;
    rods.drift(&mut old, h, &mut state.x, &mut state.v, |x| {
        system.place(end, x, &mut []);
    })?;
    state.t = end;
    Ok(())
}
