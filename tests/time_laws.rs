//! Forces that depend on time are met at the stages' own times, and what an integrator keeps from one
//! step is used in the next only where it fits.

mod common;
use common::mutants::{self, Step, mutant};
use common::{Build, advance, built, method, own, swinging_triangle};
use springcheck::integrators::{Integrator, Method, REGISTRY, StepError};
use springcheck::scene::DampingModel;
use springcheck::system::{Counting, Jacobian, Linearization, Power, State, System};

const W: f64 = 3.0;
const DRIVE: f64 = 5.0;

/// x'' = -w² x + cos(W t).
struct Driven;

impl System for Driven {
    fn dim(&self) -> usize {
        1
    }
    fn inverse_mass(&self) -> &[f64] {
        &[1.0]
    }
    fn acceleration(&self, t: f64, x: &[f64], _: &[f64], a: &mut [f64]) -> Power {
        a[0] = -W * W * x[0] + (DRIVE * t).cos();
        Power::default()
    }
    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        0.5 * W * W * x[0] * x[0] - x[0] * (DRIVE * t).cos()
    }
    fn jacobian(&self, _: f64, _: &[f64], _: &[f64], _: Linearization, out: &mut Jacobian) {
        out.position.push((0, 0, -W * W));
    }
}

/// Position and velocity from (0.5, 0.3) at t = 0, in closed form.
fn exact(t: f64) -> [f64; 2] {
    let amplitude = 1.0 / (W * W - DRIVE * DRIVE);
    let (a, b) = (0.5 - amplitude, 0.3 / W);
    let ((sin, cos), (drive_sin, drive_cos)) = ((W * t).sin_cos(), (DRIVE * t).sin_cos());
    [
        a * cos + b * sin + amplitude * drive_cos,
        W * (b * cos - a * sin) - DRIVE * amplitude * drive_sin,
    ]
}

/// The observed order at t = 1 between two steps, halved.
fn order_law(row: &Method, build: Build) -> Result<(), String> {
    let error = |steps: usize| {
        let mut state = State::new(vec![0.5], vec![0.3]);
        advance(
            build().as_mut(),
            &Driven,
            1.0 / steps as f64,
            steps,
            &mut state,
        );
        let [x, v] = exact(1.0);
        (state.x[0] - x).abs().max((state.v[0] - v).abs())
    };
    let steps = if row.order > 2 { 100 } else { 3200 };
    let observed = (error(steps) / error(2 * steps)).log2();
    // The next term changes the ratio by O(h): measured 0.015.
    if observed.is_nan() || (observed - f64::from(row.order)).abs() > 0.03 {
        return Err(format!("{}: order {observed:.4} of {}", row.id, row.order));
    }
    Ok(())
}

/// First order does not see a stage's time: one step against the formula that names it.
fn first_step_law(id: &str, build: Build) -> Result<(), String> {
    let (t, h, x, v) = (0.4_f64, 0.1_f64, 0.5_f64, 0.3_f64);
    let push = |t: f64| (DRIVE * t).cos();
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
        // Linear in x, so that one Newton step is the whole solution.
        "implicit_euler" | "linearized_implicit" | "linearized_implicit_material" => {
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
fn every_method_has_its_order_under_a_force_that_depends_on_time() {
    for row in REGISTRY {
        order_law(row, &own(row)).unwrap();
        if row.order == 1 {
            first_step_law(row.id, &own(row)).unwrap();
        }
    }
}

#[test]
fn the_laws_of_time_kill_mutants() {
    for row in REGISTRY {
        if row.order > 1 {
            assert!(
                order_law(row, &untimely(row.id, true)).is_err(),
                "{}",
                row.id
            );
        } else {
            let late = untimely(row.id, false);
            assert!(first_step_law(row.id, &late).is_err(), "{}", row.id);
            // Only a method that never looks past the start survives a stopped clock.
            let survives = ["explicit_euler", "symplectic_euler"].contains(&row.id);
            let law = first_step_law(row.id, &untimely(row.id, true));
            assert_eq!(law.is_ok(), survives, "{}", row.id);
        }
    }
    let euler: Step = mutants::euler_drifting_with_the_new_velocity;
    assert!(first_step_law("explicit_euler", &mutant(euler)).is_err());
}

/// Handed another state at the same time, or the same place at another time, an integrator that has
/// run does what a fresh one does, to the last bit.
fn handing_law(row: &Method, build: Build) -> Result<(), String> {
    const H: f64 = 0.05;
    let start = State::new(vec![0.5], vec![0.3]);
    let mut first = start.clone();
    let mut used = build();
    advance(used.as_mut(), &Driven, H, 1, &mut first);
    let mut other_place = first.clone();
    other_place.x[0] += 0.25;
    let mut other_time = first.clone();
    other_time.t += 1.0;
    for (what, state) in [
        ("the start once more", start),
        ("another place", other_place),
        ("another time", other_time),
    ] {
        let mut used = build();
        advance(
            used.as_mut(),
            &Driven,
            H,
            1,
            &mut State::new(vec![0.5], vec![0.3]),
        );
        let (mut by_used, mut by_fresh) = (state.clone(), state);
        advance(used.as_mut(), &Driven, H, 1, &mut by_used);
        advance(build().as_mut(), &Driven, H, 1, &mut by_fresh);
        if by_used != by_fresh {
            return Err(format!(
                "{}: {what}: {by_used:?}, fresh {by_fresh:?}",
                row.id
            ));
        }
    }
    Ok(())
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
fn what_an_integrator_kept_is_used_only_where_it_fits() {
    for row in REGISTRY {
        handing_law(row, &own(row)).unwrap();
    }
    for by_place in [false, true] {
        let build = || -> Box<dyn Integrator> {
            Box::new(Trusting {
                by_place,
                kept: None,
            })
        };
        assert!(handing_law(method("velocity_verlet"), &build).is_err());
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
