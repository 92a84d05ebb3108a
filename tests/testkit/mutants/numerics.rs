//! Sound methods but for one thing in how they compute: a step, a cap, a tolerance, a precision, a division
//! that holds in the scenes one tries first.

use super::{acceleration, add, rk4};
use springcheck::physics::{State, System};

/// Undamped.
fn verlet(system: &dyn System, h: f64, s: &mut State) {
    let a = acceleration(system, &s.x, &s.v);
    add(&mut s.v, 0.5 * h, &a);
    let v = s.v.clone();
    add(&mut s.x, h, &v);
    let a = acceleration(system, &s.x, &s.v);
    add(&mut s.v, 0.5 * h, &a);
}

/// Verlet with its step longer by two thousandths, as a rounded constant makes it.
pub fn verlet_with_a_longer_step(system: &dyn System, h: f64, s: &mut State) {
    verlet(system, 1.002 * h, s);
}

/// Verlet with its step shorter by two thousandths.
pub fn verlet_with_a_shorter_step(system: &dyn System, h: f64, s: &mut State) {
    verlet(system, 0.998 * h, s);
}

/// Verlet that leaves out every thousandth step.
pub fn verlet_skipping_steps(system: &dyn System, h: f64, s: &mut State) {
    if (s.t / h).round() as u64 % 1000 != 999 {
        verlet(system, h, s);
    }
}

/// Verlet that loses a billionth of its velocity every step.
pub fn verlet_losing_a_billionth(system: &dyn System, h: f64, s: &mut State) {
    verlet(system, h, s);
    for v in &mut s.v {
        *v *= 1.0 - 1e-9;
    }
}

/// Verlet that caps speeds at 400 m/s, on each axis.
pub fn verlet_with_a_speed_cap(system: &dyn System, h: f64, s: &mut State) {
    verlet(system, h, s);
    for v in &mut s.v {
        *v = v.clamp(-400.0, 400.0);
    }
}

/// Verlet that also needs the direction from each particle to the next, and divides by their distance
/// without looking whether there is one.
pub fn verlet_dividing_by_distances(system: &dyn System, h: f64, s: &mut State) {
    let particles: Vec<&[f64]> = s.x.chunks_exact(3).collect();
    let distance = |pair: &[&[f64]]| {
        let squares = pair[0].iter().zip(pair[1]).map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f64>().sqrt()
    };
    // A force of 0 N along d / |d|: nothing, but for 0 / 0.
    let along: f64 = particles.windows(2).map(|p| 0.0 / distance(p)).sum();
    verlet(system, h, s);
    for (v, w) in s.v.iter_mut().zip(system.inverse_mass()) {
        *v += w * along;
    }
}

/// Verlet on a line that lets nobody pass: who would be on the other side of the next is stopped.
pub fn verlet_letting_nobody_pass(system: &dyn System, h: f64, s: &mut State) {
    let before = s.x.clone();
    verlet(system, h, s);
    for i in (3..s.x.len()).step_by(3) {
        if (s.x[i] - s.x[i - 3]) * (before[i] - before[i - 3]) < 0.0 {
            s.x[i] = before[i];
            s.x[i - 3] = before[i - 3];
            (s.v[i], s.v[i - 3]) = (s.v[i - 3], s.v[i]);
        }
    }
}

/// RK4 that keeps its positions in single precision.
pub fn rk4_in_single_precision(system: &dyn System, h: f64, s: &mut State) {
    rk4(system, h, s, [1.0, 2.0, 2.0, 1.0]);
    for x in &mut s.x {
        *x = f64::from(*x as f32);
    }
}

/// Implicit midpoint, iterated until velocities move by less than 1e-9 m/s: an absolute tolerance.
pub fn midpoint_iterated_to_a_nanometre(system: &dyn System, h: f64, s: &mut State) {
    let (x0, v0) = (s.x.clone(), s.v.clone());
    let mut u = v0.clone();
    for _ in 0..100 {
        let mut x = x0.clone();
        add(&mut x, 0.5 * h, &u);
        let a = acceleration(system, &x, &u);
        let mut next = v0.clone();
        add(&mut next, 0.5 * h, &a);
        let moved = next.iter().zip(&u).map(|(a, b)| (a - b).abs());
        let moved = moved.fold(0.0, f64::max);
        if moved < 1e-9 {
            break;
        }
        u = next;
    }
    add(&mut s.x, h, &u);
    for ((v, u), v0) in s.v.iter_mut().zip(&u).zip(&v0) {
        *v = 2.0 * u - v0;
    }
}
