//! What rounding does to rods: a program that sums and solves in another order is off by so much.

use super::Rods;
use crate::scene::Drive;
use crate::space::{dot, minus, three};

/// Signs of a residual under which the solve is tried, by rod. The first leads to the bound itself where the inverse has
/// no negative entries, as of a chain whose links all turn less than a right angle.
const SIGNS: [fn(usize) -> f64; 4] = [
    |_| 1.0,
    |rod| if rod % 2 == 0 { 1.0 } else { -1.0 },
    |rod| if rod / 2 % 2 == 0 { 1.0 } else { -1.0 },
    |rod| if (rod * rod / 3) % 2 == 0 { 1.0 } else { -1.0 },
];

impl Rods {
    /// *Adds* to `off`, a bound of the rounding of accelerations `a` without rods, m/s², what the solve makes of it and of
    /// its own rounding. Nothing where tensions are not determined.
    ///
    /// The solve is backward stable (Higham, Accuracy and Stability of Numerical Algorithms, 10.1), so the residual is the
    /// rounding of |G| |a| + |G| W |Gᵀ| |T|, and the tensions are off by what it becomes in the solve.
    pub(crate) fn add_rounding(
        &self,
        t: f64,
        x: &[f64],
        v: &[f64],
        (a, drives): (&[f64], &[Drive]),
        off: &mut [f64],
    ) {
        const EPS: f64 = 4.0 * f64::EPSILON;
        let Ok(mut at) = self.at(x) else { return };
        let mut tensions = self.pulls(&at, t, v, a, drives);
        at.solve(&mut tensions);
        // W |Gᵀ| |T|, and with it what each number of the right-hand side is known to.
        let mut known: Vec<f64> = (off.iter().zip(a))
            .map(|(off, a)| off + EPS * a.abs())
            .collect();
        self.add_magnitudes(&at.directions, &tensions, EPS, &mut known);
        let each = self.ends().iter().enumerate();
        let residual = each.map(|(rod, [i, j])| {
            let (n, l) = (at.directions[rod].map(f64::abs), at.lengths[rod]);
            let of = |y: &[f64]| dot(n, three(y, *i)) + dot(n, three(y, *j));
            let u = minus(three(v, *j), three(v, *i));
            let speeds = [*i, *j].map(|end| dot(three(v, end), three(v, end)).sqrt());
            let apart = dot(u, u).sqrt();
            let speed = speeds[0] + speeds[1];
            let turning = EPS * apart * (apart + speed) / l;
            of(&known) + turning + EPS * self.rate() * (speed + self.rate() * l)
        });
        let residual: Vec<f64> = residual.collect();
        let mut worst = vec![0.0_f64; residual.len()];
        for sign in SIGNS {
            let signed = residual.iter().enumerate();
            let mut moved: Vec<f64> = signed.map(|(rod, r)| sign(rod) * r).collect();
            at.solve(&mut moved);
            for (worst, moved) in worst.iter_mut().zip(&moved) {
                *worst = worst.max(moved.abs());
            }
        }
        for (worst, tension) in worst.iter_mut().zip(&tensions) {
            *worst += EPS * tension.abs();
        }
        self.add_magnitudes(&at.directions, &worst, 1.0, off);
    }

    /// Adds `factor` W |Gᵀ| |pulls|.
    fn add_magnitudes(&self, directions: &[[f64; 3]], pulls: &[f64], factor: f64, y: &mut [f64]) {
        let each = self.ends().iter().zip(pulls).zip(directions);
        for ((ends, pull), n) in each {
            for end in ends {
                for axis in 0..3 {
                    y[3 * end + axis] += factor * self.weights[*end] * (pull * n[axis]).abs();
                }
            }
        }
    }

    /// Moves positions and velocities along rods by a few of their roundings, each rod by its sign: a program that stops
    /// a projection elsewhere leaves so much.
    pub(crate) fn blur(&self, x: &mut [f64], v: &mut [f64], sign: impl Fn(usize) -> f64) {
        let Ok(at) = self.at(x) else { return };
        let parts = |y: &[f64], least: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let each = self.ends().iter().enumerate();
            each.map(|(rod, [i, j])| {
                let all = [*i, *j].into_iter().flat_map(|end| three(y, end));
                let largest = all.fold(least(rod), |most: f64, c| most.max(c.abs()));
                let part = self.weights[*i] + self.weights[*j];
                sign(rod) * 2.0 * f64::EPSILON * largest / part
            })
            .collect()
        };
        let [moved, kicked] = [parts(x, &|rod| self.lengths[rod]), parts(v, &|_| 0.0)];
        at.apply(&moved, x);
        at.apply(&kicked, v);
    }
}
