//! Textbook methods in codings that share nothing with the program's own: named on every scene of the course and
//! of the small folders, whatever their order of operations.

use super::*;
use crate::testkit::scenes::all_shipped;
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

/// Accelerations of springs, dampers, gravity, drag, wind and attraction.
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

/// One step from (x, v).
type Step = fn(&dyn Fn(&Vectors, &Vectors) -> Vectors, f64, &Point) -> Point;

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
        let next = step(&a, scene.solver.timestep, states.last().expect("a state"));
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
