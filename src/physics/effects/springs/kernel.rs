//! The force loop. It gathers, computes and scatters springs in blocks, and distributes the parts of a
//! network over threads.
//!
//! It uses only sums, products, quotients and roots, each rounded once and in a fixed order, so scalar and
//! vector instructions of any width give the same bits.

use super::network::{Part, Table};
use super::{AXIAL, ISOTROPIC, NONE, SHORTEST};
use crate::physics::effects::dot;
use pulp::{Arch, Simd, WithSimd};

/// Springs in a block: enough for the compiler to use vector instructions, few enough to stay in the
/// nearest cache.
const BLOCK: usize = 16;

/// A flat vector of length 3n, particle by particle.
type Vectors = [[f64; 3]];

/// The positions and velocities at which forces are evaluated.
#[derive(Clone, Copy)]
pub(super) struct Motion<'a> {
    /// Positions, m.
    x: &'a Vectors,
    /// Velocities, m/s.
    v: &'a Vectors,
}

impl<'a> Motion<'a> {
    /// From flat vectors of length 3n.
    pub fn new(x: &'a [f64], v: &'a [f64]) -> Self {
        Self {
            x: x.as_chunks().0,
            v: v.as_chunks().0,
        }
    }
}

/// Adds all forces, N, to `f` of length 3n; returns the dissipated power, W. Without `ELASTIC` it adds the
/// forces of the dampers alone.
///
/// Free threads take the parts. Each part adds to its own particles, and the powers are summed along the
/// same tree for any number of threads.
#[inline(always)]
pub(super) fn add<const MODEL: u8, const ELASTIC: bool>(
    arch: Arch,
    parts: &[Part],
    at: Motion,
    f: &mut [f64],
) -> f64 {
    let f = f.as_chunks_mut().0;
    if let [part] = parts {
        return add_part::<MODEL, ELASTIC>(arch, &part.table, at, f, 0);
    }
    add_parts::<MODEL, ELASTIC>(arch, parts, at, f, rayon::current_num_threads() > 1)
}

/// Adds the forces of several parts; `f` begins with the first part's first particle.
fn add_parts<const MODEL: u8, const ELASTIC: bool>(
    arch: Arch,
    parts: &[Part],
    at: Motion,
    f: &mut Vectors,
    parallel: bool,
) -> f64 {
    let start = |parts: &[Part]| parts.first().map_or(0, |part| part.particles.start);
    let (left, right) = match parts {
        [] => return 0.0,
        [part] => return add_part::<MODEL, ELASTIC>(arch, &part.table, at, f, start(parts)),
        parts => parts.split_at(parts.len() / 2),
    };
    let (own, others) = f.split_at_mut(start(right) - start(left));
    let mut left = || add_parts::<MODEL, ELASTIC>(arch, left, at, own, parallel);
    let mut right = || add_parts::<MODEL, ELASTIC>(arch, right, at, others, parallel);
    let (left, right) = if parallel {
        rayon::join(left, right)
    } else {
        (left(), right())
    };
    left + right
}

/// Adds the springs' forces, N, to those ends that lie in `f`, which begins with particle `first`. Without
/// `ELASTIC` it adds the forces of the dampers alone.
///
/// Returns the power dissipated, W, by springs whose first end lies in `f`.
#[inline(always)]
fn add_part<const MODEL: u8, const ELASTIC: bool>(
    arch: Arch,
    springs: &Table,
    at: Motion,
    f: &mut Vectors,
    first: usize,
) -> f64 {
    if springs.ends.len() < BLOCK {
        return few::<MODEL, ELASTIC>(springs, at, f, first);
    }
    many::<MODEL, ELASTIC>(arch, springs, at, f, first)
}

/// Computes the springs one after the other, with the operations of [`blocks`].
///
/// Each axis is stored to one end and then to the other, which keeps the compiler from loading two
/// coordinates in one instruction: a load that spans two recent stores has to wait for them.
#[inline(always)]
fn few<const MODEL: u8, const ELASTIC: bool>(
    springs: &Table,
    at: Motion,
    f: &mut Vectors,
    first: usize,
) -> f64 {
    let mut dissipated = 0.0;
    let f = f.as_flattened_mut();
    let elastic = springs.ends.iter().zip(&springs.stiffness);
    for (s, ((&ends, &k), &l)) in elastic.zip(&springs.rest_length).enumerate() {
        let c = if MODEL == NONE {
            0.0
        } else {
            springs.damping[s]
        };
        let between = apart(at.x, ends);
        let relative = if MODEL == NONE {
            [0.0; 3]
        } else {
            apart(at.v, ends)
        };
        let pair = Pair {
            between,
            closing: dot(relative, between),
            relative,
        };
        let (force, loss) = one::<MODEL, ELASTIC>(pair, [k, l, c]);
        let [i, j] = ends.map(|end| (end as usize).wrapping_sub(first).wrapping_mul(3));
        for axis in 0..3 {
            if let Some(f) = f.get_mut(i.wrapping_add(axis)) {
                *f += force[axis];
            }
            if let Some(f) = f.get_mut(j.wrapping_add(axis)) {
                *f -= force[axis];
            }
        }
        if i < f.len() {
            dissipated += loss;
        }
    }
    dissipated
}

/// Computes the springs in blocks. It is kept out of line, so that a few springs need no large stack frame.
#[inline(never)]
fn many<const MODEL: u8, const ELASTIC: bool>(
    arch: Arch,
    springs: &Table,
    at: Motion,
    f: &mut Vectors,
    first: usize,
) -> f64 {
    arch.dispatch(Forces::<MODEL, ELASTIC> {
        springs,
        at,
        f,
        first,
    })
}

/// The loop that is compiled once for each set of vector instructions. (A closure would not do: its body
/// may become a separate function, compiled for the baseline machine.)
struct Forces<'a, const MODEL: u8, const ELASTIC: bool> {
    springs: &'a Table,
    at: Motion<'a>,
    f: &'a mut Vectors,
    first: usize,
}

impl<const MODEL: u8, const ELASTIC: bool> WithSimd for Forces<'_, MODEL, ELASTIC> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        let (springs, at, f, first) = (self.springs, self.at, self.f, self.first);
        let whole = springs.ends.len() / BLOCK * BLOCK;
        let dissipated = blocks::<BLOCK, MODEL, ELASTIC>(springs, 0, at, f, first, 0.0);
        blocks::<1, MODEL, ELASTIC>(springs, whole, at, f, first, dissipated)
    }
}

/// The elastic energy, J, of the springs whose first end is one of the part's particles.
pub(super) fn energy(arch: Arch, part: &Part, x: &[f64]) -> f64 {
    arch.dispatch(Energy { part, x })
}

/// The loop over energies, as [`Forces`] is that over forces.
struct Energy<'a> {
    part: &'a Part,
    x: &'a [f64],
}

impl WithSimd for Energy<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        let (particles, x) = (&self.part.particles, self.x.as_chunks().0);
        let Table {
            ends,
            stiffness,
            rest_length,
            ..
        } = &self.part.table;
        let one = |[i, _]: [u32; 2], d: [f64; 3], k: f64, l: f64| {
            let stretch = dot(d, d).sqrt() - l;
            let energy = 0.5 * k * stretch * stretch;
            if particles.contains(&(i as usize)) {
                energy
            } else {
                0.0
            }
        };
        // One sum for each place in a block: sums that do not wait for each other.
        let mut sums = [0.0; BLOCK];
        let (whole, rest) = ends.as_chunks::<BLOCK>();
        let (k, more_k) = stiffness.as_chunks::<BLOCK>();
        let (l, more_l) = rest_length.as_chunks::<BLOCK>();
        for ((ends, k), l) in whole.iter().zip(k).zip(l) {
            let mut d = [[0.0; BLOCK]; 3];
            for s in 0..BLOCK {
                let between = between(x, ends[s]);
                for axis in 0..3 {
                    d[axis][s] = between[axis];
                }
            }
            for s in 0..BLOCK {
                sums[s] += one(ends[s], [d[0][s], d[1][s], d[2][s]], k[s], l[s]);
            }
        }
        let rest = rest.iter().zip(more_k).zip(more_l);
        for (sum, ((ends, k), l)) in sums.iter_mut().zip(rest) {
            *sum += one(*ends, between(x, *ends), *k, *l);
        }
        sums.iter().sum()
    }
}

/// Computes springs from index `from` on in whole blocks of `N`, and leaves out the remainder. The power is
/// added to `dissipated`, spring by spring.
#[inline(always)]
fn blocks<const N: usize, const MODEL: u8, const ELASTIC: bool>(
    springs: &Table,
    from: usize,
    at: Motion,
    f: &mut Vectors,
    first: usize,
    mut dissipated: f64,
) -> f64 {
    let ends = springs.ends[from..].as_chunks::<N>().0;
    let stiffness = springs.stiffness[from..].as_chunks::<N>().0;
    let rest_length = springs.rest_length[from..].as_chunks::<N>().0;
    let elastic = ends.iter().zip(stiffness).zip(rest_length);
    if MODEL == NONE {
        for ((ends, k), l) in elastic {
            let (force, _) = compute::<N, MODEL, ELASTIC>(ends, k, l, &[0.0; N], at);
            scatter(ends, &force, f, first);
        }
    } else {
        let damping = springs.damping[from..].as_chunks::<N>().0;
        for (((ends, k), l), c) in elastic.zip(damping) {
            let (force, loss) = compute::<N, MODEL, ELASTIC>(ends, k, l, c, at);
            scatter(ends, &force, f, first);
            for s in 0..N {
                if (ends[s][0] as usize).wrapping_sub(first) < f.len() {
                    dissipated += loss[s];
                }
            }
        }
    }
    dissipated
}

/// The force on the first end of each spring, N, axis by axis, and the power it dissipates, W.
#[inline(always)]
fn compute<const N: usize, const MODEL: u8, const ELASTIC: bool>(
    ends: &[[u32; 2]; N],
    stiffness: &[f64; N],
    rest_length: &[f64; N],
    damping: &[f64; N],
    at: Motion,
) -> ([[f64; N]; 3], [f64; N]) {
    // Both slices have the same length, so one bounds check serves both.
    let (x, v) = (at.x, &at.v[..at.x.len()]);
    let (mut d, mut dv, mut closing) = ([[0.0; N]; 3], [[0.0; N]; 3], [0.0; N]);
    for s in 0..N {
        let between = between(x, ends[s]);
        for axis in 0..3 {
            d[axis][s] = between[axis];
        }
        if MODEL == AXIAL {
            closing[s] = dot(self::between(v, ends[s]), between);
        }
        if MODEL == ISOTROPIC {
            let between = self::between(v, ends[s]);
            for axis in 0..3 {
                dv[axis][s] = between[axis];
            }
        }
    }
    let (mut force, mut loss) = ([[0.0; N]; 3], [0.0; N]);
    for s in 0..N {
        let pair = Pair {
            between: [d[0][s], d[1][s], d[2][s]],
            closing: closing[s],
            relative: [dv[0][s], dv[1][s], dv[2][s]],
        };
        let spring = [stiffness[s], rest_length[s], damping[s]];
        let (own, lost) = one::<MODEL, ELASTIC>(pair, spring);
        for axis in 0..3 {
            force[axis][s] = own[axis];
        }
        loss[s] = lost;
    }
    (force, loss)
}

/// Adds the forces to those ends that lie in `f`, spring after spring.
#[inline(always)]
fn scatter<const N: usize>(
    ends: &[[u32; 2]; N],
    force: &[[f64; N]; 3],
    f: &mut Vectors,
    first: usize,
) {
    // In most scenes springs that share their first end follow each other, so its sum stays in a register.
    let (mut current, mut sum) = (usize::MAX, [0.0; 3]);
    // An index outside `f` is a particle of another part. The bounds check, needed anyway, skips it.
    for s in 0..N {
        let [i, j] = ends[s].map(|end| (end as usize).wrapping_sub(first));
        if i != current {
            if let Some(f) = f.get_mut(current) {
                *f = sum;
            }
            current = i;
            sum = f.get(i).copied().unwrap_or_default();
        }
        for axis in 0..3 {
            sum[axis] += force[axis][s];
        }
        if let Some(f) = f.get_mut(j) {
            for axis in 0..3 {
                f[axis] -= force[axis][s];
            }
        }
    }
    if let Some(f) = f.get_mut(current) {
        *f = sum;
    }
}

/// The vector from the first end to the second.
#[inline(always)]
fn between(x: &Vectors, ends: [u32; 2]) -> [f64; 3] {
    let [from, to] = ends.map(|end| &x[end as usize]);
    [to[0] - from[0], to[1] - from[1], to[2] - from[2]]
}

/// The same vector, loaded coordinate by coordinate: see [`few`].
#[inline(always)]
fn apart(x: &Vectors, ends: [u32; 2]) -> [f64; 3] {
    let x = x.as_flattened();
    let [i, j] = ends.map(|end| 3 * end as usize);
    let mut between = [0.0; 3];
    for axis in 0..3 {
        if let (Some(from), Some(to)) = (x.get(i + axis), x.get(j + axis)) {
            between[axis] = to - from;
        }
    }
    between
}

/// The relative position and velocity of a spring's ends.
struct Pair {
    /// From the first end to the second, m.
    between: [f64; 3],
    /// Dot product of relative velocity and `between`, m²/s; used with axial dampers.
    closing: f64,
    /// Relative velocity, m/s; used with isotropic dampers.
    relative: [f64; 3],
}

/// The force on the first end of a spring of stiffness, rest length and damping, N, and the power it
/// dissipates, W.
#[inline(always)]
fn one<const MODEL: u8, const ELASTIC: bool>(
    pair: Pair,
    [stiffness, rest_length, damping]: [f64; 3],
) -> ([f64; 3], f64) {
    let Pair {
        between,
        closing,
        relative,
    } = pair;
    let length = dot(between, between).sqrt();
    // Like f64::max, this gives the number where one of the two is NaN.
    let length = if length > SHORTEST { length } else { SHORTEST };
    let mut pull = 0.0;
    if ELASTIC {
        pull = stiffness * (length - rest_length);
    }
    let mut loss = 0.0;
    let along = if MODEL == AXIAL {
        // One division serves both: a division costs as much as all the rest.
        let inverse = 1.0 / length;
        let rate = closing * inverse;
        let resistance = damping * rate;
        loss = resistance * rate;
        (pull + resistance) * inverse
    } else {
        pull / length
    };
    let mut force = [along * between[0], along * between[1], along * between[2]];
    if MODEL == ISOTROPIC {
        for axis in 0..3 {
            let resistance = damping * relative[axis];
            force[axis] = if ELASTIC {
                force[axis] + resistance
            } else {
                resistance
            };
        }
        loss = damping * dot(relative, relative);
    }
    (force, loss)
}
