//! Forces that depend on time are met at the stages' own times, and what an integrator keeps from one
//! step is used in the next only where it fits. The kit's laws `order-driven` and `reuse` hold for every
//! method in `conformance`; here are their mutants, and what the kit cannot say of all.

use crate::testkit::mutants::{self, Step, mutant};
use crate::testkit::{Build, advance, built, method, own, swinging_triangle};
use springcheck::conformance::systems::Driven;
use springcheck::conformance::{self, Claims};
use springcheck::integrators::{Integrator, Method, StepError, fixed};
use springcheck::measure::CheckStatus;
use springcheck::physics::{Counting, ForceKinds, Jacobian, Linearization, Power, State, System};
use springcheck::scene::DampingModel;

const W: f64 = Driven::W;

/// A law of the public kit, for what `build` makes.
fn law(id: &str, row: &Method, build: Build) -> CheckStatus {
    let law = conformance::find(id).expect(id);
    law.check(build, &Claims::from(row)).status
}

/// First order does not see a stage's time: one step against the formula that names it.
fn first_step_law(id: &str, build: Build) -> Result<(), String> {
    let (t, h, x, v) = (0.4_f64, 0.1_f64, 0.5_f64, 0.3_f64);
    let push = |t: f64| (Driven::DRIVE * t).cos();
    let (x1, v1) = match id {
        "explicit_euler" => (x + h * v, v + h * (-W * W * x + push(t))),
        "symplectic_euler" => {
            let v1 = v + h * (-W * W * x + push(t));
            (x + h * v1, v1)
        }
        "symplectic_euler_drift_first" => {
            let x1 = x + h * v;
            (x1, v + h * (-W * W * x1 + push(t + h)))
        }
        // The force is that at the start; linear in x, so that its Jacobian is the whole change.
        "linearized_implicit_at_start" | "linearized_implicit_material" => {
            let v1 = (v + h * (-W * W * x + push(t))) / (1.0 + h * h * W * W);
            (x + h * v1, v1)
        }
        // One Newton step is the whole solution.
        "implicit_euler" | "linearized_implicit_predicted" => {
            let v1 = (v + h * (-W * W * x + push(t + h))) / (1.0 + h * h * W * W);
            (x + h * v1, v1)
        }
        _ => return Err(format!("{id}: no formula")),
    };
    let mut state = State::new(vec![x], vec![v]);
    state.t = t;
    advance(build().as_mut(), &Driven, h, 1, &mut state);
    // A few operations on values below 1: measured one half of eps.
    let off = (state.x[0] - x1).abs().max((state.v[0] - v1).abs());
    if off < 3e-16 {
        Ok(())
    } else {
        Err(format!("{id}: off by {off:.1e}"))
    }
}

/// A system whose clock is off by a constant.
struct Shifted<'a>(&'a dyn System, Clock);

/// What the forces see of the time.
#[derive(Clone, Copy)]
enum Clock {
    Stopped(f64),
    Late(f64),
}

impl Shifted<'_> {
    fn time(&self, t: f64) -> f64 {
        match self.1 {
            Clock::Stopped(at) => at,
            Clock::Late(by) => t - by,
        }
    }
}

impl System for Shifted<'_> {
    fn dim(&self) -> usize {
        self.0.dim()
    }
    fn inverse_mass(&self) -> &[f64] {
        self.0.inverse_mass()
    }
    fn kinds(&self) -> ForceKinds {
        self.0.kinds()
    }
    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        self.0.acceleration(self.time(t), x, v, a)
    }
    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.0.potential(self.time(t), x)
    }
    fn jacobian(&self, t: f64, x: &[f64], v: &[f64], kept: Linearization, out: &mut Jacobian) {
        self.0.jacobian(self.time(t), x, v, kept, out);
    }
}

/// A method whose stages all take the time of the step's start, or of a step too early.
struct Untimely {
    inner: Box<dyn Integrator>,
    stopped: bool,
}

impl Integrator for Untimely {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        let clock = if self.stopped {
            Clock::Stopped(state.t)
        } else {
            Clock::Late(h)
        };
        self.inner.step(&Shifted(system, clock), h, state)
    }
}

fn untimely(id: &str, stopped: bool) -> impl Fn() -> Box<dyn Integrator> {
    let build = own(method(id));
    move || {
        let inner = build();
        Box::new(Untimely { inner, stopped })
    }
}

#[test]
fn every_method_of_first_order_meets_the_forces_of_its_own_time() {
    for row in fixed().iter().filter(|row| row.order == 1) {
        first_step_law(row.id, &own(row)).unwrap();
    }
}

#[test]
fn the_laws_of_time_kill_mutants() {
    for row in fixed().iter() {
        if row.order > 1 {
            let stopped = law("order-driven", row, &untimely(row.id, true));
            assert_eq!(stopped, CheckStatus::Fail, "{}", row.id);
        } else {
            let late = untimely(row.id, false);
            assert!(first_step_law(row.id, &late).is_err(), "{}", row.id);
            // Only a method that never looks past the start survives a stopped clock.
            let survives = [
                "explicit_euler",
                "symplectic_euler",
                "linearized_implicit_at_start",
                "linearized_implicit_material",
            ]
            .contains(&row.id);
            let stopped = first_step_law(row.id, &untimely(row.id, true));
            assert_eq!(stopped.is_ok(), survives, "{}", row.id);
        }
    }
    let euler: Step = mutants::euler_drifting_with_the_new_velocity;
    assert!(first_step_law("explicit_euler", &mutant(euler)).is_err());
}

/// Verlet that keeps its last force, and looks at one thing only before it uses it again.
#[derive(Default)]
struct Trusting {
    by_place: bool,
    kept: Option<(f64, Vec<f64>, Vec<f64>)>,
}

impl Integrator for Trusting {
    fn step(&mut self, system: &dyn System, h: f64, s: &mut State) -> Result<(), StepError> {
        let force = |t: f64, s: &State| {
            let mut a = vec![0.0; s.x.len()];
            system.acceleration(t, &s.x, &s.v, &mut a);
            a
        };
        let kept = self.kept.take().filter(
            |(t, x, _)| {
                if self.by_place { *x == s.x } else { *t == s.t }
            },
        );
        let a = kept.map_or_else(|| force(s.t, s), |(_, _, a)| a);
        for i in 0..a.len() {
            s.v[i] += 0.5 * h * a[i];
            s.x[i] += h * s.v[i];
        }
        s.t += h;
        let a = force(s.t, s);
        for i in 0..a.len() {
            s.v[i] += 0.5 * h * a[i];
        }
        self.kept = Some((s.t, s.x.clone(), a));
        Ok(())
    }
}

#[test]
fn the_law_of_reuse_kills_mutants() {
    let verlet = method("velocity_verlet");
    for by_place in [false, true] {
        let build = || -> Box<dyn Integrator> {
            Box::new(Trusting {
                by_place,
                kept: None,
            })
        };
        assert_eq!(law("reuse", verlet, &build), CheckStatus::Fail);
    }
}

/// One evaluation a step and the first one's, however late it is and by whatever sum the caller arrives
/// at the time: at 1e4 s the last bit of a time is 1.8e-12 s, more than 1e-9 of this step.
fn late_cost_law(build: Build) -> Result<(), String> {
    const STEPS: u64 = 10_000;
    const H: f64 = 1e-3;
    let (system, mut state) = built(&swinging_triangle(0.0, DampingModel::Axial));
    let system = Counting::new(system);
    let mut integrator = build();
    for step in 0..STEPS {
        state.t = 1e4 + step as f64 * H;
        advance(integrator.as_mut(), &system, H, 1, &mut state);
    }
    let found = system.evaluations().forces;
    if found == STEPS + 1 {
        Ok(())
    } else {
        Err(format!("{found} evaluations in {STEPS} steps"))
    }
}

#[test]
fn verlet_keeps_its_force_at_late_times_too() {
    late_cost_law(&own(method("velocity_verlet"))).unwrap();
    // One that compares times bit by bit keeps it only sometimes.
    assert!(late_cost_law(&|| Box::new(Trusting::default())).is_err());
}
