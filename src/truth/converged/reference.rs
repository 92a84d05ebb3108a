//! A converged reference as a motion: states at any time, from kept ones by the same method.

use super::dormand_prince::DormandPrince;
use super::mesh::Mesh;
use super::precise::Precise;
use super::samples::Samples;
use super::stepper::Stepper;
use crate::system::System;
use crate::truth::{Motion, States};
use rayon::prelude::*;
use std::sync::Arc;

/// Steps of the reference through each piece of its mesh, to one of the other estimate: both then
/// cost about the same.
pub(super) const STEPS: u32 = 2;

/// Times handled by one thread at a time.
const PART: usize = 64;

/// A system several threads may evaluate, and a motion may keep.
pub type SharedSystem = Arc<dyn System + Send + Sync>;

/// A motion known at evenly spaced instants and, between them, by steps of the reference method from
/// the instant before.
pub struct Reference {
    pub(super) system: SharedSystem,
    pub(super) record: Record,
}

/// All of a reference but its system.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Record {
    pub mesh: Mesh,
    /// States where the mesh's intervals meet.
    pub samples: Samples,
    /// The error bar there, m; never falls.
    pub bars: Vec<f64>,
}

impl Reference {
    /// The states at ascending times, each by whole steps from the kept state before it and one
    /// shorter step. Which other times are asked for changes no bit.
    fn integrate(&self, times: &[f64]) -> States {
        let Record {
            mesh,
            samples,
            bars,
        } = &self.record;
        let interval = mesh.interval();
        let finite = bars.iter().take_while(|bar| bar.is_finite()).count();
        let last = finite.saturating_sub(1);

        let mut method = DormandPrince::default();
        let mut states = States {
            dim: samples.dim,
            x: Vec::with_capacity(times.len() * samples.dim),
            v: Vec::with_capacity(times.len() * samples.dim),
        };
        let mut base = Precise::new(samples.x(0), samples.v(0));
        let mut at = base.clone();
        let mut from = None;
        let mut steps = None;
        for &t in times {
            let t = t.clamp(0.0, mesh.until());
            let mut k = ((t / interval) as usize).min(last);
            // The quotient may have been rounded up.
            if k > 0 && mesh.time(k) > t {
                k -= 1;
            }
            if from != Some(k) {
                from = Some(k);
                base.set(samples.x(k), samples.v(k));
                let ahead = (k < last).then(|| mesh.steps(k, STEPS));
                steps = Some(ahead.into_iter().flatten().peekable());
            }
            // Rounded once, whatever the time.
            let since = (-(k as f64)).mul_add(interval, t);
            at.copy_from(&base);
            let Some(steps) = &mut steps else { continue };
            while let Some(step) = steps.next_if(|step| step.end() * interval <= since) {
                let t = mesh.time(k) + step.offset * interval;
                method.step(&*self.system, t, step.length * interval, &mut base);
            }
            at.copy_from(&base);
            if let Some(step) = steps.peek() {
                let rest = (-step.offset).mul_add(interval, since);
                if rest > 0.0 {
                    let t = mesh.time(k) + step.offset * interval;
                    method.step(&*self.system, t, rest, &mut at);
                }
            }
            states.x.extend_from_slice(&at.x);
            states.v.extend_from_slice(&at.v);
        }
        states
    }
}

impl Motion for Reference {
    /// Ascending times cost one integration together, and one short step each, on all cores. Where
    /// the motion has left the range of finite numbers, and the bar is infinite, the last finite
    /// state is repeated.
    fn states(&self, times: &[f64]) -> States {
        let parts: Vec<States> = times
            .par_chunks(PART)
            .map(|times| self.integrate(times))
            .collect();
        let mut all = States {
            dim: self.record.samples.dim,
            ..States::default()
        };
        for part in parts {
            all.x.extend(part.x);
            all.v.extend(part.v);
        }
        all
    }

    fn error_bar(&self, t: f64) -> f64 {
        let Record { mesh, bars, .. } = &self.record;
        // The bar of the first instant not before t.
        let mut k = (t.max(0.0) / mesh.interval()) as usize;
        while k < bars.len() && mesh.time(k) < t {
            k += 1;
        }
        let bar = bars.get(k).or(bars.last());
        bar.copied().unwrap_or(f64::INFINITY)
    }

    /// The kept states, and the end.
    fn landmarks(&self, until: f64) -> Vec<f64> {
        let Record { mesh, bars, .. } = &self.record;
        let kept = (0..bars.len()).map(|k| mesh.time(k));
        kept.take_while(|t| *t < until).chain([until]).collect()
    }
}
