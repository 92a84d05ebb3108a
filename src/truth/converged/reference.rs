//! A converged reference as a motion, which steps from kept states to any time by the same method;
//! and as the bytes that a [`Store`](crate::truth::Store) keeps.

use super::dormand_prince::DormandPrince;
use super::mesh::Mesh;
use super::stepper::{Precise, through};
use super::{Converged, NotConverged, ReferenceFacts, VERSION};
use crate::physics::System;
use crate::truth::{Motion, States};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::sync::Arc;

/// Steps of the reference through each piece of its mesh. The other estimate takes one, which costs
/// about as much.
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Record {
    pub mesh: Mesh,
    /// States where the mesh's intervals meet.
    pub samples: States,
    /// The error bar there, m; never falls.
    pub bars: Vec<f64>,
}

impl Record {
    /// Whether it has `dim` coordinates, reaches up to `until`, s, and is consistent.
    pub fn fits(&self, dim: usize, until: f64) -> bool {
        let Self {
            mesh,
            samples,
            bars,
        } = self;
        let numbers = bars.len().checked_mul(dim);
        mesh.fills(until)
            && bars.len() == mesh.intervals() + 1
            && samples.dim == dim
            && [&samples.x, &samples.v].map(|c| Some(c.len())) == [numbers; 2]
    }
}

impl Reference {
    /// The states at ascending times, each by whole steps from the kept state before it and one
    /// shorter step. The other times asked for change no bit.
    fn integrate(&self, times: &[f64]) -> States {
        let Record {
            mesh,
            samples,
            bars,
        } = &self.record;
        let interval = mesh.interval();
        let finite = bars.iter().take_while(|bar| bar.is_finite()).count();
        let last = finite.saturating_sub(1);
        let inside = |t: f64| t.clamp(0.0, mesh.until());
        let interval_of = |t: f64| {
            let k = ((inside(t) / interval) as usize).min(last);
            // The quotient may have been rounded up.
            k - usize::from(k > 0 && mesh.time(k) > inside(t))
        };
        let mut method = DormandPrince::default();
        let mut states = States::with_room(samples.dim, times.len());
        for times in times.chunk_by(|a, b| interval_of(*a) == interval_of(*b)) {
            let k = interval_of(times[0]);
            let mut base = Precise::new(samples.x(k), samples.v(k));
            let ahead = (k < last).then(|| mesh.steps(k, STEPS));
            let mut steps = ahead.into_iter().flatten().peekable();
            for &t in times {
                // Rounded once, whatever the time.
                let since = (-(k as f64)).mul_add(interval, inside(t));
                while let Some(step) = steps.next_if(|step| step.end() * interval <= since) {
                    let t = mesh.time(k) + step.offset * interval;
                    let h = step.length * interval;
                    through(&mut method, &*self.system, t, h, &mut base);
                }
                let mut at = base.clone();
                if let Some(step) = steps.peek() {
                    let rest = (-step.offset).mul_add(interval, since);
                    if rest > 0.0 {
                        let t = mesh.time(k) + step.offset * interval;
                        through(&mut method, &*self.system, t, rest, &mut at);
                    }
                }
                self.system.place(t, &mut at.x, &mut at.v);
                states.push(&at.x, &at.v);
            }
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
        let mut all = States::with_room(self.record.samples.dim, times.len());
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

/// The stored form: version, key, and what was found, in postcard's format. Their SHA-256 follows it.
type Kept = (u32, String, Result<(ReferenceFacts, Record), NotConverged>);

/// Length of the checksum.
const CHECKSUM: usize = 32;

/// The bytes of what was found under this key, or of why nothing was. None if it cannot be written.
pub(super) fn encode(found: &Result<Converged, NotConverged>, key: &str) -> Option<Vec<u8>> {
    let found = found.as_ref().map(|f| (&f.facts, &f.motion.record));
    let mut bytes = postcard::to_allocvec(&(VERSION, key, found)).ok()?;
    let checksum = Sha256::digest(&bytes);
    bytes.extend_from_slice(&checksum);
    Some(bytes)
}

/// What was found, or why nothing was. None unless these are the bytes of this key, version and
/// system, whole to the last byte and unchanged.
pub(super) fn decode(
    bytes: &[u8],
    key: &str,
    system: &SharedSystem,
    until: f64,
) -> Option<Result<Converged, NotConverged>> {
    let (content, checksum) = bytes.split_at_checked(bytes.len().checked_sub(CHECKSUM)?)?;
    if Sha256::digest(content).as_slice() != checksum {
        return None;
    }
    let ((version, name, found), rest): (Kept, _) = postcard::take_from_bytes(content).ok()?;
    if version != VERSION || name != key || !rest.is_empty() {
        return None;
    }
    let (facts, record) = match found {
        Ok(found) => found,
        Err(not) => return Some(Err(not)),
    };
    record.fits(system.dim(), until).then(|| {
        let system = Arc::clone(system);
        let motion = Reference { system, record };
        Ok(Converged { facts, motion })
    })
}
