//! Splitting methods: one stepper, and a list of kicks and drifts for each method.

use super::velocity_flow::{HALVINGS, VelocityFlow};
use super::{Coefficients, Integrator, MethodRow, StepError, agree, axpy, fit, refuse};
use crate::physics::{Dampers, ForceKinds, State, Sweep, System};
use crate::vector;

/// One factor of the composition; its coefficient multiplies the step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stage {
    /// x += c h v.
    Drift(f64),
    /// Advances the velocity over c h at frozen positions.
    Kick(f64),
}
use Stage::{Drift, Kick};

/// 1 / (2 - 2^(1/3)).
const W1: f64 = 1.351_207_191_959_657_8;
/// 1 - 2 W1.
const W0: f64 = -1.702_414_383_919_315_3;

// The position-extended Forest-Ruth-like solution of Omelyan, Mryglod, Folk 2002.
const XI: f64 = 0.178_617_895_844_809_1;
const LAMBDA: f64 = -0.212_341_831_062_605_4;
const CHI: f64 = -0.066_264_582_669_818_5;

impl Stage {
    /// Kick, then drift.
    pub const SYMPLECTIC_EULER: &'static [Self] = &[Kick(1.0), Drift(1.0)];

    /// Drift, then kick.
    pub const SYMPLECTIC_EULER_DRIFT_FIRST: &'static [Self] = &[Drift(1.0), Kick(1.0)];

    /// Drift, kick, drift.
    pub const POSITION_VERLET: &'static [Self] = &[Drift(0.5), Kick(1.0), Drift(0.5)];

    /// Kick, drift, kick.
    pub const VERLET: &'static [Self] = &[Kick(0.5), Drift(1.0), Kick(0.5)];

    /// Forest and Ruth's triple jump.
    pub const YOSHIDA4: &'static [Self] = &[
        Drift(W1 / 2.0),
        Kick(W1),
        Drift((W0 + W1) / 2.0),
        Kick(W0),
        Drift((W0 + W1) / 2.0),
        Kick(W1),
        Drift(W1 / 2.0),
    ];

    /// Whether the only kicks are two alike, the first stage and the last.
    pub(super) fn half_kicks_at_ends(stages: &[Self]) -> bool {
        let kicks = stages.iter().filter(|stage| matches!(stage, Kick(_)));
        matches!(stages, [Kick(first), .., Kick(last)] if first == last) && kicks.count() == 2
    }

    /// Omelyan, Mryglod and Folk's four kicks.
    pub const PEFRL: &'static [Self] = &[
        Drift(XI),
        Kick((1.0 - 2.0 * LAMBDA) / 2.0),
        Drift(CHI),
        Kick(LAMBDA),
        Drift(1.0 - 2.0 * (CHI + XI)),
        Kick(LAMBDA),
        Drift(CHI),
        Kick((1.0 - 2.0 * LAMBDA) / 2.0),
        Drift(XI),
    ];
}

/// The way a kick treats forces that depend on velocity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DampingTreatment {
    /// v += c h a(x, v): the textbook kick, first order in the damping.
    Explicit,
    /// The exact flow of v' = a(x, v) at frozen x, so that the composition keeps its order.
    ExactFlow,
    /// The exact flow of one damper after the other ([`Sweep`]): one pass over them a sweep, where the exact flow
    /// of all takes ten. It is that flow where no particle has two dampers. Elsewhere the force acts in the
    /// middle of two sweeps, there and back, which keeps the composition symmetric.
    ///
    /// Systems that cannot be swept are damped by the exact flow.
    Sweeps,
    /// Boris' kick: half of the acceleration at rest, the dampers and turns by the midpoint rule, the other half. A
    /// magnetic field turns by 2 atan(w h/2) for its w h, and a damper multiplies by (1 - z/2)/(1 + z/2) for its
    /// e^-z: Cayley's transform instead of the exponential. Of several at a particle, one acts after the other,
    /// there and back.
    ///
    /// Systems that cannot be swept are solved all together.
    Boris,
}

impl DampingTreatment {
    /// The kinds of forces it accepts. An explicit kick is of first order for any force. Flows split the force
    /// into that at rest and D v.
    const fn takes(self) -> ForceKinds {
        match self {
            Self::Explicit => ForceKinds::ANY,
            Self::ExactFlow | Self::Sweeps | Self::Boris => ForceKinds::LINEAR,
        }
    }
}

impl DampingTreatment {
    /// The kinds of forces that a composition of these stages accepts. The forces of rods depend on the velocity of the
    /// moment, which a kick does not know: up to three stages are of order 2 all the same where states are moved onto
    /// the rods, longer ones would lose their order.
    pub(super) const fn takes_in(self, stages: &[Stage]) -> ForceKinds {
        let short = stages.len() <= 3 && !matches!(self, Self::Boris);
        if short {
            self.takes().with(ForceKinds::CONSTRAINED)
        } else {
            self.takes()
        }
    }
}

pub(super) const SYMPLECTIC_EULER: MethodRow = MethodRow {
    id: "symplectic_euler",
    name: "symplectic Euler (kick, drift)",
    coefficients: Coefficients::Composition(Stage::SYMPLECTIC_EULER, DampingTreatment::Explicit),
    energy: Some("[1/(1 + z/2), 1/(1 - z/2)]"),
    source: "de Vogelaere 1956; Hairer, Lubich, Wanner, Geometric Numerical Integration, I.1.2",
    not: "explicit_euler, which drifts with the old velocity; leapfrog without its first half kick \
          is this method",
};

pub(super) const SYMPLECTIC_EULER_DRIFT_FIRST: MethodRow = MethodRow {
    id: "symplectic_euler_drift_first",
    name: "symplectic Euler (drift, kick)",
    coefficients: Coefficients::Composition(
        Stage::SYMPLECTIC_EULER_DRIFT_FIRST,
        DampingTreatment::Explicit,
    ),
    energy: Some("[1/(1 + z/2), 1/(1 - z/2)]"),
    source: "Hairer, Lubich, Wanner, Geometric Numerical Integration, I.1.2",
    not: "explicit_euler, for which it is often taken: it kicks at the position already moved",
};

pub(super) const VELOCITY_VERLET: MethodRow = MethodRow {
    id: "velocity_verlet",
    name: "velocity Verlet",
    coefficients: Coefficients::Composition(Stage::VERLET, DampingTreatment::Sweeps),
    energy: Some("[1 - z²/4, 1]"),
    source: "Swope et al. 1982; Hairer, Lubich, Wanner, Acta Numerica 2003 (Störmer-Verlet)",
    not: "position_verlet (drift, kick, drift), or Verlet with a predicted velocity in the damper",
};

pub(super) const POSITION_VERLET: MethodRow = MethodRow {
    id: "position_verlet",
    name: "position Verlet",
    coefficients: Coefficients::Composition(Stage::POSITION_VERLET, DampingTreatment::Sweeps),
    energy: Some("[1, 1/(1 - z²/4)]"),
    source: "Verlet 1967; Hairer, Lubich, Wanner, Geometric Numerical Integration, I.1.4",
    not: "velocity_verlet, which kicks first and last",
};

pub(super) const YOSHIDA4: MethodRow = MethodRow {
    id: "yoshida4",
    name: "Yoshida / Forest-Ruth",
    coefficients: Coefficients::Composition(Stage::YOSHIDA4, DampingTreatment::Sweeps),
    energy: None,
    source: "Forest & Ruth 1990, Physica D 43; Yoshida 1990, Phys. Lett. A 150",
    not: "Yoshida's sixth- and eighth-order methods",
};

pub(super) const PEFRL: MethodRow = MethodRow {
    id: "pefrl",
    name: "PEFRL",
    coefficients: Coefficients::Composition(Stage::PEFRL, DampingTreatment::ExactFlow),
    energy: None,
    source: "Omelyan, Mryglod, Folk 2002, Comput. Phys. Commun. 146, 188",
    not: "Forest-Ruth (yoshida4): one evaluation more, an error constant far smaller",
};

pub(super) const BORIS: MethodRow = MethodRow {
    id: "boris",
    name: "Boris (drift half, kick, drift half)",
    coefficients: Coefficients::Composition(Stage::POSITION_VERLET, DampingTreatment::Boris),
    energy: Some("[1, 1/(1 - z²/4)]"),
    source: "Boris 1970, Proc. 4th Conf. Numerical Simulation of Plasmas; Birdsall & Langdon, Plasma Physics \
             via Computer Simulation, 4-3; Qin et al. 2013, Phys. Plasmas 20",
    not: "position_verlet, which turns by w h, damps by e^-z, and is the same where no force depends on velocity; \
          Boris with velocities half a step from the positions, whose kick is the same",
};

/// The stepper that all compositions of kicks and drifts share.
#[derive(Debug, Clone)]
pub struct Splitting {
    stages: &'static [Stage],
    damping: DampingTreatment,
    flow: VelocityFlow,
    kept: Kept,
    zero: Vec<f64>,
    /// Scratch: ∫ v over a kick.
    moved: Vec<f64>,
    /// The state at the step's start, kept where a flow in the step may fail.
    saved: Option<State>,
}

/// The last acceleration at rest. A kick at the same time and positions reuses it (first same as last).
#[derive(Debug, Clone, Default)]
struct Kept {
    valid: bool,
    t: f64,
    x: Vec<f64>,
    a: Vec<f64>,
}

impl Splitting {
    /// The coefficients of the drifts sum to 1, and so do those of the kicks.
    pub fn new(stages: &'static [Stage], damping: DampingTreatment) -> Self {
        Self {
            stages,
            damping,
            flow: VelocityFlow::default(),
            kept: Kept::default(),
            zero: Vec::new(),
            moved: Vec::new(),
            saved: None,
        }
    }

    /// v += h a(x, v), and the work; then, if there is a drift, x += drift v.
    fn kick_explicitly(
        &mut self,
        system: &dyn System,
        t: f64,
        h: f64,
        drift: Option<f64>,
        state: &mut State,
    ) {
        fit(&mut self.kept.a, state.x.len());
        let power = system.acceleration(t, &state.x, &state.v, &mut self.kept.a);
        match drift {
            // One pass does both, since memory bandwidth limits them.
            Some(drift) => {
                vector::kick_and_drift(&mut state.x, &mut state.v, &self.kept.a, h, drift);
            }
            None => axpy(&mut state.v, h, &self.kept.a),
        }
        state.work.advance(power, h);
    }

    /// Applies the flow of v' = a(x, v) at frozen x over h, or its midpoint rule, and advances the work.
    fn kick_exactly(
        &mut self,
        system: &dyn System,
        t: f64,
        h: f64,
        state: &mut State,
    ) -> Result<(), StepError> {
        system.place(t, &mut state.x, &mut state.v);
        self.evaluate(system, t, h, state);
        if system.kinds().depends_on_velocity() {
            if self.damping == DampingTreatment::Boris {
                self.push(system, t, 0.5 * h, state);
                self.flow.midpoint(system, t, h, state)?;
                self.push(system, t, 0.5 * h, state);
                return Ok(());
            }
            return self
                .flow
                .advance(system, t, h, &self.kept.a, state, HALVINGS);
        }
        self.push(system, t, h, state);
        Ok(())
    }

    /// Applies the dampers one after the other, and the force at rest; of several dampers at a particle, the `first`
    /// kick of a step sweeps before the force, the `last` one back after it, and any other both ways in its middle.
    /// Boris' kicks have them all in the middle.
    fn kick_by_sweeps(
        &mut self,
        system: &dyn System,
        t: f64,
        h: f64,
        [first, last]: [bool; 2],
        state: &mut State,
    ) {
        system.place(t, &mut state.x, &mut state.v);
        let apart = system.dampers() == Dampers::Apart;
        let midpoint = self.damping == DampingTreatment::Boris;
        if apart && !midpoint {
            self.evaluate(system, t, h, state);
            self.kick_apart(system, t, h, state);
        } else if first && !midpoint {
            self.sweep(system, h, false, state);
            self.evaluate(system, t, h, state);
            self.push(system, t, h, state);
        } else if last && !midpoint {
            self.evaluate(system, t, h, state);
            self.push(system, t, h, state);
            self.sweep(system, h, true, state);
        } else {
            let half = 0.5 * h;
            self.evaluate(system, t, h, state);
            self.push(system, t, half, state);
            if apart {
                self.sweep(system, h, false, state);
            } else {
                self.sweep(system, half, true, state);
                self.sweep(system, half, false, state);
            }
            self.push(system, t, half, state);
        }
    }

    /// Applies the dampers alone, one after the other, over h.
    fn sweep(&self, system: &dyn System, h: f64, backward: bool, state: &mut State) {
        let driven = system.kinds().has(ForceKinds::DRIVEN);
        let before = if driven {
            system.kinetic(&state.v)
        } else {
            0.0
        };
        let mut sweep = Sweep::new(system, &state.x, &mut state.v, h);
        sweep.backward = backward;
        sweep.midpoint = self.damping == DampingTreatment::Boris;
        system.sweep(&mut sweep);
        let dissipated = sweep.dissipated();
        state.work.dissipated += dissipated;
        if driven {
            // Only what is driven gives dampers more than they take from what is free.
            state.work.injected += system.kinetic(&state.v) - before + dissipated;
        }
    }

    /// Evaluates the acceleration where every velocity is 0, also a given one, unless the kept one fits.
    fn evaluate(&mut self, system: &dyn System, t: f64, h: f64, state: &State) {
        let n = state.x.len();
        fit(&mut self.zero, n);
        fit(&mut self.kept.a, n);
        // The kept force is reused only at bitwise equal positions. Times are sums of the same parts in
        // another order, so they may differ in their last bits.
        let last_bits = 1e-9 * h.abs() + 4.0 * f64::EPSILON * t.abs();
        let same_time = (self.kept.t - t).abs() <= last_bits;
        if !(self.kept.valid && same_time && agree(system, &self.kept.x, &state.x)) {
            system.acceleration(t, &state.x, &self.zero, &mut self.kept.a);
            let kinds = system.kinds();
            if kinds.has(ForceKinds::DRIVEN) && kinds.depends_on_velocity() {
                self.leave_out_given(system, t, state);
            }
            self.kept.x.clone_from(&state.x);
            self.kept.t = t;
            self.kept.valid = true;
        }
    }

    /// Takes what moving fixed particles do through dampers out of the acceleration: dampers act on their velocities
    /// when it is their turn.
    fn leave_out_given(&mut self, system: &dyn System, t: f64, state: &State) {
        let given = state.v.iter().zip(system.inverse_mass());
        let given: Vec<f64> = given
            .map(|(v, w)| if *w == 0.0 { *v } else { 0.0 })
            .collect();
        if given.iter().any(|v| *v != 0.0) {
            fit(&mut self.moved, given.len());
            system.damping(t, &state.x, &given, &mut self.moved);
            axpy(&mut self.kept.a, -1.0, &self.moved);
        }
    }

    /// The displacement over h under the acceleration at rest alone.
    fn displace(&mut self, h: f64, state: &State) {
        fit(&mut self.moved, state.v.len());
        for ((moved, v), a) in self.moved.iter_mut().zip(&state.v).zip(&self.kept.a) {
            *moved = h * (v + 0.5 * h * a);
        }
    }

    /// v += h a with the acceleration at rest, and the work of driven forces.
    fn push(&mut self, system: &dyn System, t: f64, h: f64, state: &mut State) {
        if system.kinds().has(ForceKinds::DRIVEN) {
            self.displace(h, state);
            state.work.injected += system.injected(t, &state.x, &self.moved, h).forces;
        }
        axpy(&mut state.v, h, &self.kept.a);
    }

    /// The exact flow of the acceleration at rest and of dampers that share no particle.
    fn kick_apart(&mut self, system: &dyn System, t: f64, h: f64, state: &mut State) {
        let driven = system.kinds().has(ForceKinds::DRIVEN);
        if driven {
            self.displace(h, state);
        }
        let a = &self.kept.a;
        axpy(&mut state.v, h, a);
        let moved = driven.then_some(&mut self.moved[..]);
        let mut sweep = Sweep::new(system, &state.x, &mut state.v, h).with(a, moved);
        system.sweep(&mut sweep);
        state.work.dissipated += sweep.dissipated();
        if driven {
            let work = system.injected(t, &state.x, &self.moved, h);
            state.work.injected += work.forces + work.dampers;
        }
    }
}

impl Integrator for Splitting {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        refuse(self, system)?;
        let whole = match self.damping {
            DampingTreatment::Explicit => false,
            DampingTreatment::ExactFlow => true,
            DampingTreatment::Sweeps | DampingTreatment::Boris => {
                system.dampers() == Dampers::Whole
            }
        };
        if !(whole && system.kinds().depends_on_velocity()) {
            return self.compose(system, h, state);
        }
        // Only the flow of all dampers can fail, after part of the step is done.
        let mut saved = self.saved.take().unwrap_or_else(|| state.clone());
        saved.clone_from(state);
        let done = self.compose(system, h, state);
        if done.is_err() {
            state.clone_from(&saved);
        }
        self.saved = Some(saved);
        done
    }

    fn takes(&self) -> ForceKinds {
        self.damping.takes_in(self.stages)
    }

    fn forget(&mut self) {
        self.kept.valid = false;
    }
}

impl Splitting {
    fn compose(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        let start = state.t;
        let mut drifted = 0.0;
        let mut stages = self.stages;
        let halves = Stage::half_kicks_at_ends(stages);
        let explicit = self.damping == DampingTreatment::Explicit
            || system.kinds().has(ForceKinds::CONSTRAINED);
        while let [stage, rest @ ..] = stages {
            let before = self.stages.len() - stages.len();
            stages = rest;
            match *stage {
                Drift(c) => {
                    axpy(&mut state.x, c * h, &state.v);
                    drifted += c;
                }
                // The time of a kick follows from the drifts so far.
                Kick(c) => {
                    let t = start + drifted * h;
                    if explicit {
                        let mut drift = None;
                        if let [Drift(next), after @ ..] = rest {
                            drift = Some(next * h);
                            drifted += next;
                            stages = after;
                        }
                        self.kick_explicitly(system, t, c * h, drift, state);
                    } else {
                        let ends = [before == 0, rest.is_empty()].map(|end| halves && end);
                        self.kick(system, t, c * h, ends, state)?;
                    }
                }
            }
        }
        state.t = start + h;
        Ok(())
    }

    /// A kick over h at frozen positions by a treatment that is not explicit; `ends` say whether it is the first and
    /// whether the last half kick of a step.
    pub(super) fn kick(
        &mut self,
        system: &dyn System,
        t: f64,
        h: f64,
        ends: [bool; 2],
        state: &mut State,
    ) -> Result<(), StepError> {
        let damped = system.kinds().depends_on_velocity();
        let swept = damped && system.dampers() != Dampers::Whole;
        if swept && self.damping != DampingTreatment::ExactFlow {
            self.kick_by_sweeps(system, t, h, ends, state);
            return Ok(());
        }
        self.kick_exactly(system, t, h, state)
    }
}
