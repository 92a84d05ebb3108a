//! Symplectic Euler and Verlet, sound but for one thing: physics that the scene does not have, or some
//! that it has and they do not.

use super::add;
use springcheck::physics::{Power, State, System};

/// Accelerations, and the powers to book.
fn forces(system: &dyn System, s: &State) -> (Vec<f64>, Power) {
    let mut a = vec![0.0; s.x.len()];
    let power = system.acceleration(s.t, &s.x, &s.v, &mut a);
    (a, power)
}

/// Kick and drift, with accelerations as `bend` leaves them.
fn euler(system: &dyn System, h: f64, s: &mut State, bend: impl Fn(&State, &mut [f64])) {
    let (mut a, power) = forces(system, s);
    bend(s, &mut a);
    s.work.advance(power, h);
    add(&mut s.v, h, &a);
    let v = s.v.clone();
    add(&mut s.x, h, &v);
}

/// Half a kick, a drift, half a kick; dampers explicitly.
fn verlet(system: &dyn System, h: f64, s: &mut State) {
    let half_a_kick = |s: &mut State| {
        let (a, power) = forces(system, s);
        s.work.advance(power, 0.5 * h);
        add(&mut s.v, 0.5 * h, &a);
    };
    half_a_kick(s);
    let v = s.v.clone();
    add(&mut s.x, h, &v);
    half_a_kick(s);
}

/// No mutant: what the others are without their fault.
pub fn symplectic_euler(system: &dyn System, h: f64, s: &mut State) {
    euler(system, h, s, |_, _| ());
}

/// Everything free falls, whatever the scene says.
pub fn euler_with_a_gravity_of_its_own(system: &dyn System, h: f64, s: &mut State) {
    euler(system, h, s, |_, a| {
        for (a, w) in a.iter_mut().zip(system.inverse_mass()).skip(2).step_by(3) {
            if *w > 0.0 {
                *a -= 9.81;
            }
        }
    });
}

/// A billionth of all velocity goes at every step, as in programs that fear explosions.
pub fn verlet_with_a_damping_of_its_own(system: &dyn System, h: f64, s: &mut State) {
    verlet(system, h, s);
    for v in &mut s.v {
        *v *= 1.0 - 1e-9;
    }
}

/// Velocities are what positions moved by, and as rounded as these.
pub fn verlet_with_velocities_from_positions(system: &dyn System, h: f64, s: &mut State) {
    let before = s.x.clone();
    verlet(system, h, s);
    for ((v, x), before) in s.v.iter_mut().zip(&s.x).zip(before) {
        *v = (x - before) / h;
    }
}

/// Nothing is faster than 400 m/s, as in rapier unless told otherwise.
pub fn verlet_capped_at_400(system: &dyn System, h: f64, s: &mut State) {
    verlet(system, h, s);
    for v in s.v.chunks_exact_mut(3) {
        let speed = v.iter().map(|v| v * v).sum::<f64>().sqrt();
        v.iter_mut()
            .for_each(|v| *v *= f64::min(1.0, 400.0 / speed));
    }
}

/// The unit vector from the first of two particles to the second.
fn along(s: &State) -> [f64; 3] {
    let d = [0, 1, 2].map(|c| s.x[3 + c] - s.x[c]);
    let length = d.iter().map(|d| d * d).sum::<f64>().sqrt();
    d.map(|d| d / length)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Replaces the accelerations of a pair's damper by what `turn` makes of that of the second particle,
/// handed over with the direction along the pair and the relative velocity.
fn with_damper(
    system: &dyn System,
    s: &State,
    a: &mut [f64],
    turn: impl Fn([f64; 3], [f64; 3], [f64; 3]) -> [f64; 3],
) {
    let mut damper = vec![0.0; s.x.len()];
    system.damping(s.t, &s.x, &s.v, &mut damper);
    let second = [3, 4, 5].map(|i| damper[i]);
    let rate = [0, 1, 2].map(|c| s.v[3 + c] - s.v[c]);
    let turned = turn(second, along(s), rate);
    for c in 0..3 {
        let change = turned[c] - second[c];
        // Of equal masses.
        a[3 + c] += change;
        a[c] -= change;
    }
}

/// The axial damper of a pair taken for an isotropic one.
pub fn euler_damping_all_relative_motion(system: &dyn System, h: f64, s: &mut State) {
    euler(system, h, s, |s, a| {
        with_damper(system, s, a, |damper, n, rate| {
            let closing = dot(&rate, &n);
            // Without any the coefficient cannot be told.
            if closing.abs() < 1e-9 {
                return damper;
            }
            let coefficient = dot(&damper, &n) / closing;
            rate.map(|v| coefficient * v)
        });
    });
}

/// The isotropic damper of a pair taken for an axial one.
pub fn euler_damping_along_the_pair(system: &dyn System, h: f64, s: &mut State) {
    euler(system, h, s, |s, a| {
        with_damper(system, s, a, |damper, n, _| {
            let share = dot(&damper, &n);
            n.map(|n| share * n)
        });
    });
}

/// What acts on the last particle is forgotten: action without reaction.
pub fn euler_without_the_last_reaction(system: &dyn System, h: f64, s: &mut State) {
    euler(system, h, s, |_, a| {
        let last = a.len() - 3;
        a[last..].fill(0.0);
    });
}

/// What is fixed creeps, by a millimetre a second.
pub fn verlet_with_creeping_anchors(system: &dyn System, h: f64, s: &mut State) {
    verlet(system, h, s);
    for (x, w) in s.x.iter_mut().zip(system.inverse_mass()).skip(2).step_by(3) {
        if *w == 0.0 {
            *x -= 1e-3 * h;
        }
    }
}

/// The last step is as short as it takes to end at 1 s.
pub fn verlet_squeezing_its_last_step(system: &dyn System, h: f64, s: &mut State) {
    let left = f64::max(0.0, 1.0 - s.t);
    verlet(system, h.min(left), s);
}

/// Drag may stop, but not reverse, says a well-meant line.
pub fn euler_stopping_instead_of_turning_round(system: &dyn System, h: f64, s: &mut State) {
    let before = s.v.clone();
    let drift = |s: &mut State| add(&mut s.x, h, &before);
    drift(s);
    let (a, power) = forces(system, s);
    s.work.advance(power, h);
    add(&mut s.v, h, &a);
    for (v, before) in s.v.iter_mut().zip(&before) {
        if *v * before < 0.0 {
            *v = 0.0;
        }
    }
}

/// Two steps where one was asked for.
pub fn verlet_at_half_the_step(system: &dyn System, h: f64, s: &mut State) {
    verlet(system, 0.5 * h, s);
    verlet(system, 0.5 * h, s);
}
