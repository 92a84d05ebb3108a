//! Loops over flat vectors. Long ones run on several threads, with the same bits as on one.

use rayon::prelude::*;

/// Vectors shorter than this are not worth waking a thread for.
const LONG: usize = 1 << 15;

/// Elements a thread takes at a time: 32 KB of each vector.
const CHUNK: usize = 1 << 12;

/// y += a x.
#[inline(always)]
pub(crate) fn axpy(y: &mut [f64], a: f64, x: &[f64]) {
    if y.len() >= LONG {
        return long_axpy(y, a, x);
    }
    axpy_short(y, a, x);
}

/// y = x + a z.
#[inline(always)]
pub(crate) fn sum(y: &mut [f64], x: &[f64], a: f64, z: &[f64]) {
    if y.len() >= LONG {
        return long_sum(y, x, a, z);
    }
    sum_short(y, x, a, z);
}

/// y = x.
#[inline(always)]
pub(crate) fn copy(y: &mut [f64], x: &[f64]) {
    if y.len() >= LONG {
        return long(y, x, |y, x| y.copy_from_slice(x));
    }
    y.copy_from_slice(x);
}

/// y *= x, element by element.
#[inline(always)]
pub(crate) fn multiply(y: &mut [f64], x: &[f64]) {
    if y.len() >= LONG {
        return long(y, x, multiply_short);
    }
    multiply_short(y, x);
}

/// y = 0.
#[inline(always)]
pub(crate) fn clear(y: &mut [f64]) {
    if y.len() >= LONG {
        return y.par_chunks_mut(CHUNK).for_each(|y| y.fill(0.0));
    }
    y.fill(0.0);
}

/// v += kick a, then x += drift v. One pass does both, since memory bandwidth limits them.
#[inline(always)]
pub(crate) fn kick_and_drift(x: &mut [f64], v: &mut [f64], a: &[f64], kick: f64, drift: f64) {
    if x.len() >= LONG {
        return long_kick_and_drift(x, v, a, kick, drift);
    }
    axpy_short(v, kick, a);
    axpy_short(x, drift, v);
}

#[inline(always)]
fn axpy_short(y: &mut [f64], a: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += a * x;
    }
}

#[inline(always)]
fn sum_short(y: &mut [f64], x: &[f64], a: f64, z: &[f64]) {
    for ((y, x), z) in y.iter_mut().zip(x).zip(z) {
        *y = x + a * z;
    }
}

#[inline(always)]
fn multiply_short(y: &mut [f64], x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y *= x;
    }
}

// The long loops are kept out of line, so that short vectors do not pay for them.

#[cold]
#[inline(never)]
fn long(y: &mut [f64], x: &[f64], pass: impl Fn(&mut [f64], &[f64]) + Sync) {
    let chunks = y.par_chunks_mut(CHUNK).zip(x.par_chunks(CHUNK));
    chunks.for_each(|(y, x)| pass(y, x));
}

// Scalars are passed by value: a closure would hold them by reference, in memory.
#[cold]
#[inline(never)]
fn long_axpy(y: &mut [f64], a: f64, x: &[f64]) {
    long(y, x, |y, x| axpy_short(y, a, x));
}

#[cold]
#[inline(never)]
fn long_sum(y: &mut [f64], x: &[f64], a: f64, z: &[f64]) {
    let chunks = y.par_chunks_mut(CHUNK).zip(x.par_chunks(CHUNK));
    let chunks = chunks.zip(z.par_chunks(CHUNK));
    chunks.for_each(|((y, x), z)| sum_short(y, x, a, z));
}

#[cold]
#[inline(never)]
fn long_kick_and_drift(x: &mut [f64], v: &mut [f64], a: &[f64], kick: f64, drift: f64) {
    let chunks = x.par_chunks_mut(CHUNK).zip(v.par_chunks_mut(CHUNK));
    let chunks = chunks.zip(a.par_chunks(CHUNK));
    chunks.for_each(|((x, v), a)| {
        for ((x, v), a) in x.iter_mut().zip(v).zip(a) {
            *v += kick * a;
            *x += drift * *v;
        }
    });
}
