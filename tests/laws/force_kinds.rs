//! Forces say how they depend on velocity, and a method is either right for them, to its order, or
//! refuses them by name.

use crate::testkit::{Random, everything, force, method, pressed, sample};
use nalgebra::{DMatrix, DVector};
use springcheck::integrators::adaptive::Adaptive;
use springcheck::integrators::{Method, Settings, StepError, fixed, pairs};
use springcheck::physics::effects::{self, Effect, EffectRow};
use springcheck::physics::{ForceKinds, Jacobian, Linearization, ParticleSystem};
use springcheck::physics::{Power, State, System};
use springcheck::scene::{self, DampingModel};
use springcheck::solvers::Solver;
use springcheck::solvers::Status;
use springcheck::verbs;
use springcheck::verbs::run::{Choice, Plan};
use springcheck::verbs::session::Quiet;

/// f = q B v x e_z on every particle, with this q B, kg/s.
struct Magnetic(f64, ForceKinds);

impl Effect for Magnetic {
    fn members(&self) -> usize {
        1
    }
    fn kinds(&self) -> ForceKinds {
        self.1
    }
    fn add_force(&self, _: f64, x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        self.add_damping(x, v, f);
        Power::default()
    }
    fn add_damping(&self, _: &[f64], w: &[f64], f: &mut [f64]) {
        for at in (0..w.len()).step_by(3) {
            f[at] += self.0 * w[at + 1];
            f[at + 1] -= self.0 * w[at];
        }
    }
    fn add_jacobian(&self, _: f64, x: &[f64], _: &[f64], _: Linearization, out: &mut Jacobian) {
        for at in (0..x.len()).step_by(3) {
            out.velocity.push((at, at + 1, self.0));
            out.velocity.push((at + 1, at, -self.0));
        }
    }
}

/// f = -c |v| v on every coordinate.
struct QuadraticDrag(f64, ForceKinds);

impl Effect for QuadraticDrag {
    fn members(&self) -> usize {
        1
    }
    fn kinds(&self) -> ForceKinds {
        self.1
    }
    fn add_force(&self, _: f64, _: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        for (f, v) in f.iter_mut().zip(v) {
            *f -= self.0 * v.abs() * v;
        }
        Power {
            dissipated: v.iter().map(|v| self.0 * v.abs() * v * v).sum(),
            injected: 0.0,
        }
    }
    fn add_jacobian(&self, _: f64, _: &[f64], v: &[f64], _: Linearization, out: &mut Jacobian) {
        let slopes = v.iter().enumerate();
        let slopes = slopes.map(|(at, v)| (at, at, -2.0 * self.0 * v.abs()));
        out.velocity.extend(slopes);
    }
}

/// The registry's row of this effect.
fn row(id: &str) -> &'static EffectRow {
    let mut rows = effects::REGISTRY.iter();
    rows.find(|row| row.id == id).expect("a row")
}

/// D is exact but for roundings of forces of order 10.
const ROUNDING: f64 = 1e-13;

/// How the force depends on velocity at one state.
fn found(effect: &dyn Effect, x: &[f64], v: &[f64]) -> ForceKinds {
    let n = x.len();
    let at_rest = DVector::from_vec(force(effect, x, &vec![0.0; n]).0);
    let moving = |v: &[f64]| DVector::from_vec(force(effect, x, v).0) - &at_rest;
    let columns: Vec<_> = (0..n)
        .map(|at| moving(DMatrix::<f64>::identity(n, n).column(at).as_slice()))
        .collect();
    let d = DMatrix::from_columns(&columns);
    let small = ROUNDING * (1.0 + at_rest.amax() + d.amax());
    if (&d * DVector::from_column_slice(v) - moving(v)).amax() > small * n as f64 {
        return ForceKinds::NON_LINEAR;
    }
    let (symmetric, skew) = (&d + d.transpose(), &d - d.transpose());
    let rates = symmetric.symmetric_eigenvalues();
    let mut kinds = ForceKinds::NONE;
    for (there, kind) in [
        (rates.min() < -small, ForceKinds::DISSIPATIVE),
        (rates.max() > small, ForceKinds::NEGATIVE_DAMPING),
        (skew.amax() > small, ForceKinds::GYROSCOPIC),
    ] {
        if there {
            kinds = kinds | kind;
        }
    }
    kinds
}

/// An effect says of its velocity what differences say, and no more.
fn declaration_law(effect: &dyn Effect) -> Result<(), String> {
    let scene = pressed(DampingModel::Axial);
    let said = effect.kinds().without(ForceKinds::DRIVEN);
    let mut random = Random(11);
    for _ in 0..5 {
        let (x, v) = sample(&scene, &mut random);
        let found = found(effect, &x, &v);
        if found != said {
            return Err(format!("says it is '{said}' and is '{found}'"));
        }
    }
    Ok(())
}

#[test]
fn every_effect_says_how_it_depends_on_velocity() {
    for model in [DampingModel::Axial, DampingModel::Isotropic] {
        for sign in [1.0, -1.0] {
            let mut scene = pressed(model);
            for particle in &mut scene.particles {
                particle.drag *= sign;
            }
            for spring in &mut scene.springs {
                spring.damping *= sign;
            }
            for row in effects::REGISTRY {
                let effect = (row.build)(&scene).expect(row.id);
                declaration_law(effect.as_ref()).unwrap_or_else(|e| panic!("{}: {e}", row.id));
                let turned = effects::Scaled::new(effect, -1.0);
                declaration_law(&turned).unwrap_or_else(|e| panic!("-{}: {e}", row.id));
            }
        }
    }
    declaration_law(&Magnetic(2.0, ForceKinds::GYROSCOPIC)).unwrap();
    declaration_law(&QuadraticDrag(2.0, ForceKinds::NON_LINEAR)).unwrap();
}

#[test]
fn a_wrong_declaration_is_seen() {
    let (dissipative, negative) = (ForceKinds::DISSIPATIVE, ForceKinds::NEGATIVE_DAMPING);
    for said in [ForceKinds::NONE, dissipative, ForceKinds::NON_LINEAR] {
        assert!(declaration_law(&Magnetic(2.0, said)).is_err(), "{said}");
    }
    for said in [ForceKinds::NONE, dissipative, negative] {
        assert!(
            declaration_law(&QuadraticDrag(2.0, said)).is_err(),
            "{said}"
        );
    }
    // What says it of another effect: drag of the wrong sign, drag that says it is none.
    struct Says(Box<dyn Effect>, ForceKinds);
    impl Effect for Says {
        fn members(&self) -> usize {
            self.0.members()
        }
        fn kinds(&self) -> ForceKinds {
            self.1
        }
        fn add_force(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
            self.0.add_force(t, x, v, f)
        }
    }
    let mut scene = everything(DampingModel::Axial);
    let built = |scene: &_, id| (row(id).build)(scene).expect(id);
    for id in ["springs", "drag"] {
        let none = Says(built(&scene, id), ForceKinds::NONE);
        assert!(declaration_law(&none).is_err(), "{id}");
    }
    scene.particles[1].drag = -0.3;
    assert_eq!(built(&scene, "drag").kinds(), dissipative | negative);
    for said in [dissipative, negative] {
        let half = Says(built(&scene, "drag"), said);
        assert!(declaration_law(&half).is_err(), "{said}");
    }
}

/// rad/s: q B / m, and the rate of decay.
const RATE: f64 = 1.5;
/// kg.
const MASS: f64 = 0.5;
/// s: half a turn.
const END: f64 = 2.0;

static OWN: EffectRow = EffectRow {
    id: "of_velocity",
    summary: "",
    source: "",
    elastic: false,
    constant: false,
    build: |_| None,
};

fn alone(effect: impl Effect + 'static) -> ParticleSystem {
    ParticleSystem::of(vec![1.0 / MASS; 3], vec![(&OWN, Box::new(effect))])
}

/// A particle under one force of velocity that starts with 1 m/s along x, and where it is at the end.
struct Problem {
    system: ParticleSystem,
    end: [f64; 3],
}

/// It goes in a circle.
fn charged(said: ForceKinds) -> Problem {
    let (sin, cos) = (RATE * END).sin_cos();
    Problem {
        system: alone(Magnetic(MASS * RATE, said)),
        end: [sin / RATE, (cos - 1.0) / RATE, 0.0],
    }
}

/// x = ln(1 + r t) / r.
fn dragged(said: ForceKinds) -> Problem {
    Problem {
        system: alone(QuadraticDrag(MASS * RATE, said)),
        end: [(1.0 + RATE * END).ln() / RATE, 0.0, 0.0],
    }
}

/// Drag of the wrong sign: x = (exp(r t) - 1) / r.
fn driven_on() -> Problem {
    let mut scene = everything(DampingModel::Axial);
    scene.particles.truncate(1);
    scene.particles[0].fixed = false;
    scene.particles[0].drag = -MASS * RATE;
    Problem {
        system: alone(effects::Drag::new(&scene).expect("drag")),
        end: [(RATE * END).exp_m1() / RATE, 0.0, 0.0],
    }
}

fn error(problem: &Problem, method: &Method, steps: u32) -> Result<f64, StepError> {
    let mut state = State::new(vec![0.0; 3], vec![1.0, 0.0, 0.0]);
    let mut integrator = method.build(&Settings::default());
    for _ in 0..steps {
        integrator.step(&problem.system, END / f64::from(steps), &mut state)?;
    }
    Ok(crate::testkit::distance(&state.x, &problem.end))
}

/// Right to its order, or refused; says which.
fn right_or_refused(problem: &Problem, method: &Method) -> Result<bool, String> {
    let [coarse, fine] = [40, 80].map(|steps| error(problem, method, steps));
    let (coarse, fine) = match (coarse, fine) {
        (Ok(coarse), Ok(fine)) => (coarse, fine),
        (Err(StepError::Refused(_)), Err(StepError::Refused(_))) => return Ok(false),
        other => return Err(format!("{}: {other:?}", method.id)),
    };
    // The next order adds up to z = 1.5 / 20 of the error; measured within 0.09 of the order. Exact
    // flows of drag leave rounding.
    let order = (coarse / fine).log2();
    if order > f64::from(method.order_damped) - 0.2 || coarse < 1e-12 {
        Ok(true)
    } else {
        Err(format!("{}: {coarse:e} {fine:e}, order {order}", method.id))
    }
}

#[test]
fn a_method_is_right_to_its_order_or_refuses() {
    let both = [
        (charged(ForceKinds::GYROSCOPIC), ForceKinds::GYROSCOPIC),
        (dragged(ForceKinds::NON_LINEAR), ForceKinds::NON_LINEAR),
        (driven_on(), ForceKinds::NEGATIVE_DAMPING),
    ];
    for (problem, kind) in both {
        for method in fixed().iter() {
            let taken = right_or_refused(&problem, method).unwrap();
            assert_eq!(taken, method.takes().has(kind), "{}: {kind}", method.id);
            // Whoever asks beforehand hears the same, with names.
            let admitted = problem.system.admits(method.id, method.takes());
            assert_eq!(taken, admitted.is_ok(), "{}", method.id);
        }
    }
    let explicit = [
        "explicit_euler",
        "rk4",
        "symplectic_euler",
        "linearized_implicit_predicted",
        "linearized_implicit_at_start",
    ];
    for id in explicit {
        // Rods apart: implicit methods refuse them.
        let takes = method(id).takes() | ForceKinds::CONSTRAINED;
        assert_eq!(takes, ForceKinds::ANY, "{id}");
    }
    for id in ["velocity_verlet", "boris", "implicit_midpoint", "tr_bdf2"] {
        assert!(method(id).takes().has(ForceKinds::GYROSCOPIC), "{id}");
        assert!(!method(id).takes().has(ForceKinds::NON_LINEAR), "{id}");
    }
}

#[test]
fn what_a_refusal_prevents() {
    // The exact flow believes a magnetic force that says it dissipates: kicks of 1.5 turn the velocity,
    // and may not change its size.
    let believed = charged(ForceKinds::DISSIPATIVE);
    for (id, h) in [("velocity_verlet", 2.0), ("position_verlet", 1.0)] {
        let mut state = State::new(vec![0.0; 3], vec![1.0, 0.0, 0.0]);
        let mut integrator = method(id).build(&Settings::default());
        integrator.step(&believed.system, h, &mut state).unwrap();
        let speed = state.v[0].hypot(state.v[1]);
        assert!((speed - 1.0).abs() > 0.5, "{id}: {speed}");
    }
    let believed = dragged(ForceKinds::DISSIPATIVE);
    assert!(right_or_refused(&believed, method("velocity_verlet")).is_err());
}

#[test]
fn pairs_take_any_force() {
    for problem in [
        charged(ForceKinds::GYROSCOPIC),
        dragged(ForceKinds::NON_LINEAR),
    ] {
        for method in pairs() {
            let pair = method.pair().expect("a pair");
            let mut state = State::new(vec![0.0; 3], vec![1.0, 0.0, 0.0]);
            let mut stepper = Adaptive::new(pair, 1e-10, 1.0);
            while state.t < END {
                stepper.step(&problem.system, END, &mut state).unwrap();
            }
            // Some twenty steps of 1e-10 each.
            let off = crate::testkit::distance(&state.x, &problem.end);
            assert!(off < 2e-9, "{}: {off:e}", method.id);
        }
    }
}

/// A system of somebody's own who says nothing of velocity.
struct Undeclared(ParticleSystem);

impl System for Undeclared {
    fn dim(&self) -> usize {
        self.0.dim()
    }
    fn inverse_mass(&self) -> &[f64] {
        self.0.inverse_mass()
    }
    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        self.0.acceleration(t, x, v, a)
    }
    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.0.potential(t, x)
    }
}

#[test]
fn who_says_nothing_is_taken_only_where_nothing_is_asked() {
    let system = Undeclared(charged(ForceKinds::GYROSCOPIC).system);
    for method in fixed().iter() {
        let mut state = State::new(vec![0.0; 3], vec![1.0, 0.0, 0.0]);
        let before = state.clone();
        let stepped = method
            .build(&Settings::default())
            .step(&system, 0.01, &mut state);
        let taken = (method.takes() | ForceKinds::CONSTRAINED) == ForceKinds::ANY;
        assert_eq!(stepped.is_ok(), taken, "{}", method.id);
        assert!(taken || state == before, "a refusal moves nothing");
    }
}

#[test]
fn a_run_shows_who_refused_what_and_why() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/oscillator/circle.yml");
    let scene = scene::read(path.as_ref(), verbs::names()).expect("a scene");
    let mut choice = Choice::default_for(&scene);
    let build = |id| move || method(id).build(&Settings::default());
    choice.solvers = vec![
        Solver::own("mine", build("velocity_verlet")),
        Solver::own("theirs", build("rk4")),
    ];
    let mut plan = Plan::new(&scene, &choice);
    let quadratic = QuadraticDrag(0.1, ForceKinds::NON_LINEAR);
    plan.system = ParticleSystem::of(
        plan.system.inverse_mass().to_vec(),
        vec![(&OWN, Box::new(quadratic))],
    );
    let report = plan.execute(&Quiet).expect("nothing is saved");
    let outcome = |name: &str| {
        let mut outcomes = report.outcomes().iter();
        outcomes.find(|o| o.engine == name).expect(name).clone()
    };
    assert_eq!(outcome("theirs").status, Status::Completed);
    let mine = outcome("mine");
    assert_eq!(mine.status, Status::Unsupported);
    assert_eq!(
        mine.reason.as_deref(),
        Some(
            "no force that is non-linear in the velocity (of_velocity) is taken: how velocity is treated \
             needs forces linear in it, as dampers, drag and magnetic fields are; explicit Runge-Kutta \
             methods (rk4), adaptive pairs and symplectic_euler take any"
        )
    );
}
