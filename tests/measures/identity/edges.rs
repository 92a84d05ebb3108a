//! Data there is nothing to say of, and data that is no data.

use super::*;
use crate::testkit::swinging_triangle;
use springcheck::scene::DampingModel;

fn scene() -> Scene {
    swinging_triangle(0.7, DampingModel::Axial)
}

fn cut(rows: &Rows, n: usize) -> Rows {
    Rows {
        steps: rows.steps[..n].to_vec(),
        x: rows.x[..n * rows.dim].to_vec(),
        v: rows.v.as_ref().map(|v| v[..n * rows.dim].to_vec()),
        ..rows.clone()
    }
}

#[test]
fn too_few_rows_are_no_answer() {
    let rows = run(&scene(), "rk4", 1, 4);
    let positions = Rows {
        v: None,
        ..rows.clone()
    };
    for n in 0..=4 {
        let answered = name_of(&scene(), &cut(&rows, n), None).is_some();
        assert_eq!(answered, n >= 2, "{n} rows");
        let answered = name_of(&scene(), &cut(&positions, n), None).is_some();
        assert_eq!(answered, n >= 3, "{n} rows of positions");
    }
    assert!(name_of(&scene(), &rows, Some(0)).is_none());
}

#[test]
fn rows_of_another_shape_are_no_answer() {
    let rows = run(&scene(), "rk4", 1, 4);
    let mut fewer = scene();
    fewer.particles.pop();
    fewer.springs.truncate(2);
    assert!(name_of(&fewer, &rows, None).is_none());
    let mut short = rows.clone();
    short.x.pop();
    assert!(name_of(&scene(), &short, None).is_none());
    let mut unordered = rows;
    unordered.steps.swap(1, 2);
    assert!(name_of(&scene(), &unordered, None).is_none());
}

#[test]
fn nothing_panics() {
    let rows = run(&scene(), "rk4", 1, 12);
    // All fixed, and nothing at all.
    let mut fixed = scene();
    fixed.particles.iter_mut().for_each(|p| p.fixed = true);
    name_of(&fixed, &rows, None);
    let mut nothing = scene();
    nothing.particles.clear();
    nothing.springs.clear();
    let empty = Rows {
        dim: 0,
        x: Vec::new(),
        v: Some(Vec::new()),
        ..rows.clone()
    };
    name_of(&nothing, &empty, None);
    // Steps of a year, of nothing, and of no number.
    for timestep in [3e7, 0.0, 1e-300, 1e300, f64::NAN, f64::INFINITY] {
        for v in [rows.v.clone(), None] {
            let odd = Rows {
                timestep,
                v,
                ..rows.clone()
            };
            if let Some(identity) = name_of(&scene(), &odd, None) {
                assert!(!identity.decisive, "{timestep}: {identity:?}");
                assert!(identity.defect.is_finite());
            }
        }
    }
    // States that are not finite are left out; huge ones are met as they are.
    for wrong in [f64::NAN, f64::INFINITY, 1e300, f64::MAX] {
        let mut odd = rows.clone();
        odd.x[5 * rows.dim + 4] = wrong;
        let identity = name(&scene(), &odd);
        assert_eq!(identity.method, "rk4", "{wrong}: {identity:?}");
        let lost = identity.transitions - identity.followed;
        assert_eq!(lost, if wrong.is_finite() { 2 } else { 0 });
    }
    // All the same huge number.
    let mut odd = rows.clone();
    odd.x.fill(f64::MAX);
    name_of(&scene(), &odd, None);
    // At rest, for ever.
    let mut rest = scene();
    rest.solver.gravity = 0.0;
    rest.springs.clear();
    rest.particles
        .iter_mut()
        .for_each(|p| p.velocity = [0.0; 3]);
    let identity = name(&rest, &run(&rest, "rk4", 1, 10));
    assert!(!identity.decisive, "{identity:?}");
}
