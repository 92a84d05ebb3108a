//! The force as anybody would write it, and as it is written wrongly.

use springcheck::scene::{DampingModel, Scene};

/// What a kernel that works in blocks can get wrong.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fault {
    None,
    /// What does not fill a block of 16 is forgotten.
    DropsRemainder,
    /// The second end is pushed where it should be pulled.
    WrongSign,
    /// The last spring of each block has the length of the one before it.
    StaleLane,
    /// Forces are summed in the order that suits the loop.
    SumsBackwards,
    /// A spring between two threads' particles is left to the other one.
    ForgetsCrossing,
}

pub const FAULTS: [Fault; 5] = [
    Fault::DropsRemainder,
    Fault::WrongSign,
    Fault::StaleLane,
    Fault::SumsBackwards,
    Fault::ForgetsCrossing,
];

const BLOCK: usize = 16;

/// Adds the springs' forces to `f`, spring after spring; returns the dissipated power. Without
/// `elastic` those of the dampers alone.
pub fn add(scene: &Scene, x: &[f64], v: &[f64], f: &mut [f64], elastic: bool, fault: Fault) -> f64 {
    let mut numbers: Vec<_> = (0..scene.springs.len()).collect();
    match fault {
        Fault::SumsBackwards => numbers.reverse(),
        Fault::DropsRemainder => numbers.truncate(numbers.len() / BLOCK * BLOCK),
        Fault::ForgetsCrossing => {
            let half = scene.particles.len() / 2;
            numbers.retain(|&s| {
                let [i, j] = scene.springs[s].ends;
                (i < half) == (j < half)
            });
        }
        _ => {}
    }
    let undamped = scene.springs.iter().all(|s| s.damping == 0.0);
    if undamped && !elastic {
        return 0.0;
    }
    let mut dissipated = 0.0;
    for s in numbers {
        let spring = &scene.springs[s];
        let from = |of: &[f64], spring: usize| {
            let [i, j] = scene.springs[spring].ends.map(|end| 3 * end);
            [of[j] - of[i], of[j + 1] - of[i + 1], of[j + 2] - of[i + 2]]
        };
        let (d, dv) = (from(x, s), from(v, s));
        let stale = fault == Fault::StaleLane && s % BLOCK == BLOCK - 1;
        let measured = if stale { from(x, s - 1) } else { d };
        let length = dot(measured, measured).sqrt().max(1e-150);
        let pull = if elastic {
            spring.stiffness * (length - spring.rest_length)
        } else {
            0.0
        };
        let force: [f64; 3] = if undamped {
            d.map(|d| pull / length * d)
        } else if scene.damping_model == DampingModel::Axial {
            let inverse = 1.0 / length;
            let rate = dot(dv, d) * inverse;
            let resistance = spring.damping * rate;
            dissipated += resistance * rate;
            d.map(|d| (pull + resistance) * inverse * d)
        } else {
            dissipated += spring.damping * dot(dv, dv);
            let resistance = dv.map(|dv| spring.damping * dv);
            let axis = |a: usize| pull / length * d[a] + resistance[a];
            if elastic {
                [axis(0), axis(1), axis(2)]
            } else {
                resistance
            }
        };
        let [i, j] = spring.ends.map(|end| 3 * end);
        let sign = if fault == Fault::WrongSign { -1.0 } else { 1.0 };
        for a in 0..3 {
            f[i + a] += force[a];
            f[j + a] -= sign * force[a];
        }
    }
    dissipated
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
