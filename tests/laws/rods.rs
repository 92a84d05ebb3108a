//! Rods: lengths kept to rounding or drifting as published numbers say, orders, energies, tensions, and truths.

use crate::testkit::method;
use crate::testkit::scenes::{empty, fixed, free, parsed};
use springcheck::integrators::{self, Method, Settings, StepError};
use springcheck::measure::Statics;
use springcheck::measure::rest::{self, modes_of};
use springcheck::physics::constraints::{RodError, stabilise};
use springcheck::physics::{ForceKinds, ParticleSystem, State, System};
use springcheck::scene::{Constraints, Driven, Particle, Rod, Scene, Stabilisation};
use springcheck::solvers::advance;
use springcheck::truth::{self, Demand, NoStore};

fn rod(a: usize, b: usize, scene: &Scene) -> Rod {
    let [p, q] = [a, b].map(|id| scene.particles[id].position);
    let length = (0..3).map(|c| (q[c] - p[c]).powi(2)).sum::<f64>().sqrt();
    Rod {
        ends: [a, b],
        length,
    }
}

/// Particles in a row, each held by a rod to the one before, under gravity.
fn row(particles: Vec<Particle>, stabilisation: Stabilisation) -> Scene {
    let mut scene = Scene {
        constraints: Some(Constraints {
            stabilisation,
            ..Constraints::default()
        }),
        particles,
        ..empty()
    };
    scene.solver.gravity = -9.81;
    scene.rods = (1..scene.particles.len())
        .map(|id| rod(id - 1, id, &scene))
        .collect();
    scene
}

/// The spherical pendulum of golden 15.
fn spherical(stabilisation: Stabilisation) -> Scene {
    let sixty = std::f64::consts::FRAC_PI_3;
    let bob = Particle {
        velocity: [0.0, 2.0, 0.0],
        ..free([sixty.sin(), 0.0, -0.5], 1.0)
    };
    let mut scene = row(vec![fixed([0.0; 3]), bob], stabilisation);
    scene.rods[0].length = 1.0;
    scene
}

/// Its state at 10 s, agreed on to 3e-31 by two methods of extended precision.
const AT_TEN: [f64; 3] = [
    0.045_782_563_398_461_01,
    -0.737_748_604_470_662_2,
    -0.673_521_308_861_313_2,
];

/// The double pendulum of golden 14: two rods of 1 m, level, at rest.
fn double(stabilisation: Stabilisation) -> Scene {
    let [one, two] = [1.0, 2.0].map(|x| free([x, 0.0, 0.0], 1.0));
    row(vec![fixed([0.0; 3]), one, two], stabilisation)
}

fn run(id: &str, scene: &Scene, h: f64, steps: u32) -> State {
    stepped(id, scene, h, steps, |_| {}).expect("it can be stepped")
}

fn stepped(
    id: &str,
    scene: &Scene,
    h: f64,
    steps: u32,
    mut see: impl FnMut(&State),
) -> Result<State, StepError> {
    let system = ParticleSystem::new(scene);
    let mut state = ParticleSystem::initial_state(scene);
    let mut integrator = method(id).build(&Settings::default());
    for n in 1..=steps {
        advance(
            integrator.as_mut(),
            &system,
            h,
            f64::from(n) * h,
            &mut state,
        )?;
        see(&state);
    }
    Ok(state)
}

fn off(state: &State, particle: usize, wanted: &[f64]) -> f64 {
    let at = &state.x[3 * particle..];
    wanted
        .iter()
        .zip(at)
        .map(|(a, b)| (a - b).powi(2))
        .sum::<f64>()
        .sqrt()
}

#[test]
fn rattle_has_the_errors_that_were_computed_apart() {
    let scene = spherical(Stabilisation::Project);
    let system = ParticleSystem::new(&scene);
    let rods = system.rods().expect("a rod");
    for (h, steps, error) in [
        (0.02, 500, 1.125_110_205_9e-2),
        (0.01, 1000, 2.802_445_166_2e-3),
        (0.005, 2000, 6.999_655_088_1e-4),
        (0.0025, 4000, 1.749_510_139_9e-4),
    ] {
        let mut length: f64 = 0.0;
        let end = stepped("rattle", &scene, h, steps, |state| {
            length = length.max(rods.residual(&state.x, &state.v).position);
        });
        let found = off(&end.expect("it ends"), 1, &AT_TEN);
        // Rounding, amplified by the motion: 1e-13 measured against numbers of eleven digits.
        assert!((found - error).abs() < 1e-11, "{h}: {found:e}");
        // Two last bits of a length of 1.
        assert!(length <= 4.5e-16, "{h}: {length:e}");
    }
}

#[test]
fn without_stabilisation_lengths_drift_as_published() {
    let scene = spherical(Stabilisation::None);
    for (id, drift) in [("rk4", -5.235_642e-6), ("symplectic_euler", -3.892_893e-2)] {
        let end = run(id, &scene, 0.01, 1000);
        let length = off(&end, 1, &[0.0; 3]);
        // Seven digits are given.
        let error = (length - 1.0 - drift) / drift;
        assert!(error.abs() < 2e-7, "{id}: {:e}", length - 1.0);
    }
}

/// Angles from straight down and their rates.
fn angles(state: &State) -> [f64; 4] {
    let one = |at: usize, from: usize| {
        let of = |y: &[f64]| [0, 2].map(|c| y[3 * at + c] - y[3 * from + c]);
        let ([x, z], [vx, vz]) = (of(&state.x), of(&state.v));
        [x.atan2(-z), (x * vz - z * vx) / (x * x + z * z)]
    };
    let ([a, p], [b, q]) = (one(1, 0), one(2, 1));
    [a, b, p, q]
}

#[test]
fn the_double_pendulum_is_where_it_was_computed_apart() {
    let golden = [
        (
            1.0,
            [
                -0.625_087_699_806_390_7,
                -1.034_585_085_680_012_3,
                -3.922_279_572_887_976_7,
                -1.303_099_248_696_331,
            ],
        ),
        (
            2.0,
            [
                -0.482_971_534_251_754_4,
                -1.324_048_712_302_362_5,
                3.065_288_192_073_401_4,
                2.949_271_547_571_619,
            ],
        ),
        (
            5.0,
            [
                -0.627_186_705_066_530_7,
                -1.301_315_550_209_811_7,
                2.125_408_673_842_910_5,
                3.881_888_727_265_607_3,
            ],
        ),
    ];
    let scene = double(Stabilisation::Project);
    let system = ParticleSystem::new(&scene);
    let truth = truth::find(&scene, &system, Demand::Auto, 5.0, &NoStore);
    for (t, wanted) in golden {
        let states = truth.motion().expect("a truth").states(&[t]);
        let state = State::new(states.x(0).to_vec(), states.v(0).to_vec());
        for (found, wanted) in angles(&state).iter().zip(wanted) {
            // The truth's bar grows to 1e-11 m in 5 s of this motion.
            assert!((found - wanted).abs() < 1e-10, "{t}: {found:.15} {wanted}");
        }
        // Steps of 1 ms of a method of order 4.
        let state = run("rk4", &scene, 1e-3, (1000.0 * t) as u32);
        let rk4 = (angles(&state)[0] - wanted[0]).abs();
        assert!(rk4 < 3e-8, "{t}: {rk4:e}");
    }
}

/// The methods of fixed steps that take rods, but for SHAKE, whose velocities are off them.
fn methods() -> impl Iterator<Item = &'static str> {
    let takes = |method: &&Method| method.takes().has(ForceKinds::CONSTRAINED);
    let methods = integrators::fixed().iter().filter(takes);
    methods.map(|method| method.id).filter(|id| *id != "shake")
}

/// A body of three unequal masses and three rods, which turns and falls, and on which drag does not act.
fn body() -> Scene {
    let at = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.3, 0.8, 0.2]];
    // Turning about an axis through the origin: no velocity along any rod.
    let (turn, fall) = ([0.5, -1.0, 2.0], [0.3, 0.1, 0.0]);
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [0, 1, 2].map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            a[j] * b[k] - a[k] * b[j]
        })
    };
    let particle = |(at, mass): ([f64; 3], f64)| {
        let turned = cross(turn, at);
        Particle {
            velocity: [0, 1, 2].map(|i| turned[i] + fall[i]),
            ..free(at, mass)
        }
    };
    let mut scene = row(
        at.into_iter().zip([1.0, 2.0, 0.5]).map(particle).collect(),
        Stabilisation::Project,
    );
    scene.solver.gravity = 0.0;
    let closing = rod(0, 2, &scene);
    scene.rods.push(closing);
    scene
}

/// Momentum and angular momentum.
fn momenta(scene: &Scene, state: &State) -> [f64; 6] {
    let mut sum = [0.0; 6];
    for (id, particle) in scene.particles.iter().enumerate() {
        let of = |y: &[f64]| [y[3 * id], y[3 * id + 1], y[3 * id + 2]];
        let (x, v) = (of(&state.x), of(&state.v));
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            sum[i] += particle.mass * v[i];
            sum[3 + i] += particle.mass * (x[j] * v[k] - x[k] * v[j]);
        }
    }
    sum
}

/// Forces along rods are equal and opposite, and projection weighs by 1/m: no method changes the momentum. Equal moves of
/// both ends, whatever they weigh, would.
#[test]
fn rods_change_no_momentum() {
    let scene = body();
    let start = momenta(&scene, &ParticleSystem::initial_state(&scene));
    for id in methods() {
        let end = momenta(&scene, &run(id, &scene, 0.01, 200));
        for (end, start) in end.iter().zip(start).take(3) {
            // 200 steps of some 30 roundings of numbers up to 7.
            assert!((end - start).abs() < 2e-13, "{id}: {end} {start}");
        }
    }
    // Rattle keeps the angular momentum too.
    let end = momenta(&scene, &run("rattle", &scene, 0.01, 200));
    for (end, start) in end.iter().zip(start) {
        assert!((end - start).abs() < 2e-13, "{end} {start}");
    }
}

/// Whatever the method, lengths are kept to rounding where states are moved onto the rods, and nothing moves along them.
#[test]
fn projection_keeps_lengths_and_velocities_to_rounding() {
    for scene in [
        spherical(Stabilisation::Project),
        double(Stabilisation::Project),
        body(),
    ] {
        let system = ParticleSystem::new(&scene);
        let rods = system.rods().expect("rods");
        for id in methods() {
            let end = stepped(id, &scene, 0.01, 200, |state| {
                let off = rods.residual(&state.x, &state.v);
                // Two roundings of coordinates up to 2 or so; of velocities up to 10, a few more.
                assert!(off.position <= 1.8e-15, "{id}: {:e}", off.position);
                assert!(off.velocity <= 2e-14, "{id}: {:e}", off.velocity);
            });
            end.expect("it ends");
        }
    }
}

/// A small error of a length obeys g'' + 2 rate g' + rate² g = 0 under Baumgarte's forces: δ (1 + rate t) e^(-rate t) from
/// rest.
#[test]
fn baumgarte_takes_an_error_out_as_a_damped_oscillator() {
    let mut scene = row(
        vec![fixed([0.0; 3]), free([0.0, 0.0, -1.0], 1.0)],
        Stabilisation::Baumgarte,
    );
    let rate = 7.0;
    if let Some(constraints) = &mut scene.constraints {
        constraints.rate = rate;
    }
    let system = ParticleSystem::new(&scene);
    let mut state = ParticleSystem::initial_state(&scene);
    state.x[5] -= 1e-8;
    let mut integrator = method("rk4").build(&Settings::default());
    for n in 1..=500 {
        let t = f64::from(n) * 1e-3;
        advance(integrator.as_mut(), &system, 1e-3, t, &mut state).expect("a step");
        let wanted = 1e-8 * (1.0 + rate * t) * (-rate * t).exp();
        // Each step rounds a distance of 1 by 1e-16: a random walk of up to 500 of them.
        assert!(
            (-state.x[5] - 1.0 - wanted).abs() < 3e-15,
            "{t}: {:e}",
            -state.x[5] - 1.0
        );
    }
}

/// A pendulum released level pulls with 3 m g sin(angle below level): at level nothing, at the bottom three times its
/// weight; a conical one with m g / cos. The fixed end is held by as much.
#[test]
fn tensions_and_reactions_are_those_of_the_textbook() {
    let weight = 2.0 * 9.81;
    for (below, length) in [
        (0.0_f64, 1.0),
        (0.4, 0.7),
        (std::f64::consts::FRAC_PI_2, 1.3),
    ] {
        let speed = (2.0 * 9.81 * length * below.sin()).sqrt();
        let bob = Particle {
            velocity: [-speed * below.sin(), 0.0, -speed * below.cos()],
            ..free([length * below.cos(), 0.0, -length * below.sin()], 2.0)
        };
        let scene = row(vec![fixed([0.0; 3]), bob], Stabilisation::Project);
        let state = ParticleSystem::initial_state(&scene);
        let statics = Statics::new(&scene);
        let wanted = 3.0 * weight * below.sin();
        let tension = statics.rod_tensions(&state)[0];
        // Some ten roundings of 60 N.
        assert!(
            (tension - wanted).abs() < 3e-14,
            "{below}: {tension} {wanted}"
        );
        let reaction = statics.reactions(&state);
        for (axis, along) in [(0, -below.cos()), (2, below.sin())] {
            let held = wanted * along;
            assert!(
                (reaction[axis] - held).abs() < 3e-14,
                "{below}: {reaction:?}"
            );
        }
    }
}

/// What is driven up and down at its pivot gets its energy from the drive, at the order of the method; lengths stay.
#[test]
fn the_work_of_a_driven_end_closes_the_balance() {
    let mut scene = row(
        vec![fixed([0.0; 3]), free([0.8, 0.0, -0.6], 0.5)],
        Stabilisation::Project,
    );
    scene.driven = vec![Driven {
        particle: 0,
        sine: Some(springcheck::scene::Sine {
            amplitude: [0.1, 0.05, 0.2],
            omega: 5.0,
            phase: 0.0,
        }),
        ..Driven::default()
    }];
    // The end sets out along the rod, so the bob goes along with it.
    scene.particles[1].velocity = [0.5, 0.25, 1.0];
    let system = ParticleSystem::new(&scene);
    let energy = |state: &State| system.kinetic(&state.v) + system.potential(state.t, &state.x);
    let start = energy(&ParticleSystem::initial_state(&scene));
    for (id, order) in [
        ("velocity_verlet", 2.0),
        ("rattle", 2.0),
        ("rk3", 3.0),
        ("rk4", 4.0),
    ] {
        let off = |h: f64| {
            let end = run(id, &scene, h, (2.0 / h).round() as u32);
            energy(&end) - end.work.injected - start
        };
        let errors = [off(0.01), off(0.005)];
        let observed = (errors[0] / errors[1]).abs().log2();
        assert!(observed > order - 0.25, "{id}: {observed} {errors:?}");
    }
}

/// Projection books the energy that it puts in.
#[test]
fn what_projection_puts_in_is_booked() {
    let scene = double(Stabilisation::Project);
    let system = ParticleSystem::new(&scene);
    let rods = system.rods().expect("rods");
    let mut state = ParticleSystem::initial_state(&scene);
    state.x[5] -= 1e-3;
    state.v[6] += 0.25;
    let energy = |state: &State| system.kinetic(&state.v) + system.potential(0.0, &state.x);
    let before = energy(&state);
    stabilise(&system, rods, &mut state).expect("near the rods");
    let gained = energy(&state) - before;
    // Half of the velocity along the rod goes into the other particle's: some of it is lost.
    assert!(gained < -1e-3, "{gained}");
    assert!((state.work.projected - gained).abs() < 1e-15);
}

/// Two rods are drawn straight between a fixed end and one that leaves: then their tensions are not determined.
#[test]
fn a_chain_that_is_drawn_straight_fails_by_name() {
    let mut scene = row(
        vec![
            fixed([0.0; 3]),
            free([0.3, 0.0, -0.4], 1.0),
            fixed([0.6, 0.0, 0.0]),
        ],
        Stabilisation::Project,
    );
    scene.driven = vec![Driven {
        particle: 2,
        table: Some(springcheck::scene::Table(vec![
            [0.0, 0.0, 0.0, 0.0],
            [1.0, 0.1, 0.0, 0.0],
            [4.0, 2.0, 0.0, 0.0],
        ])),
        ..Driven::default()
    }];
    let drive = scene.drives()[0].at(0.0)[1][0];
    // Along both rods as the end goes.
    scene.particles[1].velocity = [0.5 * drive, 0.0, 0.375 * drive];
    for id in methods() {
        let ended = stepped(id, &scene, 0.01, 400, |_| {});
        assert!(matches!(ended, Err(StepError::Rods(_))), "{id}: {ended:?}");
    }
    // Where it is straight it says so.
    let system = ParticleSystem::new(&scene);
    let straight = [0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0];
    let tensions = system.rod_tensions(0.0, &straight, &[0.0; 9]);
    assert_eq!(tensions, Err(RodError::Dependent { rod: 1 }));
}

/// Masses are no directions: a heavy end is called heavy, and not a chain that is drawn straight.
#[test]
fn masses_too_far_apart_are_named() {
    let [light, even, heavy] = [1e-9, 1.0, 1e6];
    for (masses, told) in [
        (vec![even, 1e10], None),
        (vec![even, 1e14], Some(1e14)),
        (vec![even, 1e18], Some(1e18)),
        (vec![light, heavy, light], Some(1e15)),
    ] {
        let bobs = masses.iter().enumerate();
        let bobs = bobs.map(|(at, mass)| free([at as f64 + 1.0, 0.0, 0.0], *mass));
        let particles = std::iter::once(fixed([0.0; 3])).chain(bobs).collect();
        let scene = row(particles, Stabilisation::Project);
        let system = ParticleSystem::new(&scene);
        let start = ParticleSystem::initial_state(&scene);
        match (system.rod_tensions(0.0, &start.x, &start.v), told) {
            // Level and at rest: nothing pulls along the rods.
            (Ok(tensions), None) => assert!(tensions.iter().all(|t| *t == 0.0), "{tensions:?}"),
            (Err(RodError::Masses { ratio, .. }), Some(told)) => {
                assert!((ratio / told - 1.0).abs() < 1e-12, "{ratio:e}");
            }
            (found, _) => panic!("{masses:?}: {found:?}"),
        }
    }
}

/// A polygon of n rods, equal weights at its corners, between ends 1 m apart: golden numbers of the catenary.
#[test]
fn rods_hang_in_the_polygon_of_the_catenary() {
    for (links, sag, pull) in [
        (2, 0.559_016_994_374_947_5, 0.447_213_595_499_957_9),
        (4, 0.524_319_613_242_246_4, 0.819_816_480_465_195_6),
        (10, 0.505_945_931_571_084_5, 2.051_051_014_309_119_4),
        (20, 0.503_446_634_340_192_7, 4.107_878_988_926_029),
    ] {
        let n = f64::from(links);
        // An arc of a circle with chords of 1.5/n.
        let chord = |half: f64| (half / n).sin() / half.sin();
        let (mut low, mut high) = (0.5, 3.0);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            let longer = chord(middle) * n > 1.5;
            let (wide, narrow) = if longer {
                (low, middle)
            } else {
                (middle, high)
            };
            (low, high) = (wide, narrow);
        }
        let half = low;
        let radius = 0.5 / half.sin();
        let at = |k: u32| {
            let angle = half * (2.0 * f64::from(k) / n - 1.0);
            [
                radius * angle.sin(),
                0.0,
                radius * (half.cos() - angle.cos()),
            ]
        };
        let mut particles: Vec<Particle> = (0..=links).map(|k| free(at(k), 1.0)).collect();
        particles[0].fixed = true;
        particles[links as usize].fixed = true;
        let mut scene = row(particles, Stabilisation::Project);
        for rod in &mut scene.rods {
            rod.length = 1.5 / n;
        }
        let found = rest::find(&scene).expect("a rest");
        let lowest = found
            .x
            .iter()
            .skip(2)
            .step_by(3)
            .fold(0.0, |least: f64, z| least.min(*z));
        let reactions =
            Statics::new(&scene).reactions(&State::new(found.x.clone(), vec![0.0; found.x.len()]));
        assert!((-lowest - sag).abs() < 3e-13, "{links}: {}", -lowest);
        let held = -reactions[0] / 9.81;
        assert!((held - pull).abs() < 3e-11 * pull, "{links}: {held}");
    }
}

/// A hair of rods and hinges under a load at its tip, exactly: golden numbers of the discrete elastica.
#[test]
fn a_hair_of_rods_is_the_discrete_elastica() {
    for (links, wanted) in [
        (8, 0.303_931_679_124),
        (16, 0.302_273_620_254),
        (32, 0.301_858_992_697),
        (64, 0.301_755_328_976),
    ] {
        let scene = parsed(&format!(
            "solver: {{type: rk4, timestep: 0.001, gravity: -1}}\n\
             particles: [{{pos: [1, 0, -10], mass: 1}}]\n\
             objects: [hair: {{from: [0, 0, 0], to: [1, 0, 0], particles: {}, mass: 1e-12, \
             structural: rods, bending: {{stiffness: {links}}}, clamp: [1, 0, 0]}}]\n\
             springs: [{{particle_ids: [0, \"hair[{links}]\"], stiffness: 1e3}}]\n",
            links + 1
        ));
        let found = rest::find(&scene).expect("a rest");
        let drop = -found.x[3 * (links + 1) + 2];
        // Twelve digits are given; what stands for rods turns roundings of positions into 1e-11 N.
        assert!((drop - wanted).abs() < 3e-11, "{links}: {drop:.14}");
    }
}

/// A chain of n equal weights on rods swings at the roots of Laguerre's polynomial of degree n, in units of g/l.
#[test]
fn a_hanging_chain_swings_at_the_roots_of_laguerres_polynomial() {
    for roots in [
        &[1.0][..],
        &[0.585_786_437_626_905, 3.414_213_562_373_095],
        &[
            0.415_774_556_783_479_1,
            2.294_280_360_279_042,
            6.289_945_082_937_479,
        ],
    ] {
        let mut particles = vec![fixed([0.0; 3])];
        particles.extend((1..=roots.len()).map(|k| free([0.0, 0.0, -0.5 * k as f64], 0.3)));
        let scene = row(particles, Stabilisation::Project);
        let found = rest::find(&scene).expect("it hangs");
        let modes = modes_of(&scene, &found.x).expect("modes");
        // Two directions aside, and none along the rods.
        assert_eq!(modes.lowest.len(), 2 * roots.len());
        for (pair, root) in modes.lowest.chunks(2).zip(roots) {
            for mode in pair {
                let found = mode.stiffness * 0.5 / 9.81;
                // Rods stretch by 1e-7 there.
                assert!((found - root).abs() < 1e-6 * root, "{found} {root}");
            }
        }
    }
}
