//! The cache's key depends on everything that decides the motion, and on nothing else.

use crate::testkit::all_effects;
use springcheck::scene::{Axis, DampingModel, Plot, Scene, Vectors};
use springcheck::truth::converged::key;

/// What a key forgets: a field is set back to the original's.
type Forget = fn(&mut Scene, &Scene);

/// A change of one field.
type Change = fn(&mut Scene);

/// Every field that decides the motion.
const DECIDES: &[(&str, Change)] = &[
    ("gravity", |s| s.solver.gravity = -9.8),
    ("gravity as a vector", |s| {
        s.solver.gravities = Vectors(vec![[0.0, 0.0, -9.8]]);
    }),
    ("quadratic drag", |s| s.particles[2].quadratic_drag = 0.1),
    ("corner", |s| s.triangles[0].corners = [1, 3, 2]),
    ("air drag", |s| s.triangles[0].air_drag = 0.9),
    ("velocity of the air", |s| {
        s.air.iter_mut().for_each(|air| air.velocity[0] = 0.7)
    }),
    ("density of the air", |s| {
        s.air.iter_mut().for_each(|air| air.density = 1.3)
    }),
    ("no air", |s| s.air = None),
    ("a triangle less", |s| s.triangles.truncate(1)),
    ("up", |s| s.up = Axis::Y),
    ("damping_model", |s| {
        s.damping_model = DampingModel::Isotropic
    }),
    ("position", |s| s.particles[1].position[2] += 1e-15),
    ("velocity", |s| s.particles[1].velocity[0] += 1e-15),
    ("fixed", |s| s.particles[2].fixed = true),
    ("mass", |s| s.particles[2].mass *= 2.0),
    ("drag", |s| s.particles[2].drag = 0.1),
    ("spring end", |s| s.springs[0].ends = [0, 2]),
    ("spring ends swapped", |s| s.springs[0].ends = [1, 0]),
    ("stiffness", |s| s.springs[1].stiffness += 1.0),
    ("cubic", |s| s.springs[1].cubic += 1.0),
    ("damping", |s| s.springs[1].damping += 0.1),
    ("rest_length", |s| s.springs[1].rest_length += 0.1),
    ("hinge", |s| s.bending[0].particles = [0, 2, 1]),
    ("bending stiffness", |s| s.bending[0].stiffness += 1.0),
    ("rest angle", |s| s.bending[0].rest_angle += 0.1),
    ("bending damping", |s| s.bending[0].damping += 0.1),
    ("a hinge less", |s| s.bending.truncate(1)),
    ("gravitational end", |s| s.gravitational[0].ends = [0, 1]),
    ("G", |s| s.gravitational[0].g = 1.0),
    ("wind direction", |s| {
        if let Some(wind) = &mut s.wind {
            wind.direction = [1.0, 0.0, 0.0];
        }
    }),
    ("wind strength", |s| {
        if let Some(wind) = &mut s.wind {
            wind.strength = 1.0;
        }
    }),
    ("no wind", |s| s.wind = None),
    ("charge", |s| s.particles[1].charge += 0.1),
    ("field", |s| {
        if let Some(magnetic) = &mut s.magnetic {
            magnetic.field[1] += 0.1;
        }
    }),
    ("no field", |s| s.magnetic = None),
    ("a particle less", |s| {
        s.particles.truncate(s.particles.len() - 1)
    }),
    ("a spring less", |s| s.springs.truncate(s.springs.len() - 1)),
    ("a pair less", |s| {
        s.gravitational.truncate(s.gravitational.len() - 1)
    }),
];

/// Every field that does not.
const DOES_NOT: &[(&str, Change)] = &[
    ("name", |s| s.name.push('!')),
    ("description", |s| s.description = Some("other".into())),
    ("file", |s| s.file = "other.yml".into()),
    ("method", |s| s.solver.method = "midpoint".into()),
    ("timestep", |s| s.solver.timestep /= 2.0),
    ("tolerance", |s| s.solver.tolerance = Some(1e-6)),
    ("duration", |s| s.duration *= 2.0),
    ("plot", |s| {
        s.plot = Some(Plot {
            particle: 1,
            dof: 2,
            y_range: None,
        });
    }),
    ("radius", |s| s.particles[1].radius *= 2.0),
];

/// All keys of the first table differ from the original's and from each other; those of the second
/// are the original's.
fn key_law(key: impl Fn(&Scene) -> String) -> Result<(), String> {
    let scene = all_effects(DampingModel::Axial);
    let changed = |change: &Change| {
        let mut scene = scene.clone();
        change(&mut scene);
        key(&scene)
    };
    let mut seen = vec![key(&scene)];
    for (field, change) in DECIDES {
        let key = changed(change);
        if seen.contains(&key) {
            return Err(format!("{field} is forgotten"));
        }
        seen.push(key);
    }
    for (field, change) in DOES_NOT {
        if changed(change) != seen[0] {
            return Err(format!("{field} does not matter"));
        }
    }
    Ok(())
}

#[test]
fn the_key_is_of_what_decides_the_motion() {
    key_law(|scene| key(scene, 5.0)).unwrap();
    let scene = all_effects(DampingModel::Axial);
    assert_ne!(key(&scene, 5.0), key(&scene, 5.0 + 1e-15));
    let digits = key(&scene, 5.0);
    assert_eq!(digits.len(), 64);
    assert!(digits.chars().all(|c| matches!(c, '0'..='9' | 'a'..='f')));
}

#[test]
fn a_key_that_forgets_any_field_is_found_out() {
    // Whatever a field is set back to before hashing no longer counts.
    let original = all_effects(DampingModel::Axial);
    let forgetful: &[(&str, Forget)] = &[
        ("gravity", |s, o| s.solver.gravity = o.solver.gravity),
        ("up", |s, o| s.up = o.up),
        ("damping_model", |s, o| s.damping_model = o.damping_model),
        ("wind", |s, o| s.wind.clone_from(&o.wind)),
        ("rest angle", |s, _| {
            s.bending.iter_mut().for_each(|h| h.rest_angle = 0.0)
        }),
        ("field", |s, o| s.magnetic.clone_from(&o.magnetic)),
        ("charge", |s, _| {
            s.particles.iter_mut().for_each(|p| p.charge = 0.0)
        }),
        ("drag", |s, _| {
            s.particles.iter_mut().for_each(|p| p.drag = 0.0)
        }),
        ("mass", |s, _| {
            s.particles.iter_mut().for_each(|p| p.mass = 1.0)
        }),
        ("fixed", |s, _| {
            s.particles.iter_mut().for_each(|p| p.fixed = false)
        }),
        ("rest_length", |s, _| {
            s.springs.iter_mut().for_each(|p| p.rest_length = 1.0)
        }),
        ("cubic", |s, _| {
            s.springs.iter_mut().for_each(|p| p.cubic = 0.0)
        }),
        ("damping", |s, _| {
            s.springs.iter_mut().for_each(|p| p.damping = 0.0)
        }),
        ("G", |s, _| {
            s.gravitational.iter_mut().for_each(|p| p.g = 0.0)
        }),
    ];
    for (field, forget) in forgetful {
        let found = key_law(|scene| {
            let mut scene = scene.clone();
            forget(&mut scene, &original);
            key(&scene, 5.0)
        });
        assert!(found.is_err(), "{field}");
    }
    // And one that counts a name.
    key_law(|scene| key(scene, 5.0) + &scene.name).unwrap_err();
}
