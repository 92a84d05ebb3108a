//! Many events in one step: impacts in the order of their times, each on the paths of its particles, which it bends from
//! there on. Of second order for a bounded number of impacts.

use super::path::{Path, meeting};
use super::root::Due;
use crate::integrators::StepError;
use crate::physics::State;
use crate::physics::constraints::Rods;
use crate::physics::constraints::contact::{Against, Blows, Near, Obstacles};
use crate::space::{dot, minus, three};
use std::cmp::{Ordering, Reverse};
use std::collections::{BTreeSet, BinaryHeap};
use std::sync::Arc;

/// After so many impacts within a step a particle that would come to rest by its end does so at once.
const ENOUGH: u32 = 32;
/// And after so many between what does not give everything back, whatever comes of it.
const ANYHOW: u32 = 256;
/// More than these are none that can be located.
const MOST: u32 = 4_000;

/// A particle, and what it meets.
type Pair = (usize, Against);

/// The impacts of a step of `h` seconds from `start`, of which these are known.
pub(super) struct Many<'a> {
    pub obstacles: &'a Obstacles,
    pub rods: Option<&'a Rods>,
    pub near: Arc<Near>,
    pub h: f64,
    pub start: &'a State,
}

/// An impact on paths that have been bent so often.
struct Next {
    due: Due<Pair>,
    bent: [u32; 2],
}

impl Many<'_> {
    /// Takes these impacts, and those that follow from them, into account at the end of the step; returns their number.
    pub fn strike(&mut self, due: Vec<Due<Pair>>, end: &mut State) -> Result<u64, StepError> {
        let mut impacts = 0;
        let paths = (0..end.x.len() / 3).map(|one| Path::new(one, self.h, self.start, end));
        let mut paths: Vec<Path> = paths.collect();
        let mut bent = vec![0_u32; paths.len()];
        let mut hits = bent.clone();
        let mut landed: BTreeSet<Pair> = BTreeSet::new();
        let mut there = end.clone();
        let mut queue: BinaryHeap<Reverse<Next>> = BinaryHeap::new();
        let both = |bent: &[u32], (one, against): Pair| match against {
            Against::Particle(other) => [bent[one], bent[other]],
            Against::Obstacle(_) => [bent[one], 0],
        };
        queue.extend(due.into_iter().map(|due| {
            let bent = both(&bent, due.event);
            Reverse(Next { due, bent })
        }));
        while let Some(Reverse(next)) = queue.pop() {
            let pair = next.due.event;
            if next.bent != both(&bent, pair) {
                continue;
            }
            let ends = pair.1.with(pair.0);
            let s = self.instant(&next.due, &paths);
            there.t = self.start.t + s * self.h;
            for one in &ends {
                paths[*one].put(*one, s, &mut there);
            }
            let before = there.v.clone();
            let struck = self.apply(pair, &mut there)?;
            if struck == 0 {
                // It would rise by less than is seen.
                landed.insert(pair);
                continue;
            }
            impacts += struck;
            for one in &ends {
                hits[*one] += 1;
            }
            // Rods pass impulses on to all.
            let moved: Vec<usize> = match self.rods {
                Some(_) => (0..paths.len()).collect(),
                None => ends,
            };
            let mut turned = BTreeSet::new();
            for one in moved {
                let change = minus(three(&there.v, one), three(&before, one));
                if change != [0.0; 3] {
                    paths[one].bend(s, change);
                    bent[one] += 1;
                    turned.insert(one);
                }
            }
            let most = pair.1.with(pair.0).into_iter().map(|one| hits[one]).max();
            let most = most.unwrap_or_default();
            if most > MOST {
                return Err(StepError::TooManyEvents { t: there.t });
            }
            if most >= ENOUGH && self.comes_to_rest(pair, s, most, &paths, &mut there) {
                landed.insert(pair);
            }
            self.follow(&turned, &paths);
            for one in turned {
                for against in self.near.of(one) {
                    let pair = match *against {
                        Against::Particle(other) if other < one => (other, Against::Particle(one)),
                        against => (one, against),
                    };
                    if landed.contains(&pair) {
                        continue;
                    }
                    let times = [self.start.t, self.h];
                    if let Some(due) =
                        meeting(self.obstacles, pair, (s, 1.0), times, |one| &paths[one])
                    {
                        let bent = both(&bent, pair);
                        queue.push(Reverse(Next { due, bent }));
                    }
                }
            }
        }
        end.work = there.work;
        let mut all = BTreeSet::new();
        for (one, path) in paths.iter().enumerate().filter(|(one, _)| bent[*one] > 0) {
            path.put(one, 1.0, end);
            all.insert(one);
        }
        self.obstacles.push_out(&self.near, &mut all, end);
        if !landed.is_empty() {
            let blows = Blows {
                near: &self.near,
                rods: self.rods,
                among: true,
                lands: true,
            };
            let landed = landed.iter().map(|pair| pair.0).collect();
            self.obstacles.strike(&blows, landed, end)?;
        }
        Ok(impacts)
    }

    /// Whether what bounces ends its bounces within the step, after 2 V/((1 - e) a) for the speed V and the acceleration a
    /// on the paths; `there` has the places at s, and changes.
    fn comes_to_rest(
        &self,
        (particle, against): Pair,
        s: f64,
        hits: u32,
        paths: &[Path],
        there: &mut State,
    ) -> bool {
        let given = self.obstacles.surface(against).restitution;
        if given >= 1.0 || hits >= ANYHOW {
            return given < 1.0;
        }
        let after = self.obstacles.beside(particle, against, there);
        let left = (1.0 - s) * self.h;
        for one in against.with(particle) {
            let velocity = paths[one].velocity(1.0);
            there.v[3 * one..3 * one + 3].copy_from_slice(&velocity);
        }
        let end = self.obstacles.beside(particle, against, there);
        // Both along the normal of now.
        let down = after.parting() - dot(after.normal, end.velocity);
        2.0 * after.parting() < (1.0 - given) * down && left > 0.0
    }

    /// When an impact is, as a part of the step.
    fn instant(&self, due: &Due<Pair>, paths: &[Path]) -> f64 {
        let (particle, against) = due.event;
        let (mut low, mut high) = (due.clear / self.h, due.due / self.h);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let at = |one: usize| paths[one].at(middle);
            let t = self.start.t + middle * self.h;
            if self.obstacles.gap(particle, against, t, at) < due.level {
                high = middle;
            } else {
                low = middle;
            }
        }
        high
    }

    /// One impact, and those with other obstacles that the particle touches there. Of its own place alone is it known when
    /// it is there.
    fn apply(&self, (particle, against): Pair, there: &mut State) -> Result<u64, StepError> {
        match against {
            Against::Obstacle(_) => {
                let blows = Blows {
                    near: &self.near,
                    rods: self.rods,
                    among: false,
                    lands: false,
                };
                let struck = self.obstacles.strike(&blows, [particle].into(), there)?;
                Ok(struck.impulses)
            }
            Against::Particle(_) => {
                let beside = self.obstacles.beside(particle, against, there);
                let struck = self.obstacles.apply(self.rods, &beside, false, there)?;
                Ok(u64::from(struck))
            }
        }
    }

    /// Looks anew for what is near where a path leaves what was searched.
    fn follow(&mut self, turned: &BTreeSet<usize>, paths: &[Path]) {
        let within = |one: &usize| self.near.holds(*one, paths[*one].ball());
        if !turned.iter().all(within) {
            let times = [self.start.t, self.start.t + self.h];
            self.near = self.obstacles.near(times, |one| paths[one].ball());
        }
    }
}

impl Next {
    fn key(&self) -> (f64, Pair) {
        (self.due.due, self.due.event)
    }
}

impl Ord for Next {
    fn cmp(&self, other: &Self) -> Ordering {
        let ((t, pair), (other_t, other_pair)) = (self.key(), other.key());
        t.total_cmp(&other_t).then(pair.cmp(&other_pair))
    }
}

impl PartialOrd for Next {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Next {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Next {}
