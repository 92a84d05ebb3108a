//! A whole integration, kept at the ends of a mesh's intervals.

use super::mesh::Mesh;
use super::precise::Precise;
use super::stepper::Stepper;
use crate::system::System;

/// States at the start and at the end of each interval.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Samples {
    /// One state after the other, `dim` coordinates each.
    pub x: Vec<f64>,
    pub v: Vec<f64>,
    pub dim: usize,
}

impl Samples {
    /// Integrates from the start with `each` steps through every piece of the mesh and tells `after`
    /// every step which piece it went through. From the first state that is not finite on, all are
    /// NaN.
    pub fn integrate<S: Stepper>(
        stepper: &mut S,
        system: &dyn System,
        start: &Precise,
        mesh: &Mesh,
        each: u32,
        mut after: impl FnMut(usize, &S),
    ) -> Self {
        let mut state = start.clone();
        let dim = state.x.len();
        let room = (mesh.intervals() + 1) * dim;
        let mut samples = Self {
            x: Vec::with_capacity(room),
            v: Vec::with_capacity(room),
            dim,
        };
        samples.push(&state);
        let interval = mesh.interval();
        for k in 0..mesh.intervals() {
            let first = mesh.range(k).start;
            for (step, part) in mesh.steps(k, each).enumerate() {
                let t = mesh.time(k) + part.offset * interval;
                stepper.step(system, t, part.length * interval, &mut state);
                after(first + step / each as usize, stepper);
            }
            if !state.is_finite() {
                samples.x.resize(room, f64::NAN);
                samples.v.resize(room, f64::NAN);
                break;
            }
            samples.push(&state);
        }
        samples
    }

    fn push(&mut self, state: &Precise) {
        self.x.extend_from_slice(&state.x);
        self.v.extend_from_slice(&state.v);
    }

    /// Positions at the start of interval k.
    pub fn x(&self, k: usize) -> &[f64] {
        &self.x[k * self.dim..(k + 1) * self.dim]
    }

    /// Velocities there.
    pub fn v(&self, k: usize) -> &[f64] {
        &self.v[k * self.dim..(k + 1) * self.dim]
    }

    /// How far apart this motion and another of the same mesh have been up to each instant, m.
    pub fn apart(&self, other: &Samples) -> Vec<f64> {
        let instants = self.x.len() / self.dim.max(1);
        running_largest((0..instants).map(|k| apart(self.x(k), other.x(k))))
    }
}

/// Largest Euclidean distance over the particles, three coordinates each, m; infinite where a
/// coordinate is not finite. A system of fewer than three coordinates is one particle.
pub(super) fn apart(a: &[f64], b: &[f64]) -> f64 {
    let particles = a.chunks(3).zip(b.chunks(3));
    let squares = particles.map(|(a, b)| {
        let coordinates = a.iter().zip(b);
        coordinates.map(|(a, b)| (a - b) * (a - b)).sum::<f64>()
    });
    let largest = squares.fold(0.0, |most: f64, square| {
        if square.is_nan() {
            f64::INFINITY
        } else {
            most.max(square)
        }
    });
    largest.sqrt()
}

/// Each element the largest so far.
pub(super) fn running_largest(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let largest = values.scan(0.0, |most: &mut f64, value| {
        *most = most.max(value);
        Some(*most)
    });
    largest.collect()
}
