//! Impacts, resting and sliding, against closed forms.

use crate::testkit::method;
use crate::testkit::scenes::{empty, fixed, free, parsed, spring};
use springcheck::integrators::{self, Method, Settings};
use springcheck::physics::{ForceKinds, ParticleSystem, State, System};
use springcheck::scene::{Particle, Scene};
use springcheck::solvers::{self, Setting, advance};
use springcheck::truth::{self, Demand, NoStore};

pub const G: f64 = 9.81;

/// One particle of 1 kg without extent, and these obstacles as a file has them.
fn lone(particle: &str, colliders: &str, gravity: f64) -> Scene {
    parsed(&format!(
        "solver: {{type: rk4, timestep: 0.01, gravity: {gravity}}}\n\
         duration: 10\n\
         particles: [{{mass: 1, radius: 0, {particle}}}]\n\
         colliders: [{colliders}]\n"
    ))
}

pub fn run(id: &str, scene: &Scene, h: f64, steps: u32) -> State {
    see(id, scene, h, steps, |_| {})
}

pub fn see(id: &str, scene: &Scene, h: f64, steps: u32, mut see: impl FnMut(&State)) -> State {
    let system = ParticleSystem::new(scene);
    let mut state = ParticleSystem::initial_state(scene);
    let mut integrator = method(id).build(&Settings::default());
    for n in 1..=steps {
        let end = f64::from(n) * h;
        state.t = f64::from(n - 1) * h;
        advance(integrator.as_mut(), &system, h, end, &mut state).expect("a step");
        see(&state);
    }
    state
}

/// The methods of fixed steps, of at least this order, that take the forces of a scene.
pub fn of_order(order: u32, scene: &Scene) -> impl Iterator<Item = &'static Method> {
    let kinds = ParticleSystem::new(scene).kinds();
    let takes = move |m: &&Method| kinds.without(m.takes()) == ForceKinds::NONE;
    integrators::fixed()
        .iter()
        .filter(takes)
        .filter(move |m| m.order >= order)
}

pub fn near(found: f64, right: f64, bound: f64, what: &str) {
    assert!(
        (found - right).abs() <= bound,
        "{what}: {found:e}, not {right:e}"
    );
}

pub fn balance(scene: &Scene, state: &State) -> f64 {
    let system = ParticleSystem::new(scene);
    let energy = system.kinetic(&state.v) + system.potential(state.t, &state.x);
    state.work.balance(energy)
}

#[test]
fn a_ball_bounces_as_the_parabolas_do() {
    let scene = lone(
        "pos: [0, 0, 1]",
        "{plane: {normal: [0, 0, 1]}, restitution: 0.8}",
        -G,
    );
    // Each impact is located to 1e-14 s: at 4.4 m/s that is 4e-14 m, and a dozen roundings beside it.
    for method in of_order(2, &scene) {
        let at = |steps| run(method.id, &scene, 0.01, steps);
        let (one, two) = (at(100), at(200));
        near(one.x[2], 0.468_004_452_526_036_3, 1e-12, method.id);
        near(one.v[2], -1.836_995_547_473_964, 1e-12, method.id);
        near(two.x[2], 0.260_741_728_327_057_2, 1e-12, method.id);
        near(two.v[2], -0.165_869_135_836_471_4, 1e-12, method.id);
        near(balance(&scene, &two), G, 1e-12, method.id);
    }
}

#[test]
fn bounces_that_accumulate_end_in_contact_at_the_right_time() {
    let scene = lone(
        "pos: [0, 0, 1]",
        "{plane: {normal: [0, 0, 1]}, restitution: 0.5}",
        -G,
    );
    // t1 (1 + e)/(1 - e) with t1 = sqrt(2/g).
    let stops = (2.0 / G).sqrt() * 3.0;
    let h = stops / 100.0;
    for method in of_order(2, &scene) {
        let mut last_moving = 0.0;
        let end = see(method.id, &scene, h, 110, |state| {
            if state.v[2] != 0.0 {
                last_moving = state.t;
            }
        });
        // What rises by less than 1e-13 m is at rest: by then less than 1e-6 s are left.
        assert!(
            (98.5 * h..=100.5 * h).contains(&last_moving),
            "{}: {last_moving}",
            method.id
        );
        assert_eq!(end.v[2], 0.0, "{}", method.id);
        near(end.x[2], 0.0, 1e-12, method.id);
        near(end.work.impacts, G, 1e-11, method.id);
    }
}

/// With drag c v² the motion between impacts is no parabola: each method has its order.
#[test]
fn impacts_keep_the_order_of_a_method() {
    let scene = lone(
        "pos: [0, 0, 1], quadratic_drag: 0.05",
        "{plane: {normal: [0, 0, 1]}, restitution: 0.8}",
        -G,
    );
    let right = [0.180_537_74, -0.925_337_05];
    let off = |id, steps: u32| {
        let end = run(id, &scene, 2.0 / f64::from(steps), steps);
        (end.x[2] - right[0]).abs().max((end.v[2] - right[1]).abs())
    };
    // The numbers have eight digits.
    assert!(off("rk4", 800) <= 1e-8);
    for method in of_order(1, &scene).filter(|m| m.order <= 3) {
        let halved = off(method.id, 400) / off(method.id, 800);
        let order = halved.log2();
        let wanted = f64::from(method.order);
        // Impacts fall anywhere in a step, which scatters the constant of the error.
        assert!(
            (order - wanted).abs() < 0.35,
            "{}: order {order}",
            method.id
        );
    }
}

#[test]
fn an_oblique_impact_is_newtons_and_coulombs() {
    for (friction, right) in [(0.2, [1.8, 0.0, 2.0]), (1.0, [0.0, 0.0, 2.0])] {
        let wall =
            format!("{{plane: {{normal: [0, 0, 1]}}, restitution: 0.5, friction: {friction}}}");
        let scene = lone("pos: [0, 0, 0.5], vel: [3, 0, -4]", &wall, 0.0);
        for method in integrators::fixed() {
            let end = run(method.id, &scene, 0.01, 20);
            for (v, right) in end.v.iter().zip(right) {
                near(*v, right, 1e-14, method.id);
            }
            near(balance(&scene, &end), 12.5, 1e-13, method.id);
        }
    }
}

#[test]
fn a_moving_wall_gives_its_velocity_on() {
    let wall = "{plane: {normal: [1, 0, 0]}, restitution: 0.8, driven: {velocity: [1, 0, 0]}}";
    let scene = lone("pos: [2, 0, 0], vel: [-5, 0, 0]", wall, 0.0);
    for method in integrators::fixed() {
        let end = run(method.id, &scene, 0.01, 50);
        // -e v + (1 + e) w, and the wall's work is its impulse times w.
        near(end.v[0], 5.8, 1e-14, method.id);
        near(end.work.injected, 10.8, 1e-13, method.id);
        near(balance(&scene, &end), 12.5, 1e-13, method.id);
    }
}

/// A plane of 30 degrees that rises along x.
const INCLINE: &str = "plane: {normal: [-0.5, 0, 0.8660254037844386]}";

#[test]
fn on_an_incline_it_sticks_below_the_angle_of_friction_and_slides_above() {
    // tan 30° = .57735.
    for (friction, way) in [(0.2, 1.602_929_078_887_465_7), (0.577_36, 0.0)] {
        let scene = lone(
            "pos: [0, 0, 0]",
            &format!("{{{INCLINE}, friction: {friction}}}"),
            -G,
        );
        for method in of_order(2, &scene) {
            let end = run(method.id, &scene, 0.01, 100);
            near(end.x[0].hypot(end.x[2]), way, 1e-12, method.id);
            near(balance(&scene, &end), 0.0, 1e-12, method.id);
        }
    }
    // A static friction of its own holds what sliding friction would not.
    let held = format!("{{{INCLINE}, friction: 0.2, static_friction: 0.6}}");
    let end = run("rk4", &lone("pos: [0, 0, 0]", &held, -G), 0.01, 100);
    assert_eq!(end.x, [0.0; 3]);
}

#[test]
fn up_an_incline_it_turns_and_comes_back_slower() {
    let along = [0.866_025_403_784_438_6, 0.0, 0.5].map(|c| 3.0 * c);
    let scene = lone(
        &format!("pos: [0, 0, 0], vel: [{:?}, 0, {:?}]", along[0], along[2]),
        &format!("{{{INCLINE}, friction: 0.2}}"),
        -G,
    );
    let back = 0.454_260_382_600_934_5 + 0.651_989_958_274_038;
    for method in of_order(2, &scene) {
        let end = run(method.id, &scene, back / 100.0, 100);
        near(end.x[0].hypot(end.x[2]), 0.0, 1e-12, method.id);
        near(
            end.v[0].hypot(end.v[2]),
            2.090_187_326_520_162,
            1e-12,
            method.id,
        );
    }
}

#[test]
fn what_slides_stops_where_friction_has_its_energy() {
    let scene = lone(
        "pos: [0, 0, 0], vel: [1.2, 1.6, 0]",
        "{plane: {normal: [0, 0, 1]}, friction: 0.5}",
        -G,
    );
    for method in of_order(2, &scene) {
        let end = run(method.id, &scene, 1e-3, 1000);
        near(
            end.x[0].hypot(end.x[1]),
            0.407_747_196_738_022_4,
            1e-12,
            method.id,
        );
        assert_eq!(end.v, [0.0; 3], "{}", method.id);
        near(end.work.friction, 2.0, 1e-12, method.id);
    }
}

/// A mass on a spring and on a rough floor: golden 8.
fn coulomb() -> Scene {
    let mut scene = parsed(
        "solver: {type: rk4, timestep: 0.001}\n\
         duration: 7\n\
         particles: [{pos: [0, 0, 0], fixed: true}, {pos: [1, 0, 0], mass: 1, radius: 0}]\n\
         springs: [{particle_ids: [0, 1], stiffness: 50, rest_length: 0}]\n\
         colliders: [{plane: {normal: [0, 0, 1]}, friction: 0.2}]\n",
    );
    scene.name = "Coulomb's oscillator".into();
    scene
}

#[test]
fn coulombs_oscillator_loses_as_much_in_each_swing_until_it_sticks() {
    let scene = coulomb();
    for method in of_order(2, &scene) {
        let (mut turns, mut last) = (0, 0.0_f64);
        let end = see(method.id, &scene, 1e-3, 7000, |state| {
            let v = state.v[3];
            if v * last < 0.0 {
                turns += 1;
            }
            last = if v == 0.0 { last } else { v };
        });
        assert_eq!(turns, 12, "{}: between 13 half swings", method.id);
        // Seven turns of order 2 at 1 ms, of which midpoint has the largest constant.
        near(end.x[3], 0.02024, 1e-6, method.id);
        // Midpoint gains 3e-5 J of its own on the way.
        near(end.work.friction, 24.989_758_56, 5e-5, method.id);
        assert_eq!(end.v[3], 0.0, "{}", method.id);
    }
    // The turning points and the end of an integrator of order 4, at four times the step.
    let mut far: Vec<f64> = Vec::new();
    see("rk4", &scene, 1e-3, 2000, |state| far.push(state.x[3]));
    let extreme = far.iter().fold(0.0_f64, |least, x| least.min(*x));
    // Between two steps: x'' h²/8 = 46 1e-6/8.
    near(extreme, -0.92152, 6e-6, "the first turning point");
}

#[test]
fn a_belt_takes_along_what_lies_on_it() {
    let belt = "{plane: {normal: [0, 0, 1]}, friction: 0.5, driven: {velocity: [1, 0, 0]}}";
    let scene = lone("pos: [0, 0, 0]", belt, -G);
    for method in of_order(2, &scene) {
        let end = run(method.id, &scene, 1e-3, 1000);
        // v²/(2 µ g) behind the belt; half of the belt's work is lost.
        near(end.x[0], 1.0 - 1.0 / G, 1e-12, method.id);
        near(end.v[0], 1.0, 1e-14, method.id);
        near(end.work.injected, 1.0, 1e-12, method.id);
        near(end.work.friction, 0.5, 1e-12, method.id);
    }
}

/// From almost the top of a ball without friction: it leaves where cos θ has fallen to two thirds of its start, and from
/// there keeps its horizontal velocity, sqrt(g R) cos^(3/2) θ.
#[test]
fn a_particle_leaves_a_ball_at_the_angle_of_the_textbook() {
    let start = 0.01_f64;
    let high = (1.1_f64.powi(2) - start * start).sqrt();
    let scene = lone(
        &format!("pos: [{start}, 0, {high:?}]"),
        "{ball: {center: [0, 0, 0], radius: 1.1}}",
        -G,
    );
    let leaves = 2.0 / 3.0 * high / 1.1;
    let right = (G * 1.1_f64).sqrt() * leaves.powf(1.5);
    // Methods that take rods follow the surface at their order; the others its tangent, moved back, of second order.
    let off = |id, h: f64| (run(id, &scene, h, (2.0 / h) as u32).v[0] - right).abs();
    for (id, bound) in [
        ("rk4", 2e-9),
        ("rk3", 1e-6),
        ("velocity_verlet", 5e-6),
        ("midpoint", 5e-5),
    ] {
        assert!(off(id, 2e-3) <= bound, "{id}: {:e}", off(id, 2e-3));
    }
    for method in integrators::fixed().iter().filter(|m| m.order >= 2) {
        let (coarse, fine) = (off(method.id, 4e-3), off(method.id, 2e-3));
        let order = (coarse / fine).log2();
        assert!(
            order > 1.7 && fine < 2e-4,
            "{}: {coarse:e} and {fine:e}, order {order}",
            method.id
        );
    }
}

#[test]
fn nothing_fast_passes_a_thin_box() {
    let scene = lone(
        "pos: [0, 0, 1.03], vel: [0, 0, -100]",
        "{box: {center: [0, 0, 0], half_extents: [1, 1, 0.005]}, restitution: 0.5}",
        0.0,
    );
    for method in integrators::fixed() {
        let end = run(method.id, &scene, 0.01, 3);
        // Back at half its speed from 5 mm.
        near(end.v[2], 50.0, 1e-13, method.id);
        near(end.x[2], 0.005 + 50.0 * (0.03 - 0.010_25), 1e-12, method.id);
    }
}

#[test]
fn a_seam_of_a_mesh_does_not_kick() {
    let scene = parsed(
        "solver: {type: rk4, timestep: 0.005}\n\
         duration: 1\n\
         particles: [{pos: [-0.5, 0.1, 0.1], vel: [1, 0.1, 0], mass: 1, radius: 0.1}]\n\
         colliders:\n\
         - mesh: {vertices: [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], triangles: [[0, 1, 2], [0, 2, 3]]}\n",
    );
    for method in of_order(2, &scene) {
        let end = run(method.id, &scene, 5e-3, 200);
        for (found, right) in end
            .x
            .iter()
            .chain(&end.v)
            .zip([0.5, 0.2, 0.1, 1.0, 0.1, 0.0])
        {
            near(*found, right, 1e-12, method.id);
        }
    }
}

/// Where two faces of a mesh meet in a valley, both hold, as two planes do.
#[test]
fn a_valley_of_a_mesh_holds_from_both_sides() {
    let scene = |colliders: &str| {
        parsed(&format!(
            "solver: {{type: rk4, timestep: 0.002}}\n\
             duration: 1.5\n\
             particles: [{{pos: [-1, 0, 1.2], mass: 1, radius: 0.1}}]\n\
             colliders:\n{colliders}"
        ))
    };
    let planes = scene("- {plane: {normal: [1, 0, 1]}}\n- {plane: {normal: [-1, 0, 1]}}\n");
    let mesh = scene(
        "- mesh:\n    vertices: [[-2, -1, 2], [-2, 1, 2], [0, -1, 0], [0, 1, 0], [2, -1, 2], [2, 1, 2]]\n    \
         triangles: [[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5]]\n",
    );
    for method in of_order(2, &mesh) {
        let [one, other] = [&planes, &mesh].map(|scene| run(method.id, scene, 2e-3, 750));
        // At rest at r √2 above the bottom.
        for end in [one, other] {
            near(end.x[0], 0.0, 1e-9, method.id);
            near(end.x[2], 0.1 * 2.0_f64.sqrt(), 1e-9, method.id);
            near(end.v[0].hypot(end.v[2]), 0.0, 1e-9, method.id);
        }
    }
}

/// From the time on at which there is no room left no step can be taken, which is said.
#[test]
fn in_a_wedge_both_planes_hold() {
    let scene = lone(
        "pos: [0, 0, 0], vel: [0, 1, 0]",
        "{plane: {normal: [1, 0, 1]}, friction: 0.1}, {plane: {normal: [-1, 0, 1]}, friction: 0.1}",
        -G,
    );
    // Each plane presses with m g/√2, so that friction is √2 µ m g.
    let right = 0.5 / (2.0_f64.sqrt() * 0.1 * G);
    for method in of_order(2, &scene) {
        let end = run(method.id, &scene, 1e-3, 1000);
        near(end.x[1], right, 1e-12, method.id);
        near(end.x[0].hypot(end.x[2]), 0.0, 1e-14, method.id);
        near(end.work.friction, 0.5, 1e-12, method.id);
    }
}

#[test]
fn the_truth_goes_through_impacts() {
    let scene = lone(
        "pos: [0, 0, 1]",
        "{plane: {normal: [0, 0, 1]}, restitution: 0.8}",
        -G,
    );
    let system = ParticleSystem::new(&scene);
    let found = truth::find(&scene, &system, Demand::Auto, 2.0, &NoStore);
    let motion = found.motion().expect("a truth");
    let states = motion.states(&[1.0, 2.0]);
    let bar = motion.error_bar(2.0);
    assert!(bar <= 1e-12, "{bar:e}");
    near(states.x(0)[2], 0.468_004_452_526_036_3, bar, "t = 1");
    near(states.x(1)[2], 0.260_741_728_327_057_2, bar, "t = 2");

    let scene = coulomb();
    let system = ParticleSystem::new(&scene);
    let found = truth::find(&scene, &system, Demand::Auto, 7.0, &NoStore);
    let motion = found.motion().expect("a truth");
    near(
        motion.states(&[6.5]).x(0)[3],
        0.02024,
        motion.error_bar(7.0),
        "at rest",
    );
}

/// What rapier's own soft contact does on a half space, as measured in its source's version: apexes of a ball dropped
/// from a gap of 1 m.
#[test]
fn rapiers_ball_bounces_as_rapiers_does() {
    for (restitution, apexes) in [(0.5, [0.249_143, 0.061_665]), (1.0, [0.997_128, 0.992_710])] {
        let scene = parsed(&format!(
            "solver: {{type: rk4, timestep: 0.001}}\n\
             duration: 5\n\
             particles: [{{pos: [0, 0, 1.1], mass: 1, radius: 0.1}}]\n\
             colliders: [{{plane: {{normal: [0, 0, 1]}}, restitution: {restitution}}}]\n"
        ));
        let system = ParticleSystem::new(&scene);
        let rapier = solvers::find("rapier").expect("rapier");
        let mut run = rapier
            .start(&scene, &system, &Setting::step(1e-3))
            .expect("a run");
        let mut heights = Vec::new();
        for _ in 0..3000 {
            run.advance(1).expect("a step");
            heights.push(run.state().x[2] - 0.1);
        }
        let peaks = heights.windows(3).filter(|w| w[1] > w[0] && w[1] >= w[2]);
        let peaks: Vec<f64> = peaks.map(|w| w[1]).take(2).collect();
        // A tie moves an apex by 8.5e-7 m, and six digits are known.
        for (found, right) in peaks.iter().zip(apexes) {
            near(*found, right, 1.5e-6, "an apex");
        }
        assert_eq!(peaks.len(), 2);
    }
}

/// A scene without obstacles takes the same steps to the last bit, and one whose obstacle is far away too.
#[test]
fn an_obstacle_out_of_reach_changes_no_bit() {
    let mut scene = Scene {
        particles: vec![
            fixed([0.0; 3]),
            Particle {
                velocity: [0.3, 0.2, 0.1],
                ..free([1.2, 0.0, 0.0], 0.7)
            },
        ],
        springs: vec![spring([0, 1], 50.0, 1.0)],
        ..empty()
    };
    scene.solver.gravity = -G;
    let mut beside = scene.clone();
    beside.colliders = lone(
        "pos: [0, 0, 0]",
        "{plane: {normal: [0, 0, 1], offset: -100}}",
        -G,
    )
    .colliders;
    for method in integrators::fixed() {
        let [one, other] = [&scene, &beside].map(|scene| run(method.id, scene, 0.01, 100));
        assert_eq!(one, other, "{}", method.id);
    }
}
