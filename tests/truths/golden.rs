//! Numbers other programs and papers publish, reproduced by the shipped scenes. Each is asserted of a
//! wrong variant too, which has to fail it.

use crate::testkit::scenes::shipped;
use crate::testkit::{advance, method, own};
use springcheck::physics::{ParticleSystem, State, System};
use springcheck::scene::{self, Scene};
use springcheck::solvers::{Solver, rapier::RapierSettings};
use springcheck::truth::Demand;
use springcheck::verbs::run::{Choice, Expectations, Orders, Plan};
use springcheck::verbs::session::Quiet;

const SIXTIETH: f64 = 1.0 / 60.0;

/// rapier at its defaults but for `n` substeps.
fn rapier(n: u32) -> Solver {
    Solver::rapier(RapierSettings {
        iterations: n,
        ..RapierSettings::DEFAULT
    })
}

fn choice(methods: &[&str], engines: &[Solver], timestep: f64) -> Choice {
    Choice {
        solvers: methods
            .iter()
            .map(|id| Solver::method(method(id)))
            .chain(engines.iter().cloned())
            .collect(),
        timesteps: vec![timestep],
        truth: Demand::None,
        order: Orders::WhereCheap,
        identify: true,
        prove: true,
        expectations: Expectations::Ignored,
    }
}

/// Runs the only case of a plan to its end and shows every step, counted from 1, to `see`.
fn run(plan: &Plan, mut see: impl FnMut(u64, &State)) {
    let case = &plan.cases[0];
    let mut run = case.start(plan).expect("a supported scene");
    for step in 1..=case.label.steps {
        run.advance(1).expect("a step");
        see(step, run.state());
    }
}

/// Published with so many decimals, and so known to half a unit of the last one.
fn rounds_to(value: f64, published: f64, decimals: i32) -> bool {
    (value - published).abs() <= 0.500_001 * 10_f64.powi(-decimals)
}

/// E/E0 at the end, as the report has it.
fn energy_left(scene: &Scene, choice: &Choice) -> Vec<f64> {
    let report = Plan::new(scene, choice).execute(&Quiet).expect("a run");
    let left = |o: &springcheck::verbs::run::Outcome| {
        let energy = o.energy.as_ref().expect("it ran");
        energy.final_j.expect("finite") / energy.initial_j.expect("finite")
    };
    report.outcomes().iter().map(left).collect()
}

/// An undamped spring of rapier's loses energy as implicit Euler does: (1 + h² k/m)^-(120 n) in 120
/// steps of n substeps.
#[test]
fn energy_left_in_rapiers_undamped_spring() {
    let scene = shipped("golden/spring_energy.yml");
    let substeps = [1, 4, 8];
    let left = |scene: &Scene, more: u32| {
        let engines: Vec<_> = substeps.map(|n| rapier(n + more)).to_vec();
        energy_left(scene, &choice(&["implicit_euler"], &engines, SIXTIETH))
    };
    let measured = left(&scene, 0);
    let published = [0.037_333, 0.434_912, 0.659_300];
    for ((n, published), measured) in substeps.into_iter().zip(published).zip(&measured[1..]) {
        assert!(rounds_to(*measured, published, 6), "n = {n}: {measured}");
        let h = SIXTIETH / f64::from(n);
        let law = (1.0 + h * h * 20.0 / 0.2).powi(-120 * n as i32);
        // A few roundings of the energy in each of 120 n substeps: 4 eps each.
        let rounding = 4.0 * f64::EPSILON * 120.0 * f64::from(n);
        assert!((measured / law - 1.0).abs() < rounding, "n = {n}");
    }
    assert!(rounds_to(measured[0], published[0], 6), "{measured:?}");

    // One substep more, one step fewer, a spring stiffer by a thousandth.
    let mut shorter = scene.clone();
    shorter.duration -= SIXTIETH;
    let mut stiffer = scene.clone();
    stiffer.springs[0].stiffness *= 1.001;
    for wrong in [left(&scene, 1), left(&shorter, 0), left(&stiffer, 0)] {
        for (wrong, published) in wrong[1..].iter().zip(published) {
            assert!(!rounds_to(*wrong, published, 6), "{wrong}");
        }
    }
}

/// Largest distance of the oscillator from A cos(w t) over the run, and what is left of its energy.
fn oscillator(scene: &Scene, choice: &Choice) -> (f64, f64) {
    let plan = Plan::new(scene, choice);
    let case = plan.cases.first().expect("a case");
    let (mut worst, mut last) = (0.0_f64, 0.0);
    run(&plan, |step, state| {
        let t = step as f64 * case.label.timestep;
        worst = worst.max((state.x[3] - 0.5 * (50_f64.sqrt() * t).cos()).abs());
        last = plan.system.kinetic(&state.v) + plan.system.potential(t, &state.x);
    });
    (worst, last / (0.5 * 50.0 * 0.5 * 0.5))
}

/// The classic oscillator, k = 50, m = 1, displaced by 0.5 for 5 s, under rapier's defaults.
#[test]
fn the_classic_oscillator_under_rapiers_defaults() {
    let scene = shipped("oscillator/oscillator.yml");
    for (dt, error, decimals, left) in [(SIXTIETH, 2.0e-1, 2, 0.353), (1e-3, 1.5e-2, 3, 0.939)] {
        let right = |scene: &Scene, choice: &Choice| {
            let (worst, ratio) = oscillator(scene, choice);
            // Published to two and three digits.
            rounds_to(worst, error, decimals) && rounds_to(ratio, left, 3)
        };
        assert!(right(&scene, &choice(&[], &[rapier(4)], dt)));
        // Other substeps, symplectic Euler, a spring stiffer by a hundredth.
        assert!(!right(&scene, &choice(&[], &[rapier(5)], dt)));
        assert!(!right(&scene, &choice(&["symplectic_euler"], &[], dt)));
        let mut stiffer = scene.clone();
        stiffer.springs[0].stiffness *= 1.01;
        assert!(!right(&stiffer, &choice(&[], &[rapier(4)], dt)));
    }
}

/// End of the Pleiades at t = 3 (Mazzia & Magherini, Test Set for IVP Solvers 2.4, problem PLEI).
const PLEIADES: [[f64; 2]; 7] = [
    [0.370_613_914_397_050_2, -3.943_437_585_517_392],
    [3.237_284_092_057_233, -3.271_380_973_972_55],
    [-3.222_559_032_418_324, 5.225_081_843_456_543],
    [0.659_709_145_577_531, -2.590_612_434_977_47],
    [0.342_558_170_715_658_4, 1.198_213_693_392_275],
    [1.562_172_101_400_631, -0.242_968_234_493_582_4],
    [-0.700_309_292_221_249_5, 1.091_449_240_428_98],
];

/// Largest distance of a star from where it should be at the end.
fn pleiades_error(scene: &Scene, id: &str, timestep: f64) -> f64 {
    let plan = Plan::new(scene, &choice(&[id], &[], timestep));
    let mut end = Vec::new();
    run(&plan, |_, state| end.clone_from(&state.x));
    let distance = |(star, truth): (&[f64], &[f64; 2])| {
        (star[0] - truth[0])
            .hypot(star[1] - truth[1])
            .hypot(star[2])
    };
    let stars = end.chunks_exact(3).zip(&PLEIADES);
    stars.map(distance).fold(0.0, f64::max)
}

#[test]
fn the_pleiades_end_where_published() {
    let scene = shipped("hard/pleiades.yml");
    for (id, other, error, decimals) in [
        ("rk4", "pefrl", 2.630e-6, 9),
        ("velocity_verlet", "implicit_midpoint", 3.606e-3, 6),
    ] {
        let right = |id| rounds_to(pleiades_error(&scene, id, 1e-4), error, decimals);
        assert!(right(id) && !right(other), "{id}");
    }
    // The published end is the scene's own: PEFRL, 5.0e-7 away at the scene's step, comes 5^4 times
    // closer in steps a fifth of it. A mass that is off by a millionth does not.
    let coarse = pleiades_error(&scene, "pefrl", 1e-4);
    let closes_in = |scene: &Scene| pleiades_error(scene, "pefrl", 2e-5) < coarse / 500.0;
    assert!(closes_in(&scene), "{coarse:e}");
    let mut heavier = scene.clone();
    heavier.particles[0].mass *= 1.0 + 1e-6;
    assert!(!closes_in(&heavier));
}

/// One mass 10 m out on a spring of 2 Hz and a tenth of the critical damping, at 60 steps a second:
/// the soft constraint of Jolt Physics after 1, 30 and 60 steps. Catto's recurrence (GDC 2011) is
/// implicit Euler, and so is rapier's joint at one substep.
#[test]
fn the_spring_test_of_soft_constraints() {
    let scene = shipped("golden/spring_test.yml");
    let right = |scene: &Scene, choice: &Choice| {
        let plan = Plan::new(scene, choice);
        let published = [(1, 9.595_995_44), (30, 2.755_314_27), (60, 0.709_733_29)];
        let mut matches = 0;
        run(&plan, |step, state| {
            let here = published.iter().find(|(at, _)| *at == step);
            matches += usize::from(here.is_some_and(|(_, x)| rounds_to(state.x[3], *x, 8)));
        });
        matches
    };
    for id in [
        "implicit_euler",
        "linearized_implicit_predicted",
        "linearized_implicit_at_start",
    ] {
        assert_eq!(right(&scene, &choice(&[id], &[], SIXTIETH)), 3, "{id}");
    }
    assert_eq!(right(&scene, &choice(&[], &[rapier(1)], SIXTIETH)), 3);
    // Another method, rapier's usual substeps, the damping a thousandth off.
    assert_eq!(right(&scene, &choice(&["trapezoidal"], &[], SIXTIETH)), 0);
    assert_eq!(right(&scene, &choice(&[], &[rapier(4)], SIXTIETH)), 0);
    let mut other = scene.clone();
    other.springs[0].damping *= 1.001;
    let damped = choice(&["implicit_euler"], &[], SIXTIETH);
    assert_eq!(right(&other, &damped), 0);
}

/// Frequency of the stiff springs of the chain, 1/s.
const W: f64 = 50.0;

/// The chain of alternating soft and stiff springs of Hairer, Lubich, Wanner, Geometric Numerical
/// Integration, I.5 and XIII.2, m = 3, with its quartic springs `soft` times and the frequency of its
/// stiff ones `fast` times the book's.
fn chain(soft: f64, fast: f64) -> ParticleSystem {
    let mut scene = shipped("hard/fput.yml");
    for spring in &mut scene.springs {
        spring.cubic *= soft;
        spring.stiffness *= fast * fast;
    }
    ParticleSystem::new(&scene)
}

/// The shipped scene's start, which is the book's: the first pair's mean at 1 with speed 1, its
/// elongation at 1/w with speed 1, each in coordinates (q2 ± q1) / sqrt(2).
fn chain_start() -> State {
    let start = ParticleSystem::initial_state(&shipped("hard/fput.yml"));
    let pair = |mean: f64, elongation: f64| {
        let r = 0.5_f64.sqrt();
        [r * (mean - elongation), r * (mean + elongation)]
    };
    for (found, book, origin) in [
        (&start.x, pair(1.0, 1.0 / W), 20.0),
        (&start.v, pair(1.0, 1.0), 0.0),
    ] {
        for (i, values) in found.chunks_exact(3).enumerate() {
            let displaced = match i {
                1 | 2 => book[i - 1],
                _ => 0.0,
            };
            let off = values[0] - origin * i as f64 - displaced;
            // Half a last bit of 40 is 3.6e-15.
            assert!(
                off.abs() < 4e-15 && values[1..] == [0.0, 0.0],
                "{i}: {off:e}"
            );
        }
    }
    start
}

/// Largest |H - H0| up to t = 200, and the step after which it first passed 1e5, if it did. Stops
/// there.
fn chain_energy(system: &dyn System, id: &str, h: f64) -> (f64, Option<u64>) {
    let mut state = chain_start();
    let energy = |s: &State| system.kinetic(&s.v) + system.potential(0.0, &s.x);
    let start = energy(&state);
    let mut integrator = own(method(id))();
    let mut worst = 0.0_f64;
    for step in 1..=scene::steps(200.0, h) {
        advance(integrator.as_mut(), system, h, 1, &mut state);
        let off = (energy(&state) - start).abs();
        worst = worst.max(off);
        if off.is_nan() || off > 1e5 {
            return (worst, Some(step));
        }
    }
    (worst, None)
}

#[test]
fn verlet_on_a_stiff_chain() {
    let system = chain(1.0, 1.0);
    let start = chain_start();
    let energy = system.kinetic(&start.v) + system.potential(0.0, &start.x);
    assert!(rounds_to(energy, 2.001_200_08, 8), "{energy}");
    assert!(!rounds_to(
        chain(1.01, 1.0).potential(0.0, &start.x),
        energy - 1.0,
        8
    ));

    let verlet = |h| chain_energy(&system, "velocity_verlet", h);
    for (h, published, decimals) in [(1e-3, 3.14e-4, 6), (0.03, 0.646, 3)] {
        let right = |system: &dyn System, id: &str| {
            let (worst, blown_up) = chain_energy(system, id, h);
            blown_up.is_none() && rounds_to(worst, published, decimals)
        };
        assert!(right(&system, "velocity_verlet"), "h = {h}");
        assert!(!right(&system, "implicit_midpoint"), "h = {h}");
        assert!(!right(&chain(1.0, 1.01), "velocity_verlet"), "h = {h}");
    }
    // Stable on the stiff springs alone, 2/w = 0.04; the quartic ones tighten the limit. The error
    // passes 1e5 after 129 steps.
    assert_eq!(verlet(0.0399).1, Some(129));
    assert!(verlet(0.041).1.is_some_and(|step| step < 129));
    // Without the quartic springs the same steps hold, and beyond the limit nothing does.
    let linear = chain(0.0, 1.0);
    let alone = |h| chain_energy(&linear, "velocity_verlet", h).1;
    assert_eq!((alone(0.0399), alone(0.041).is_some()), (None, true));
}
