//! rapier's soft step is named from its rows alone, and nothing else is.

use super::{contact, found, parsed};
use crate::identity::{Precision, Rows, Scene, every, record};
use springcheck::measure::identify::Found;
use springcheck::physics::ParticleSystem;
use springcheck::solvers::rapier::RapierSettings;
use springcheck::solvers::{Setting, Solver};

/// Two balls of other heights above one plane.
fn balls(particles: &str, normal: &str, [e, mu]: [f64; 2], h: f64) -> Scene {
    parsed(&format!(
        "solver: {{type: rk4, timestep: {h}, gravity: -9.81}}\nduration: 10\nparticles: [{particles}]\n\
         colliders: [{{plane: {{normal: {normal}}}, restitution: {e}, friction: {mu}}}]\n"
    ))
}

const FALLING: &str = "{pos: [0, 0, 0.537], vel: [1.1, 0.3, 0], mass: 1, radius: 0.1}, \
                       {pos: [2, 0, 0.8213], vel: [0, -0.4, 0.5], mass: 0.7, radius: 0.05}";
/// On a plane of 30 degrees, 1 mm and 5 mm above it.
const SLIDING: &str = "{pos: [0.0505, 0, 0.087468], vel: [0, 0, 0], mass: 1, radius: 0.1}, \
                       {pos: [2.0275, 0.3, -1.10709], vel: [0, 0.2, 0], mass: 0.7, radius: 0.05}";

fn rapier(scene: &Scene, steps: u64) -> Rows {
    let settings = RapierSettings {
        stabilization: 1,
        ..RapierSettings::CONVERGED
    };
    let h = scene.solver.timestep;
    let system = ParticleSystem::new(scene);
    let engine = Solver::rapier(settings).engine(scene, &system, &Setting::step(h));
    record(&mut *engine.expect("a world"), h, steps)
}

fn treatment(found: &Found) -> Option<&str> {
    contact(found)?.treatment.as_deref()
}

fn soft(scene: &Scene, rows: &Rows) -> Result<(), String> {
    let found = found(scene, rows, None);
    let identity = found.identity.as_ref();
    let right = identity.is_some_and(|one| one.is("symplectic_euler/4") && !one.mistake)
        && treatment(&found) == Some("soft_step")
        && found.explained.is_none();
    right.then_some(()).ok_or_else(|| format!("{found:#?}"))
}

#[test]
fn rapiers_rows_are_named() {
    let mut failed = Vec::new();
    for h in [0.01, 1.0 / 60.0] {
        for e in [0.0, 0.5, 0.8] {
            for (name, particles, normal, mu) in [
                ("falling", FALLING, "[0, 0, 1]", 0.2),
                ("slides", SLIDING, "[0.5, 0, 0.8660254037844386]", 0.3),
                ("rests", SLIDING, "[0.5, 0, 0.8660254037844386]", 0.8),
            ] {
                let scene = balls(particles, normal, [e, mu], h);
                let rows = rapier(&scene, 200);
                if let Err(why) = soft(&scene, &rows) {
                    failed.push(format!("{name} {e} {h}: {why}"));
                }
            }
        }
    }
    assert!(failed.is_empty(), "{}: {}", failed.len(), failed.join("\n"));
}

/// Thinned rows are steps from row to row; rows that begin in contact have impulses that are not known.
#[test]
fn thinned_rows_and_late_ones_are_named() {
    let scene = balls(FALLING, "[0, 0, 1]", [0.5, 0.2], 0.01);
    let rows = rapier(&scene, 200);
    for n in [2, 5] {
        let mut thinned = every(&rows, n);
        thinned.steps.iter_mut().for_each(|step| *step *= n as u64);
        soft(&scene, &thinned).unwrap_or_else(|why| panic!("every {n}: {why}"));
    }
    let scene = balls(SLIDING, "[0.5, 0, 0.8660254037844386]", [0.0, 0.3], 0.01);
    let rows = rapier(&scene, 200);
    let late = Rows {
        steps: rows.steps[50..].to_vec(),
        x: rows.x[50 * rows.dim..].to_vec(),
        v: rows.v.as_ref().map(|v| v[50 * rows.dim..].to_vec()),
        ..rows
    };
    soft(&scene, &late).unwrap_or_else(|why| panic!("late: {why}"));
}

/// A ball's soft step above z = 0 as Box2D's author writes it, in doubles and for one ball: its rate in Hz, and whether
/// restitution follows. <https://box2d.org/posts/2024/02/solver2d/>
fn written(scene: &Scene, hertz: f64, bounces: bool, steps: u64) -> Rows {
    let surface = &scene.colliders[0];
    let (e, mu, h) = (surface.restitution, surface.friction, scene.solver.timestep);
    let part = h / 4.0;
    let w = std::f64::consts::TAU * hertz;
    let a1 = 2.0 * 10.0 + part * w;
    let (rate, a2) = (w / a1, part * w * a1);
    let (mass_part, impulse_part) = (a2 / (1.0 + a2), 1.0 / (1.0 + a2));
    let mut rows = Rows {
        timestep: h,
        dim: 3 * scene.particles.len(),
        steps: (0..=steps).collect(),
        x: Vec::new(),
        v: Some(Vec::new()),
        precision: Precision::Double,
        precision_v: Precision::Double,
        cut: false,
    };
    let mut balls: Vec<Ball> = (scene.particles.iter())
        .map(|one| Ball {
            x: one.position,
            v: one.velocity,
            mass: one.mass,
            radius: one.radius,
            normal: 0.0,
            along: [0.0; 2],
            loaded: false,
        })
        .collect();
    for step in 0..=steps {
        for ball in &balls {
            rows.x.extend(ball.x);
            rows.v.as_mut().expect("velocities").extend(ball.v);
        }
        if step == steps {
            break;
        }
        for ball in &mut balls {
            let approach = ball.v[2];
            let touches = ball.x[2] - ball.radius < 0.02;
            let was = ball.loaded;
            if !touches {
                (ball.normal, ball.along) = (0.0, [0.0; 2]);
            }
            let mut total = 0.0;
            for _ in 0..4 {
                ball.v[2] -= 9.81 * part;
                ball.give(ball.normal, ball.along);
                let gap = ball.x[2] - ball.radius;
                if touches {
                    let (bias, m, i) = match gap > 0.0 {
                        true => (gap / part, 1.0, 0.0),
                        false => ((rate * gap).max(-3.0), mass_part, impulse_part),
                    };
                    let impulse = -ball.mass * m * (ball.v[2] + bias) - i * ball.normal;
                    ball.press(impulse);
                }
                for axis in 0..3 {
                    ball.x[axis] += part * ball.v[axis];
                }
                if touches {
                    let gap = ball.x[2] - ball.radius;
                    ball.press(-ball.mass * (ball.v[2] + gap.max(0.0) / part));
                    ball.rub(mu);
                }
                total += ball.normal;
            }
            ball.loaded = touches && total > 0.0;
            if bounces && !was && ball.loaded && approach < 0.0 {
                ball.press(-ball.mass * (ball.v[2] + e * approach));
            }
        }
    }
    rows
}

struct Ball {
    x: [f64; 3],
    v: [f64; 3],
    mass: f64,
    radius: f64,
    normal: f64,
    along: [f64; 2],
    loaded: bool,
}

impl Ball {
    fn give(&mut self, normal: f64, along: [f64; 2]) {
        self.v[2] += normal / self.mass;
        for axis in 0..2 {
            self.v[axis] += along[axis] / self.mass;
        }
    }

    fn press(&mut self, impulse: f64) {
        let new = (self.normal + impulse).max(0.0);
        self.give(new - self.normal, [0.0; 2]);
        self.normal = new;
    }

    fn rub(&mut self, mu: f64) {
        let wanted = [0, 1].map(|axis| self.along[axis] - self.mass * self.v[axis]);
        let (size, most) = (wanted[0].hypot(wanted[1]), mu * self.normal);
        let new = wanted.map(|part| {
            if size > most {
                part * most / size
            } else {
                part
            }
        });
        self.give(0.0, [0, 1].map(|axis| new[axis] - self.along[axis]));
        self.along = new;
    }
}

#[test]
fn a_soft_step_written_by_another_hand_is_named_and_its_mutants_are_not() {
    for e in [0.0, 0.5, 0.8] {
        let scene = balls(FALLING, "[0, 0, 1]", [e, 0.2], 0.01);
        let rows = written(&scene, 60.0, true, 200);
        soft(&scene, &rows).unwrap_or_else(|why| panic!("{e}: {why}"));
        for (hertz, bounces) in [(30.0, true), (60.0, false)] {
            let rows = written(&scene, hertz, bounces, 200);
            let found = found(&scene, &rows, None);
            let is = treatment(&found) == Some("soft_step");
            assert_eq!(
                is,
                e == 0.0 && !bounces,
                "{e} {hertz} {bounces}: {found:#?}"
            );
        }
    }
}

#[test]
fn newtons_impulse_is_no_soft_step() {
    let (ball, forces) = (super::Ball::new(0.8, 0.2), super::Forces::default());
    let scene = super::scene(&forces, &ball, 0.01);
    for (id, step) in super::METHODS {
        for (rule, treatment) in super::RULES {
            let rows = super::rows(&scene, &ball, &forces, step, (rule, super::bounce), 90);
            let found = found(&scene, &rows, None);
            let treated = contact(&found).expect("contact");
            assert_eq!(treated.treatment.as_deref(), Some(treatment), "{id}");
            let listed = treated.equivalent.iter().any(|other| other == "soft_step");
            assert!(!listed, "{id}: {treated:?}");
        }
    }
}
