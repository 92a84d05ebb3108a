//! Dampers on particles that cannot move in all directions, as those that stay on a surface.

use super::{Decay, EXPONENT, Sweep};
use crate::physics::System;
use crate::space::{dot, three};

/// The directions in which particles are free.
#[derive(Debug, Default)]
pub struct Bound {
    /// Of each particle its place among the projections, or that of none.
    at: Vec<u32>,
    /// Onto what is free: the rows of a symmetric matrix.
    free: Vec<[[f64; 3]; 3]>,
}

const NONE: u32 = u32::MAX;

impl Bound {
    /// Of so many particles these are free along these orthonormal directions alone.
    pub fn new<'a>(
        particles: usize,
        bound: impl IntoIterator<Item = (usize, &'a [[f64; 3]])>,
    ) -> Self {
        let mut all = Self {
            at: vec![NONE; particles],
            free: Vec::new(),
        };
        for (particle, along) in bound {
            all.at[particle] = u32::try_from(all.free.len()).unwrap_or(NONE);
            let mut free = [[0.0; 3]; 3];
            for d in along {
                for (row, di) in free.iter_mut().zip(d) {
                    for (entry, dj) in row.iter_mut().zip(d) {
                        *entry += di * dj;
                    }
                }
            }
            all.free.push(free);
        }
        all
    }

    fn has(&self, particle: usize) -> bool {
        self.at[particle] != NONE
    }

    /// The part of a vector at a particle that is free.
    #[inline(always)]
    fn part(&self, particle: usize, d: [f64; 3]) -> [f64; 3] {
        let at = self.at[particle] as usize;
        self.free
            .get(at)
            .map_or(d, |[a, b, c]| [dot(*a, d), dot(*b, d), dot(*c, d)])
    }
}

impl<'a> Sweep<'a> {
    /// Sweeps over a system in other axes, with the particles at positions `x`, m, and bound there: turns velocities into
    /// these axes, and back.
    pub fn seen(
        &mut self,
        system: &dyn System,
        x: &[f64],
        bound: &Bound,
        (out, back): (impl Fn(&mut [f64]), impl Fn(&mut [f64])),
    ) {
        out(self.v);
        let mut there = Sweep {
            backward: self.backward,
            midpoint: self.midpoint,
            scale: self.scale,
            bound: Some(bound),
            dissipated: self.dissipated,
            ..Sweep::new(system, x, self.v, self.h)
        };
        system.sweep(&mut there);
        self.dissipated = there.dissipated;
        back(self.v);
    }

    /// The bound directions, if one of the particles with these places has some.
    pub(super) fn bound(&self, places: &[usize]) -> Option<&'a Bound> {
        self.bound
            .filter(|bound| places.iter().any(|at| bound.has(at / 3)))
    }

    /// The axes of space, one after the other as the sweep goes.
    pub(super) fn axes(&self) -> [[f64; 3]; 3] {
        let order = if self.backward { [2, 1, 0] } else { [0, 1, 2] };
        order.map(|axis| [0, 1, 2].map(|c| if c == axis { 1.0 } else { 0.0 }))
    }

    /// Drag b on the free part of the velocity at this place.
    pub(super) fn slow(&mut self, bound: &Bound, b: f64, at: usize) {
        if !self.relaxes(b, self.inverse_mass[at]) {
            return;
        }
        let free = bound.part(at / 3, three(self.v, at / 3));
        let Decay { lost, kept, .. } = self.decay;
        self.dissipated += 0.5 * lost * (1.0 + kept) * dot(free, free);
        for (v, free) in self.v[at..at + 3].iter_mut().zip(free) {
            *v -= (1.0 - kept) * free;
        }
    }

    /// A damper c on the rate at which velocities change a number, by its gradients at particles with these places: as
    /// between two ends, with of each gradient the part that is free for the response.
    #[inline]
    pub(super) fn rate<const N: usize>(
        &mut self,
        bound: &Bound,
        c: f64,
        gradients: [(usize, [f64; 3]); N],
    ) {
        let inverse_mass = self.inverse_mass;
        // Loops, since closures in arrays are not always inlined here, where most of the time goes.
        let (mut reach, mut w, mut u) = ([[0.0; 3]; N], 0.0, 0.0);
        for (&(at, g), reach) in gradients.iter().zip(&mut reach) {
            let [x, y, z] = bound.part(at / 3, g);
            let inverse = inverse_mass[at];
            *reach = [inverse * x, inverse * y, inverse * z];
            w += dot(g, *reach);
            u += dot(g, three(self.v, at / 3));
        }
        // Directions differ from damper to damper, and so does the rate: no decay is kept for the next.
        let z = (-c * self.scale * w * self.h).min(EXPONENT);
        if z == 0.0 {
            return;
        }
        let gone = if self.midpoint {
            -z / (1.0 - 0.5 * z)
        } else {
            -less_one(z)
        };
        let change = -gone * u / w;
        self.dissipated -= 0.5 * change * u * (2.0 - gone);
        for ((at, _), reach) in gradients.iter().zip(reach) {
            for axis in 0..3 {
                self.v[at + axis] += change * reach[axis];
            }
        }
    }
}

/// e^z - 1; near 0 by its series, which is as good to rounding and costs a fifth or less.
#[inline(always)]
fn less_one(z: f64) -> f64 {
    /// 1/2! to 1/15!: beyond them are 1e-17 of the sum at the border, and beyond the first seven at the border of these.
    const TERMS: [f64; 14] = terms();
    const NEAR: f64 = 0.5;
    const VERY_NEAR: f64 = 0.03;
    let series = |terms: &[f64]| {
        let mut sum = 0.0;
        for term in terms.iter().rev() {
            sum = sum * z + term;
        }
        z + z * z * sum
    };
    match z.abs() {
        size if size <= VERY_NEAR => series(&TERMS[..7]),
        size if size <= NEAR => series(&TERMS),
        _ => z.exp_m1(),
    }
}

const fn terms() -> [f64; 14] {
    let (mut terms, mut term, mut at) = ([0.0; 14], 1.0, 0);
    while at < terms.len() {
        term /= (at + 2) as f64;
        terms[at] = term;
        at += 1;
    }
    terms
}
