//! rapier's contact is the step written here, to rounding, and both follow the closed forms of that step.

use crate::testkit::scenes::parsed;
use springcheck::integrators::{RapierContact, Softness};
use springcheck::measure::Bounce;
use springcheck::physics::{ParticleSystem, State, System};
use springcheck::scene::Scene;
use springcheck::solvers::rapier::RapierSettings;
use springcheck::solvers::{Engine, Setting, Solver, advance, find};
use springcheck::trajectory::{Precision, Rows, Trajectory};

const G: f64 = 9.81;
/// A thousand times what is found; a hundred steps of coordinates near 1 m round by 1e-14.
const ROUNDING: f64 = 1e-12;

fn settings(iterations: u32) -> RapierSettings {
    RapierSettings {
        iterations,
        ..RapierSettings::DEFAULT
    }
}

/// One particle of 1 kg and 0.1 m beside one obstacle.
fn lone(particle: &str, collider: &str, gravity: f64) -> Scene {
    parsed(&format!(
        "solver: {{type: rk4, timestep: 0.01, gravity: {gravity}}}\n\
         duration: 10\n\
         particles: [{{mass: 1, radius: 0.1, {particle}}}]\n\
         colliders: [{collider}]\n"
    ))
}

/// The gap is to a floor at 0.
fn dropped(gap: f64, restitution: f64) -> Scene {
    let floor = format!("{{plane: {{normal: [0, 0, 1]}}, restitution: {restitution}}}");
    lone(&format!("pos: [0, 0, {:?}]", gap + 0.1), &floor, -G)
}

fn engine(solver: &Solver, scene: &Scene, h: f64) -> Box<dyn Engine> {
    let system = ParticleSystem::new(scene);
    let engine = solver.engine(scene, &system, &Setting::step(h));
    engine.unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

/// rapier and ours side by side.
struct Pair {
    theirs: Box<dyn Engine>,
    system: ParticleSystem,
    contact: RapierContact,
    ours: State,
    h: f64,
    steps: u32,
    /// How far rounding alone may have moved the particle so far, m.
    moved: f64,
    /// Rounding has decided whether it bounces.
    parted: bool,
}

impl Pair {
    fn new(scene: &Scene, settings: RapierSettings, h: f64) -> Self {
        Self::of(scene, scene, settings, h)
    }

    fn of(theirs: &Scene, ours: &Scene, settings: RapierSettings, h: f64) -> Self {
        Self {
            theirs: engine(&Solver::rapier(settings), theirs, h),
            system: ParticleSystem::new(ours),
            contact: settings.contact(),
            ours: ParticleSystem::initial_state(ours),
            h,
            steps: 0,
            moved: 0.0,
            parted: false,
        }
    }

    /// The next step of ours begins where rapier is.
    fn follow(&mut self) {
        self.ours.clone_from(self.theirs.state());
        self.contact.resume(&self.ours);
    }

    /// A step of both; how far they are apart then, m and m/s.
    fn step(&mut self) -> [f64; 2] {
        self.steps += 1;
        let end = f64::from(self.steps) * self.h;
        self.theirs.step().expect("a step");
        advance(&mut self.contact, &self.system, self.h, end, &mut self.ours).expect("a step");
        self.moved += self.contact.ties().position;
        self.parted |= self.contact.ties().velocity > 0.0;
        let off = |a: &[f64], b: &[f64]| {
            let each = a.iter().zip(b).map(|(a, b)| (a - b).abs());
            each.fold(0.0, f64::max)
        };
        let theirs = self.theirs.state();
        [off(&theirs.x, &self.ours.x), off(&theirs.v, &self.ours.v)]
    }
}

/// Heights without a pattern, m.
fn heights(count: u32) -> impl Iterator<Item = f64> {
    (1..=count).map(|k| 0.3 + 1.2 * (f64::from(k) * 0.618_033_988_749_894_8).fract())
}

/// The highest places between bounces.
#[derive(Default)]
struct Apexes {
    last: [f64; 2],
    found: Vec<f64>,
}

impl Apexes {
    fn see(&mut self, z: f64) {
        let [before, last] = self.last;
        if last > before && last >= z && before > 0.0 {
            self.found.push(last);
        }
        self.last = [last, z];
    }
}

/// An impact that stops at a gap of 0 but for rounding is rigid or soft: n (1 - s) g h² in position.
#[test]
fn three_bounces_are_rapiers() {
    let (mut judged, mut parted) = (0, 0);
    for restitution in [0.0, 0.5, 0.8, 1.0] {
        for h in [1.0 / 60.0, 1.0 / 240.0, 1e-3] {
            for n in [1, 4, 16] {
                let part = h / f64::from(n);
                let share = Softness::new(false, part).share;
                let tie = f64::from(n) * (1.0 - share) * G * part * part;
                for gap in heights(8) {
                    let scene = dropped(gap, restitution);
                    let mut pair = Pair::new(&scene, settings(n), h);
                    let mut apexes = [Apexes::default(), Apexes::default()];
                    let steps = (2.5 / h) as u32;
                    for _ in 0..steps {
                        let [far, _] = pair.step();
                        // An impact that begins at a gap of 0 is another matter.
                        pair.parted |= pair.contact.ties().position > 1.01 * tie;
                        // What does not bounce has no apex: its whole way.
                        if restitution == 0.0 {
                            assert!(far <= tie + ROUNDING, "{far:e} at {h}, {n}, {gap}");
                        }
                        apexes[0].see(pair.theirs.state().x[2]);
                        apexes[1].see(pair.ours.x[2]);
                        if pair.parted || apexes.iter().all(|seen| seen.found.len() > 3) {
                            break;
                        }
                    }
                    parted += u32::from(pair.parted);
                    let [theirs, ours] = apexes.map(|seen| seen.found);
                    for (theirs, ours) in theirs.iter().zip(&ours).take(3) {
                        let off = (theirs - ours).abs();
                        let what = format!("e = {restitution}, h = {h}, n = {n}, gap {gap}");
                        assert!(off <= tie + ROUNDING, "{what}: {off:e}");
                        judged += 1;
                    }
                }
            }
        }
    }
    println!("{judged} apexes, {parted} trajectories that rounding parts");
    assert!(judged > 590 && parted < 20, "{judged}, {parted}");
}

/// The same with something else on one side.
#[test]
fn mutants_bounce_otherwise() {
    let off = |ours: &Scene, settings: RapierSettings| {
        let mut pair = Pair::of(&dropped(0.8137, 0.8), ours, settings, 1e-3);
        let steps = (0..900).map(|_| pair.step()[0]);
        steps.fold(0.0, f64::max)
    };
    let right = dropped(0.8137, 0.8);
    assert!(off(&right, settings(4)) <= 1e-6);
    assert!(off(&dropped(0.8137, 0.8001), settings(4)) > 1e-5);
    let mut other = Pair::new(&right, settings(4), 1e-3);
    other.contact = settings(5).contact();
    let steps = (0..900).map(|_| other.step()[0]);
    assert!(steps.fold(0.0, f64::max) > 1e-5);
}

/// A plane of 30 degrees that rises along x, and a particle as deep in it as it rests.
fn inclined(ratio: f64) -> Scene {
    let (sin, cos) = (0.5, 0.75_f64.sqrt());
    let depth = G * cos / Softness::new(false, 1.0).angular_frequency.powi(2);
    let plane = format!(
        "{{plane: {{normal: [{:?}, 0, {cos:?}]}}, friction: {:?}}}",
        -sin,
        sin / cos / ratio
    );
    let mut scene = lone("pos: [0, 0, 1]", &plane, -G);
    scene.particles[0].position = [-sin, 0.0, cos].map(|n| (0.1 - depth) * n);
    scene
}

#[test]
fn on_an_incline_it_sticks_below_the_angle_of_friction_and_slides_above() {
    for (ratio, slides) in [(0.9999, false), (1.0001, true)] {
        for (h, n) in [(1.0 / 60.0, 4), (1e-3, 4), (1e-3, 1)] {
            let mut pair = Pair::new(&inclined(ratio), settings(n), h);
            let steps = (1.0 / h).round() as u32;
            for _ in 0..steps {
                let [far, fast] = pair.step();
                assert!(far <= ROUNDING && fast <= ROUNDING, "{far:e} {fast:e}");
            }
            let v = &pair.theirs.state().v;
            let speed = v[0].hypot(v[2]);
            // sin - µ cos = sin (1 - 1/ratio).
            let right = if slides {
                G * 0.5 * (1.0 - 1.0 / ratio) * f64::from(steps) * h
            } else {
                0.0
            };
            println!("{ratio} {h} {n}: {speed:e}, {:e}", speed - right);
            assert!((speed - right).abs() <= ROUNDING, "{speed:e}");
        }
    }
}

/// v - k a h for k = 1, 2, ...: v²/(2 a) - v h/2, and up to a h²/8 that the last substep adds.
#[test]
fn what_slides_stops_half_a_substep_early() {
    let depth = G / Softness::new(false, 1.0).angular_frequency.powi(2);
    let mut scene = lone(
        "pos: [0, 0, 0.1], vel: [2, 0, 0]",
        "{plane: {normal: [0, 0, 1]}, friction: 0.5}",
        -G,
    );
    scene.particles[0].position[2] -= depth;
    for (h, n) in [(1.0 / 60.0, 1), (1.0 / 60.0, 4), (1e-3, 4)] {
        let mut pair = Pair::new(&scene, settings(n), h);
        for _ in 0..(1.0 / h) as u32 {
            let [far, fast] = pair.step();
            assert!(far <= ROUNDING && fast <= ROUNDING, "{far:e} {fast:e}");
        }
        let (a, part) = (0.5 * G, h / f64::from(n));
        let beyond = pair.theirs.state().x[0] - (2.0 / a - part);
        let most = a * part * part / 8.0;
        println!("{h} {n}: {beyond:e} of {most:e}");
        assert!(
            (-ROUNDING..=most + ROUNDING).contains(&beyond),
            "{beyond:e}"
        );
        assert_eq!(pair.theirs.state().v[0], 0.0);
    }
}

/// rapier-converged sweeps once after the drift where there is contact: without, friction is lost in the bias.
#[test]
fn converged_sweeps_once_after_the_drift_where_there_are_obstacles() {
    let touching = lone(
        "pos: [0, 0, 0.1], vel: [2, 0, 0]",
        "{plane: {normal: [0, 0, 1]}, friction: 0.5}",
        -G,
    );
    let free = parsed(
        "solver: {type: rk4, timestep: 0.01}\n\
         particles: [{pos: [0, 0, 1], fixed: true}, {pos: [1, 0, 1], mass: 1}, {pos: [2, 0, 1], mass: 1}]\n\
         springs: [{particle_ids: [0, 1], stiffness: 100, rest_length: 1}, {particle_ids: [1, 2], stiffness: 100, rest_length: 0.9}]\n",
    );
    for (scene, stabilization) in [(&touching, 1), (&free, 0)] {
        let same = Solver::rapier(RapierSettings {
            pgs: 64,
            stabilization,
            ..RapierSettings::DEFAULT
        });
        let mut named = engine(&find("rapier-converged").expect("a row"), scene, 0.01);
        let mut written = engine(&same, scene, 0.01);
        for _ in 0..100 {
            named.step().expect("a step");
            written.step().expect("a step");
        }
        assert_eq!(named.state(), written.state());
        if stabilization == 1 {
            assert_eq!(named.state().v[0], 0.0, "it has stopped");
        }
    }
}

/// N/(m w²) inside after 30 time constants, whatever the step: e^-30 of 1 cm is 1e-15 m.
#[test]
fn what_rests_is_inside_by_its_weight_over_its_stiffness() {
    for (moves, right) in [(false, 6.902_505_635_6e-5), (true, 2.761_002_254_3e-4)] {
        let driven = if moves {
            ", driven: {velocity: [0.1, 0, 0]}"
        } else {
            ""
        };
        let scene = lone(
            "pos: [0, 0, 0.1012]",
            &format!("{{plane: {{normal: [0, 0, 1]}}{driven}}}"),
            -G,
        );
        for (h, n) in [(1.0 / 60.0, 4), (1e-3, 4), (1.0 / 240.0, 1)] {
            let part = h / f64::from(n);
            let until = 30.0 * Softness::new(moves, part).settles_in(part);
            let mut pair = Pair::new(&scene, settings(n), h);
            for _ in 0..(until / h) as u32 {
                pair.step();
            }
            for z in [pair.theirs.state().x[2], pair.ours.x[2]] {
                let depth = 0.1 - z;
                // The right values have eleven digits. Half a last bit of 0.1 m a substep adds up for a time constant.
                let rounding = 7e-18 * until / 30.0 / part;
                assert!(
                    (depth - right).abs() <= 5e-15 + rounding,
                    "{h}, {n}: {depth:e}"
                );
            }
        }
    }
}

/// One spring above a floor: its joint row and the contact row by turns.
#[test]
fn a_particle_on_a_spring_bounces_as_in_rapier() {
    let mut judged = 0;
    for (stiffness, damping, side) in [
        (50.0, 0.0, 0.0),
        (1e4, 0.0, 0.0),
        (50.0, 5.0, 0.3),
        (1e4, 5.0, 0.3),
    ] {
        for restitution in [0.0, 0.5] {
            for (h, n) in [(1.0 / 240.0, 4), (1e-3, 4), (1e-3, 1)] {
                let scene = parsed(&format!(
                    "solver: {{type: rk4, timestep: 0.01}}\n\
                     duration: 10\n\
                     particles: [{{pos: [0, 0, 1.4], fixed: true}}, {{pos: [{side}, 0, 0.7317], mass: 1, radius: 0.1}}]\n\
                     springs: [{{particle_ids: [0, 1], stiffness: {stiffness}, damping: {damping}, rest_length: 1.213}}]\n\
                     colliders: [{{plane: {{normal: [0, 0, 1]}}, restitution: {restitution}, friction: 0.2}}]\n"
                ));
                let mut pair = Pair::new(&scene, settings(n), h);
                let (mut pressed, mut largest) = (0, [0.0_f64; 2]);
                for _ in 0..(1.0 / h) as u32 {
                    // Where rounding decides, a spring would pull otherwise for ever.
                    pair.follow();
                    let off = pair.step();
                    let ties = pair.contact.ties();
                    pressed += u32::from(!pair.contact.kept().is_empty());
                    assert!(
                        off[0] <= ROUNDING + ties.position,
                        "{stiffness} {damping} {restitution} {h} {n}: {off:?} at {}",
                        pair.steps
                    );
                    if ties == Default::default() {
                        assert!(off[1] <= 10.0 * ROUNDING, "{:e}", off[1]);
                        largest = [largest[0].max(off[0]), largest[1].max(off[1])];
                    }
                }
                println!("{stiffness} {damping} {restitution} {h} {n}: {pressed}, {largest:?}");
                judged += u32::from(pressed > 0);
            }
        }
    }
    assert!(judged >= 20, "{judged}");
}

/// Anything from nothing to µ V by the phase, never µ (1 + e) V.
#[test]
fn friction_of_an_impact_sees_the_compression_alone() {
    for (n, mean) in [(1, 0.5), (4, 0.875)] {
        let mut sum = 0.0;
        for gap in heights(200) {
            let scene = lone(
                &format!("pos: [0, 0, {:?}], vel: [3, 0, -4]", 0.1 + 0.1 * gap),
                "{plane: {normal: [0, 0, 1]}, restitution: 0.5, friction: 0.2}",
                0.0,
            );
            let mut pair = Pair::new(&scene, settings(n), 1e-3);
            for _ in 0..60 {
                let [_, fast] = pair.step();
                assert!(fast <= ROUNDING || pair.parted, "{gap}: {fast:e}");
            }
            let v = &pair.theirs.state().v;
            assert!((v[2] - 2.0).abs() <= ROUNDING);
            let taken = (3.0 - v[0]) / (0.2 * 4.0);
            assert!((-ROUNDING..=1.0 + ROUNDING).contains(&taken), "{taken}");
            sum += taken;
        }
        let found = sum / 200.0;
        println!("{n}: {found}");
        // Uniform in the first phase of n: 200 of them have a mean to 3 times 0.29/sqrt(200).
        assert!((found - mean).abs() < 0.06, "{n}: {found}");
    }
}

fn recorded(scene: &Scene, n: u32, h: f64, steps: u64) -> Trajectory {
    let mut engine = engine(&Solver::rapier(settings(n)), scene, h);
    let (mut x, mut v) = (engine.state().x.clone(), engine.state().v.clone());
    for _ in 0..steps {
        engine.step().expect("a step");
        x.extend_from_slice(&engine.state().x);
        v.extend_from_slice(&engine.state().v);
    }
    let rows = Rows {
        timestep: h,
        dim: 3,
        steps: (0..=steps).collect(),
        x,
        v: Some(v),
        precision: Precision::Double,
        precision_v: Precision::Double,
        cut: false,
    };
    let work = vec![Default::default(); rows.steps.len()];
    Trajectory::of_rows(&rows, &work, steps, false)
}

/// The height that free fall in substeps of h keeps: z + (v² - g h v)/(2 g).
#[test]
fn a_bounce_loses_what_the_discrete_law_says() {
    for restitution in [0.5, 0.8, 1.0] {
        for (h, n) in [(1.0 / 60.0, 4), (1.0 / 240.0, 4), (1e-3, 1)] {
            for gap in heights(12) {
                let scene = dropped(gap, restitution);
                let falls = (2.0 * gap / G).sqrt();
                let steps = (1.3 * falls / h) as u64;
                let run = recorded(&scene, n, h, steps);
                let system = ParticleSystem::new(&scene);
                let part = h / f64::from(n);
                let obstacles = system.obstacles().expect("a floor");
                let bounce = Bounce::first(obstacles, &run, part).expect("a bounce");
                let last = run.len() - 1;
                let (z, v) = (run.x(last)[2] - 0.1, run.v(last)[2]);
                let after = z + (v * v - G * part * v) / (2.0 * G);
                let e2 = restitution * restitution;
                let right = e2 * gap - bounce.lost();
                // A hundred steps of coordinates near 1 m.
                assert!(
                    (after - right).abs() <= 2e-14 * steps as f64,
                    "{after} not {right}"
                );
                // V h and the way of that step, for e = 1; without V h it is another number.
                let way = e2 * bounce.gaps[0] - bounce.gaps[1];
                assert!((after - (e2 * gap - way)).abs() > 0.1 * bounce.speed * part);
            }
        }
    }
}

/// Steps, each from a state of the right ones, after which those that knew no impulses at first have no other ends.
fn forgotten_in(scene: &Scene, from: u32) -> u32 {
    let h = scene.solver.timestep;
    let system = ParticleSystem::new(scene);
    let contact = || RapierContact::new(4, 64, 1);
    let (mut right, mut other) = (contact(), contact());
    let mut state = ParticleSystem::initial_state(scene);
    let mut last = 0;
    for step in 0..from + 30 {
        let end = f64::from(step + 1) * h;
        let begin = state.clone();
        advance(&mut right, &system, h, end, &mut state).expect("a step");
        if step < from {
            continue;
        }
        assert!(!right.kept().is_empty(), "nothing touches at {step}");
        let kept = if step > from {
            other.kept().to_vec()
        } else {
            Vec::new()
        };
        let mut own = begin;
        other.recall(&kept, &own);
        advance(&mut other, &system, h, end, &mut own).expect("a step");
        let pairs = state
            .x
            .iter()
            .chain(&state.v)
            .zip(own.x.iter().chain(&own.v));
        let apart = pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        // Gaps of coordinates below 5 m over a substep round by 1e-12.
        if apart > 1e-12 {
            last = step + 1 - from;
        }
    }
    last
}

/// Identity takes the impulses of rows that begin late to be known after two steps. Those of lone contacts are after one, in
/// which a wrong tangential impulse moves the first substep. Two that rub share their load as they did before.
#[test]
fn impulses_of_lone_contacts_that_are_not_known_are_found_in_a_step() {
    let plane = |normal: &str, mu: f64| format!("{{plane: {{normal: {normal}}}, friction: {mu}}}");
    for mu in [0.0, 0.2, 0.8] {
        let slope = plane("[0.5, 0, 0.8660254037844386]", mu);
        let groove = format!("{slope}, {}", plane("[-0.8660254037844386, 0, 0.5]", mu));
        let rubs = mu > 0.0;
        for (colliders, steps) in [
            (slope, u32::from(rubs)),
            (groove, if rubs { 30 } else { 0 }),
        ] {
            let scene = lone("pos: [-0.0389, 0, 0.1726], vel: [0, 1, 0]", &colliders, -G);
            for from in [40, 60] {
                assert_eq!(forgotten_in(&scene, from), steps, "{mu}: {colliders}");
            }
        }
    }
}
