//! Many events in one step: impacts in the order of their times, each on the paths of its particles, which it bends from
//! there on. Of second order for a bounded number of impacts.

use super::path::{Path, meeting};
use super::root::Due;
use crate::integrators::StepError;
use crate::physics::constraints::Rods;
use crate::physics::constraints::contact::{Against, Blows, Held, Near, Obstacles};
use crate::physics::{ForceKinds, Power, State, System};
use crate::space::{dot, minus, three};
use std::cmp::{Ordering, Reverse};
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};
use std::sync::Arc;

/// After so many impacts within a step a particle that would come to rest by its end does so at once; what gives nothing
/// back, after the first.
const ENOUGH: u32 = 32;
/// And after so many between what does not give everything back, whatever comes of it.
const ANYHOW: u32 = 256;
/// More than these are none that can be located.
const MOST: u32 = 4_000;

/// A particle, and what it meets.
type Pair = (usize, Against);

/// The impacts of a step of `h` seconds from `start`, of which these are known.
pub(super) struct Many<'a> {
    pub system: &'a dyn System,
    pub obstacles: &'a Obstacles,
    pub held: Option<&'a Held<'a>>,
    pub near: Arc<Near>,
    pub h: f64,
    pub start: &'a State,
}

/// An impact on paths that have been bent so often.
struct Next {
    due: Due<Pair>,
    bent: [u32; 2],
}

/// The paths that impacts have bent, how often, and how often each particle was struck.
struct Bent<'a> {
    h: f64,
    ends: [&'a State; 2],
    paths: BTreeMap<usize, (Path, u32)>,
    hits: BTreeMap<usize, u32>,
    /// The changes of velocity, and each times the part of the step that is left after it, m/s.
    turned: [Vec<f64>; 2],
}

impl Bent<'_> {
    fn path(&self, one: usize) -> Path {
        let bent = self.paths.get(&one).map(|(path, _)| path.clone());
        bent.unwrap_or_else(|| Path::new(one, self.h, self.ends[0], self.ends[1]))
    }

    /// How often the paths of a pair are bent.
    fn often(&self, (one, against): Pair) -> [u32; 2] {
        let often = |one: usize| self.paths.get(&one).map_or(0, |(_, often)| *often);
        match against {
            Against::Particle(other) => [often(one), often(other)],
            Against::Obstacle(_) => [often(one), 0],
        }
    }

    fn bend(&mut self, one: usize, s: f64, change: [f64; 3]) {
        let path = self.path(one);
        let (path, often) = self.paths.entry(one).or_insert((path, 0));
        path.bend(s, change);
        *often += 1;
        for (all, weight) in self.turned.iter_mut().zip([1.0, 1.0 - s]) {
            for axis in 0..3 {
                all[3 * one + axis] += weight * change[axis];
            }
        }
    }

    /// Counts an impact of these; returns how many the most often struck has.
    fn hit(&mut self, ends: &[usize]) -> u32 {
        let each = ends.iter().map(|one| {
            let hits = self.hits.entry(*one).or_default();
            *hits += 1;
            *hits
        });
        each.max().unwrap_or_default()
    }
}

impl Many<'_> {
    /// Takes these impacts, and those that follow from them, into account at the end of the step; returns their number.
    pub fn strike(&mut self, due: Vec<Due<Pair>>, end: &mut State) -> Result<u64, StepError> {
        let mut impacts = 0;
        let before = end.clone();
        let mut bent = Bent {
            h: self.h,
            ends: [self.start, &before],
            paths: BTreeMap::new(),
            hits: BTreeMap::new(),
            turned: [vec![0.0; before.v.len()], vec![0.0; before.v.len()]],
        };
        let mut landed: BTreeSet<Pair> = BTreeSet::new();
        let mut there = before.clone();
        let first = due
            .into_iter()
            .map(|due| Reverse(Next { due, bent: [0; 2] }));
        let mut queue: BinaryHeap<Reverse<Next>> = first.collect();
        while let Some(Reverse(next)) = queue.pop() {
            let pair = next.due.event;
            if next.bent != bent.often(pair) {
                continue;
            }
            let ends = pair.1.with(pair.0);
            let s = self.instant(&next.due, &bent);
            there.t = self.start.t + s * self.h;
            for one in &ends {
                bent.path(*one).put(*one, s, &mut there);
            }
            // Rods pass impulses on to all.
            let moved: Vec<usize> = match self.rods() {
                Some(_) => (0..there.v.len() / 3).collect(),
                None => ends.clone(),
            };
            let old: Vec<_> = moved.iter().map(|one| three(&there.v, *one)).collect();
            let struck = self.apply(pair, &mut there)?;
            if struck == 0 {
                // It would rise by less than is seen.
                landed.insert(pair);
                continue;
            }
            impacts += struck;
            let mut turned = BTreeSet::new();
            for (one, old) in moved.into_iter().zip(old) {
                let change = minus(three(&there.v, one), old);
                if change != [0.0; 3] {
                    bent.bend(one, s, change);
                    turned.insert(one);
                }
            }
            let most = bent.hit(&ends);
            if most > MOST {
                return Err(StepError::TooManyEvents { t: there.t });
            }
            let dead = self.obstacles.surface(pair.1).restitution == 0.0;
            if (dead || most >= ENOUGH) && self.comes_to_rest(pair, s, most, &bent, &mut there) {
                landed.insert(pair);
            }
            self.follow(&turned, &bent);
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
                    let path = |one| bent.path(one);
                    if let Some(due) = meeting(self.obstacles, pair, (s, 1.0), times, path) {
                        let bent = bent.often(pair);
                        queue.push(Reverse(Next { due, bent }));
                    }
                }
            }
        }
        end.work = there.work;
        let mut all = BTreeSet::new();
        for (one, (path, _)) in &bent.paths {
            path.put(*one, 1.0, end);
            all.insert(*one);
        }
        self.damp(&bent, &landed, end)?;
        self.obstacles.push_out(&self.near, &mut all, end);
        if !landed.is_empty() {
            let blows = Blows {
                among: true,
                lands: true,
                ..self.blows()
            };
            let landed = landed.iter().map(|pair| pair.0).collect();
            self.obstacles.strike(&blows, landed, end)?;
        }
        Ok(impacts)
    }

    fn rods(&self) -> Option<&'_ Rods> {
        self.system.rods()
    }

    /// What forces that depend on velocity do otherwise from impacts on to the end of the step, as far as velocities go: to
    /// second order where they are linear in it. Without it dampers would act as if nothing had been struck, and each
    /// impact cost an error of first order.
    fn damp(&self, bent: &Bent, landed: &BTreeSet<Pair>, end: &mut State) -> Result<(), StepError> {
        let system = self.system;
        if !system.kinds().depends_on_velocity() {
            return Ok(());
        }
        let before = bent.ends[1];
        let [turned, mean] = &bent.turned;
        let power = |w: &[f64], a: &[f64]| {
            let each = w.iter().zip(a).zip(system.inverse_mass());
            // Most particles are not struck: what is 0 is not divided.
            let each = each.filter(|((w, a), inverse)| **inverse > 0.0 && *w * *a != 0.0);
            -each.map(|((w, a), inverse)| w * a / inverse).sum::<f64>()
        };
        let mut damped = vec![0.0; mean.len()];
        system.damping(before.t, &before.x, mean, &mut damped);
        // The power is quadratic in the velocity: that of a change which lasts for a part of the step is not that of its mean.
        let lasting = power(turned, &damped) - power(mean, &damped);
        let others = [
            ForceKinds::NON_LINEAR,
            ForceKinds::DRIVEN,
            ForceKinds::GYROSCOPIC,
        ];
        let (more, mut change) = if others.iter().any(|kind| system.kinds().has(*kind)) {
            let v: Vec<f64> = before.v.iter().zip(mean).map(|(v, w)| v + w).collect();
            let (mut was, mut change) = (vec![0.0; v.len()], vec![0.0; v.len()]);
            let from = system.remembered_acceleration(before.t, &before.x, &before.v, &mut was);
            let to = system.free_acceleration(before.t, &before.x, &v, &mut change);
            for (change, was) in change.iter_mut().zip(&was) {
                *change -= was;
            }
            let more = Power {
                dissipated: to.dissipated - from.dissipated,
                injected: to.injected - from.injected,
            };
            (more, change)
        } else {
            // Dampers are symmetric, and all that depends on velocity.
            let more = Power {
                dissipated: power(mean, &damped) + 2.0 * power(&before.v, &damped),
                injected: 0.0,
            };
            (more, damped)
        };
        for change in &mut change {
            *change *= self.h;
        }
        if let Some(held) = self.held {
            held.left(end, &mut change);
        }
        if let Some(rods) = self.rods() {
            rods.at(&before.x)?.still(&mut change);
        }
        for (particle, against) in landed {
            let beside = self.obstacles.beside(*particle, *against, end);
            let away = dot(beside.normal, self.obstacles.relative(&beside, &change));
            if away > 0.0 {
                let back = beside.normal.map(|n| -away * n);
                self.obstacles.push(&beside, back, &mut change);
            }
        }
        for (v, change) in end.v.iter_mut().zip(&change) {
            *v += change;
        }
        end.work.dissipated += self.h * (more.dissipated + lasting);
        end.work.injected += self.h * more.injected;
        Ok(())
    }

    /// Whether what bounces ends its bounces within the step, after 2 V/((1 - e) a) for the speed V and the acceleration a
    /// on the paths; `there` has the places at s, and changes.
    fn comes_to_rest(
        &self,
        (particle, against): Pair,
        s: f64,
        hits: u32,
        bent: &Bent,
        there: &mut State,
    ) -> bool {
        let given = self.obstacles.surface(against).restitution;
        if given >= 1.0 || hits >= ANYHOW {
            return given < 1.0;
        }
        let after = self.obstacles.beside(particle, against, there);
        let left = (1.0 - s) * self.h;
        for one in against.with(particle) {
            let velocity = bent.path(one).velocity(1.0);
            there.v[3 * one..3 * one + 3].copy_from_slice(&velocity);
        }
        let end = self.obstacles.beside(particle, against, there);
        // Both along the normal of now.
        let down = after.parting() - dot(after.normal, end.velocity);
        2.0 * after.parting() < (1.0 - given) * down && left > 0.0
    }

    /// When an impact is, as a part of the step.
    fn instant(&self, due: &Due<Pair>, bent: &Bent) -> f64 {
        let (particle, against) = due.event;
        let ends = against.with(particle);
        let paths: Vec<Path> = ends.iter().map(|one| bent.path(*one)).collect();
        let (mut low, mut high) = (due.clear / self.h, due.due / self.h);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let at = |one: usize| paths[usize::from(one != particle)].at(middle);
            let t = self.start.t + middle * self.h;
            if self.obstacles.gap(particle, against, t, at) < due.level {
                high = middle;
            } else {
                low = middle;
            }
        }
        high
    }

    fn blows(&self) -> Blows<'_> {
        Blows {
            near: &self.near,
            rods: self.rods(),
            among: false,
            lands: false,
        }
    }

    /// One impact, and those with other obstacles that the particle touches there. Of its own place alone is it known when
    /// it is there.
    fn apply(&self, (particle, against): Pair, there: &mut State) -> Result<u64, StepError> {
        match against {
            Against::Obstacle(_) => {
                let struck = self
                    .obstacles
                    .strike(&self.blows(), [particle].into(), there)?;
                Ok(struck.impulses)
            }
            Against::Particle(_) => {
                let beside = self.obstacles.beside(particle, against, there);
                let struck = self.obstacles.apply(self.rods(), &beside, false, there)?;
                Ok(u64::from(struck))
            }
        }
    }

    /// Looks anew for what is near where a path leaves what was searched.
    fn follow(&mut self, turned: &BTreeSet<usize>, bent: &Bent) {
        let within = |one: &usize| self.near.holds(*one, bent.path(*one).cube());
        if !turned.iter().all(within) {
            let times = [self.start.t, self.start.t + self.h];
            self.near = self.obstacles.near(times, |one| bent.path(one).cube());
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
