//! Textbook methods in codings that share nothing with the program's own: named on every scene of the course and
//! of the small folders, whatever their order of operations.

use super::*;
use crate::testkit::scenes::{all_shipped, chain};
use springcheck::measure::identify::FIT;
use springcheck::scene::DampingModel;

type Vectors = Vec<[f64; 3]>;
/// Positions and velocities of all particles.
type Point = (Vectors, Vectors);

/// Two orders of operations: forces summed over springs from first to last, seen from the first end, or from last
/// to first, seen from the second, with gravity last.
#[derive(Clone, Copy, Debug)]
enum Coding {
    Forward,
    Backward,
}

/// Accelerations of springs, dampers, hinges, gravity, drag, wind, attraction and a magnetic field.
fn acceleration(scene: &Scene, coding: Coding, (x, v): (&Vectors, &Vectors)) -> Vectors {
    let mut f: Vectors = vec![[0.0; 3]; x.len()];
    let weigh = |f: &mut Vectors| {
        for (f, p) in f.iter_mut().zip(&scene.particles) {
            f[scene.up.index()] += p.mass * scene.solver.gravity;
        }
    };
    if matches!(coding, Coding::Forward) {
        weigh(&mut f);
    }
    let mut order: Vec<usize> = (0..scene.springs.len()).collect();
    if matches!(coding, Coding::Backward) {
        order.reverse();
    }
    for s in order {
        let spring = &scene.springs[s];
        let [mut a, mut b] = spring.ends;
        if matches!(coding, Coding::Backward) {
            std::mem::swap(&mut a, &mut b);
        }
        let d = [0, 1, 2].map(|i| x[b][i] - x[a][i]);
        let l = d[0].hypot(d[1]).hypot(d[2]);
        if l == 0.0 {
            continue;
        }
        let stretch = l - spring.rest_length;
        let pull = spring.stiffness * stretch + spring.cubic * stretch.powi(3);
        let relative = [0, 1, 2].map(|i| v[b][i] - v[a][i]);
        let n = d.map(|d| d / l);
        let along = n[2] * relative[2] + n[1] * relative[1] + n[0] * relative[0];
        for i in 0..3 {
            let damped = match scene.damping_model {
                DampingModel::Axial => spring.damping * along * n[i],
                DampingModel::Isotropic => spring.damping * relative[i],
            };
            let force = pull * d[i] / l + damped;
            f[a][i] += force;
            f[b][i] -= force;
        }
    }
    for hinge in &scene.bending {
        // As a textbook has it: the angle from its cosine, and the chain rule.
        let [a, b, c] = hinge.particles;
        let links = [(a, b), (b, c)].map(|(from, to)| [0, 1, 2].map(|i| x[to][i] - x[from][i]));
        let turns = [(a, b), (b, c)].map(|(from, to)| [0, 1, 2].map(|i| v[to][i] - v[from][i]));
        let dot = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let lengths = [0, 1].map(|i| dot(&links[i], &links[i]).sqrt());
        let cos = dot(&links[0], &links[1]) / (lengths[0] * lengths[1]);
        let (angle, sin) = (cos.acos(), (1.0 - cos * cos).sqrt());
        let by = [0, 1].map(|i| {
            let other = links[1 - i].map(|d| d / lengths[1 - i]);
            let own = links[i].map(|d| d / lengths[i]);
            [0, 1, 2].map(|k| (cos * own[k] - other[k]) / (sin * lengths[i]))
        });
        let rate = dot(&by[0], &turns[0]) + dot(&by[1], &turns[1]);
        let moment = hinge.stiffness * (angle - hinge.rest_angle) + hinge.damping * rate;
        for i in 0..3 {
            f[a][i] += moment * by[0][i];
            f[b][i] -= moment * (by[0][i] - by[1][i]);
            f[c][i] -= moment * by[1][i];
        }
    }
    if let Some(magnetic) = &scene.magnetic {
        let b = magnetic.field;
        for (i, p) in scene.particles.iter().enumerate() {
            for axis in 0..3 {
                let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
                f[i][axis] += p.charge * (v[i][next] * b[last] - v[i][last] * b[next]);
            }
        }
    }
    for pair in &scene.gravitational {
        let [a, b] = pair.ends;
        let d = [0, 1, 2].map(|i| x[b][i] - x[a][i]);
        let l = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        let size = pair.g * scene.particles[a].mass * scene.particles[b].mass / (l * l * l);
        for i in 0..3 {
            f[a][i] += size * d[i];
            f[b][i] -= size * d[i];
        }
    }
    for (i, p) in scene.particles.iter().enumerate() {
        for axis in 0..3 {
            f[i][axis] -= p.drag * v[i][axis];
            if let Some(wind) = &scene.wind {
                f[i][axis] += wind.strength * wind.direction[axis];
            }
        }
    }
    if matches!(coding, Coding::Backward) {
        weigh(&mut f);
    }
    let of = |(f, p): (&[f64; 3], &springcheck::scene::Particle)| match p.fixed {
        true => [0.0; 3],
        false => f.map(|f| f / p.mass),
    };
    f.iter().zip(&scene.particles).map(of).collect()
}

fn plus(y: &Vectors, h: f64, x: &Vectors) -> Vectors {
    let pairs = y.iter().zip(x);
    pairs
        .map(|(y, x)| [0, 1, 2].map(|i| y[i] + h * x[i]))
        .collect()
}

/// Accelerations at x and v.
type Force<'a> = &'a dyn Fn(&Vectors, &Vectors) -> Vectors;

/// One step from (x, v).
type Step = fn(Force, f64, &Point) -> Point;

const METHODS: [(&str, Step); 6] = [
    ("explicit_euler", |a, h, (x, v)| {
        (plus(x, h, v), plus(v, h, &a(x, v)))
    }),
    ("symplectic_euler", |a, h, (x, v)| {
        let v = plus(v, h, &a(x, v));
        (plus(x, h, &v), v)
    }),
    ("midpoint", |a, h, (x, v)| {
        let middle = (plus(x, h / 2.0, v), plus(v, h / 2.0, &a(x, v)));
        (plus(x, h, &middle.1), plus(v, h, &a(&middle.0, &middle.1)))
    }),
    ("heun", |a, h, (x, v)| {
        let first = a(x, v);
        let end = (plus(x, h, v), plus(v, h, &first));
        let second = a(&end.0, &end.1);
        let mean = |p: &Vectors, q: &Vectors| plus(&plus(&vec![[0.0; 3]; p.len()], 0.5, p), 0.5, q);
        (
            plus(x, h, &mean(v, &end.1)),
            plus(v, h, &mean(&first, &second)),
        )
    }),
    ("velocity_verlet", |a, h, (x, v)| {
        let first = a(x, v);
        let x = plus(&plus(x, h, v), h * h / 2.0, &first);
        let half = plus(v, h / 2.0, &first);
        let second = a(&x, &half);
        (x, plus(&half, h / 2.0, &second))
    }),
    ("rk4", |a, h, (x, v)| {
        let (k1, l1) = (v.clone(), a(x, v));
        let (k2, l2) = {
            let (x, v) = (plus(x, h / 2.0, &k1), plus(v, h / 2.0, &l1));
            (v.clone(), a(&x, &v))
        };
        let (k3, l3) = {
            let (x, v) = (plus(x, h / 2.0, &k2), plus(v, h / 2.0, &l2));
            (v.clone(), a(&x, &v))
        };
        let (k4, l4) = {
            let (x, v) = (plus(x, h, &k3), plus(v, h, &l3));
            (v.clone(), a(&x, &v))
        };
        let sum = |y: &Vectors, k: [&Vectors; 4]| {
            let (mut y, weights) = (y.clone(), [1.0, 2.0, 2.0, 1.0]);
            for (k, w) in k.into_iter().zip(weights) {
                y = plus(&y, w * h / 6.0, k);
            }
            y
        };
        (sum(x, [&k1, &k2, &k3, &k4]), sum(v, [&l1, &l2, &l3, &l4]))
    }),
];

/// Rows of a method from the scene's start.
fn written(scene: &Scene, coding: Coding, step: Step, steps: u64) -> Rows {
    let last = |a: Force, h: f64, all: &[Point]| step(a, h, all.last().expect("a state"));
    written_from_all(scene, coding, last, steps)
}

/// Rows of a scheme that sees all states so far.
fn written_from_all(
    scene: &Scene,
    coding: Coding,
    step: impl Fn(Force, f64, &[Point]) -> Point,
    steps: u64,
) -> Rows {
    let fixed = |v: &[f64; 3], fixed: bool| if fixed { [0.0; 3] } else { *v };
    let x: Vectors = scene.particles.iter().map(|p| p.position).collect();
    let v: Vectors = scene
        .particles
        .iter()
        .map(|p| fixed(&p.velocity, p.fixed))
        .collect();
    let mut states = vec![(x, v)];
    for _ in 0..steps {
        let a = |x: &Vectors, v: &Vectors| acceleration(scene, coding, (x, v));
        let next = step(&a, scene.solver.timestep, &states);
        states.push(next);
    }
    Rows {
        timestep: scene.solver.timestep,
        dim: 3 * scene.particles.len(),
        steps: (0..=steps).collect(),
        x: states
            .iter()
            .flat_map(|(x, _)| x.as_flattened().to_vec())
            .collect(),
        v: Some(
            states
                .iter()
                .flat_map(|(_, v)| v.as_flattened().to_vec())
                .collect(),
        ),
        precision: Precision::Double,
        precision_v: Precision::Double,
        cut: false,
    }
}

/// Named throughout, alone or among equals.
fn names(scene: &Scene, rows: &Rows, id: &str) -> Result<f64, String> {
    let identity = name_of(scene, rows, None).ok_or("no scheme")?;
    // Where there is damping, Verlet's half kicks at the velocities before them are a scheme of their own.
    let own = |name: &String| name == id || *name == format!("{id}_explicit_damping");
    let named = own(&identity.method) || identity.equivalent.iter().any(own);
    let all = identity.followed == identity.transitions && !identity.mistake;
    if named && all && identity.defect <= FIT {
        Ok(identity.defect)
    } else {
        Err(format!("{id} on {}: {identity:?}", scene.file))
    }
}

#[test]
fn textbook_methods_are_named_on_every_small_scene() {
    let mut worst = 0.0_f64;
    let scenes = all_shipped(&["pa1", "oscillator", "order", "golden"]);
    for scene in &scenes {
        let steps = if scene.particles.len() > 50 { 12 } else { 150 };
        for (id, step) in METHODS {
            for coding in [Coding::Forward, Coding::Backward] {
                let rows = written(scene, coding, step, steps);
                if rows.x.iter().all(|c| c.is_finite()) {
                    worst = worst.max(names(scene, &rows, id).unwrap());
                }
            }
        }
    }
    // What fits to 10 must not owe it to a wide bound: measured 3.3.
    assert!((0.5..=8.0).contains(&worst), "{worst}");
    // A thousandth of gravity, and it is no longer that method.
    let mut heavier = scenes[2].clone();
    heavier.solver.gravity *= 1.001;
    let rows = written(&heavier, Coding::Forward, METHODS[1].1, 150);
    assert!(names(&scenes[2], &rows, METHODS[1].0).is_err());
}

/// One step from the last of some states, given those before it.
type Remembering = fn(Force, f64, &[Point], &Point) -> Point;

/// Schemes that no method of the registry is, as people write them: their id, part of what is said of them, and a
/// step.
const OTHERS: [(&str, &str, Remembering); 17] = [
    ("midpoint_kicked", "", |a, h, _, (x, v)| {
        let half = plus(v, h / 2.0, &a(x, v));
        let middle = a(&plus(x, h / 2.0, &half), &half);
        (plus(x, h, &half), plus(v, h, &middle))
    }),
    ("leapfrog_staggered", "earlier", |a, h, before, (x, v)| {
        let share = if before.is_empty() { 0.5 } else { 1.0 };
        let v = plus(v, share * h, &a(x, v));
        (plus(x, h, &v), v)
    }),
    ("leapfrog_staggered", "later", |a, h, before, (x, v)| {
        let share = if before.is_empty() { 0.5 } else { 0.0 };
        let half = plus(v, share * h, &a(x, v));
        let x = plus(x, h, &half);
        let v = plus(&half, h, &a(&x, &half));
        (x, v)
    }),
    ("ab2", "begun with symplectic Euler", |a, h, before, now| {
        ab2(METHODS[1].1, a, h, before, now)
    }),
    ("ab2", "begun with rk4", |a, h, before, now| {
        ab2(METHODS[5].1, a, h, before, now)
    }),
    ("beeman", "from the start", |a, h, before, now| {
        beeman(|v, _, _| v.clone(), a, h, before, now)
    }),
    ("beeman", "at v0 + h a0", |a, h, before, now| {
        beeman(|v, now, _| plus(v, h, now), a, h, before, now)
    }),
    ("beeman", "predicts", |a, h, before, now| {
        let predicted = |v: &Vectors, now: &Vectors, then: &Vectors| {
            plus(&plus(v, 1.5 * h, now), -0.5 * h, then)
        };
        beeman(predicted, a, h, before, now)
    }),
    (
        "velocity_verlet_predicted_velocity",
        "",
        |a, h, _, (x, v)| {
            let first = a(x, v);
            let x = plus(&plus(x, h, v), h * h / 2.0, &first);
            let second = a(&x, &plus(v, h, &first));
            (x, plus(&plus(v, h / 2.0, &first), h / 2.0, &second))
        },
    ),
    ("velocity_verlet_old_velocity", "", |a, h, _, (x, v)| {
        let first = a(x, v);
        let x = plus(&plus(x, h, v), h * h / 2.0, &first);
        let second = a(&x, v);
        (x, plus(&plus(v, h / 2.0, &first), h / 2.0, &second))
    }),
    ("explicit_euler_accumulating", "", |a, h, before, (x, v)| {
        (plus(x, h, v), accumulated(a, h, before, (x, v)))
    }),
    (
        "symplectic_euler_stale_force",
        "",
        |a, h, before, (x, v)| {
            let (old_x, old_v) = before.last().map_or((x, v), |(x, v)| (x, v));
            let v = plus(v, h, &a(old_x, old_v));
            (plus(x, h, &v), v)
        },
    ),
    ("velocity_verlet_stale_force", "", |a, h, _, (x, v)| {
        let first = a(x, v);
        let x = plus(&plus(x, h, v), h * h / 2.0, &first);
        (x, plus(v, h, &first))
    }),
    ("velocity_verlet_new_force_only", "", |a, h, _, (x, v)| {
        let new_x = plus(&plus(x, h, v), h * h / 2.0, &a(x, v));
        let second = a(&new_x, v);
        (new_x, plus(v, h, &second))
    }),
    ("velocity_verlet_missing_half", "", |a, h, _, (x, v)| {
        let first = a(x, v);
        let x = plus(&plus(x, h, v), h * h, &first);
        let half = plus(v, h / 2.0, &first);
        let second = a(&x, &half);
        (x, plus(&half, h / 2.0, &second))
    }),
    ("implicit_euler_one_pass", "", |a, h, _, (x, v)| {
        let v1 = plus(v, h, &a(&plus(x, h, v), &plus(v, h, &a(x, v))));
        (plus(x, h, &v1), v1)
    }),
    ("rk4_stage_on_stage", "", |a, h, _, (x, v)| {
        let (mut place, mut slopes) = ((x.clone(), v.clone()), Vec::new());
        for ahead in [0.5, 0.5, 1.0, 0.0] {
            let slope = (place.1.clone(), a(&place.0, &place.1));
            place = (
                plus(&place.0, ahead * h, &slope.0),
                plus(&place.1, ahead * h, &slope.1),
            );
            slopes.push(slope);
        }
        let (mut x, mut v) = (x.clone(), v.clone());
        for ((along, gain), weight) in slopes.iter().zip([1.0, 2.0, 2.0, 1.0]) {
            x = plus(&x, weight * h / 6.0, along);
            v = plus(&v, weight * h / 6.0, gain);
        }
        (x, v)
    }),
];

fn ab2(first: Step, a: Force, h: f64, before: &[Point], now: &Point) -> Point {
    let Some((old_x, old_v)) = before.last() else {
        return first(a, h, now);
    };
    let (x, v) = now;
    let x1 = plus(&plus(x, 1.5 * h, v), -0.5 * h, old_v);
    let v1 = plus(&plus(v, 1.5 * h, &a(x, v)), -0.5 * h, &a(old_x, old_v));
    (x1, v1)
}

fn beeman(
    predict: impl Fn(&Vectors, &Vectors, &Vectors) -> Vectors,
    a: Force,
    h: f64,
    before: &[Point],
    (x, v): &Point,
) -> Point {
    let now = a(x, v);
    let then = before.last().map_or(now.clone(), |(x, v)| a(x, v));
    let x = plus(
        &plus(&plus(x, h, v), 2.0 * h * h / 3.0, &now),
        -h * h / 6.0,
        &then,
    );
    let new = a(&x, &predict(v, &now, &then));
    let v = plus(&plus(v, h / 3.0, &new), 5.0 * h / 6.0, &now);
    (x, plus(&v, -h / 6.0, &then))
}

/// v with all forces so far, and each again in every step after it.
fn accumulated(a: Force, h: f64, before: &[Point], (x, v): (&Vectors, &Vectors)) -> Vectors {
    let each = before.iter().map(|(x, v)| a(x, v));
    each.chain([a(x, v)])
        .fold(v.clone(), |v, force| plus(&v, h, &force))
}

/// Their coefficients are tables in the program, and sums of forces here.
#[test]
fn formulas_are_named_by_what_they_compute() {
    let scene = crate::testkit::everything(DampingModel::Axial);
    for (id, part, step) in OTHERS {
        let step = |a: Force, h: f64, all: &[Point]| {
            let (last, before) = all.split_last().expect("a state");
            step(a, h, before, last)
        };
        let rows = written_from_all(&scene, Coding::Forward, step, 40);
        let identity = name_of(&scene, &rows, None).expect(id);
        let says = identity.says.clone().unwrap_or_default();
        let all = identity.followed == identity.transitions;
        let named = identity.method == id && says.contains(part);
        assert!(
            named && all && identity.defect <= FIT,
            "{id} {part}: {identity:?}"
        );
    }
}

/// At z = h w = 2 the forces of a step, 400 N, cancel to velocities of 1 m/s, and their roundings may cancel as well.
#[test]
fn verlet_is_named_at_its_limit() {
    let mut scene = chain(1, 0.0, 1.0, 400.0);
    (scene.solver.timestep, scene.solver.gravity) = (0.1, 0.0);
    scene.particles[1].position = [0.5, 0.13, 0.2];
    scene.particles[1].velocity = [0.0, 1.0, 0.3];
    for coding in [Coding::Forward, Coding::Backward] {
        let rows = written(&scene, coding, METHODS[4].1, 200);
        names(&scene, &rows, METHODS[4].0).unwrap();
    }
}
