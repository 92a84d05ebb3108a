//! Numbers of contact that a program has in the place of the scene's, found from the steps that these do not explain:
//! restitution, friction, and the sizes of what meets.

use super::super::bounce::{
    Bounce, FRICTIONS, Own, PARTNERS, PLACES, Size, WAYS, Way, Wrong, relevant,
};
use super::super::candidate::Candidate;
use super::super::transition::Transition;
use super::super::words::digits;
use super::fitted::{norm, solved};
use super::search::{Search, Told};
use crate::physics::State;
use crate::physics::constraints::contact::{Against, Obstacles, Surface};
use crate::space::three;
use rayon::prelude::*;

/// Replays of a treatment that all take, about.
pub(super) const REPLAYS: usize = 400;
/// Steps that numbers are fitted to.
const FITTED: usize = 3;
/// Gauss and Newton's steps.
const STEPS: usize = 12;
/// The step of their slopes.
const SLOPE: f64 = 1e-6;
/// Of what a treatment leaves, a number has to leave less than this part.
const LEFT: f64 = 1e-6;
/// Most digits of a number that a person would have written.
const PLAIN: usize = 6;
/// Where no more steps show numbers than there are of them, any numbers fit: these have to be so short.
const SHORT: usize = 4;
/// Coefficients within these are some.
const SENSIBLE: std::ops::RangeInclusive<f64> = -2.0..=10.0;
/// Factors that a radius may have by mistake: it is forgotten, or is taken for a diameter, or the other way round.
const FACTORS: [f64; 3] = [0.0, 0.5, 2.0];
/// Places of a surface from which its true one is looked for.
const PLACES_TRIED: u32 = 9;

/// Which coefficients are the program's own.
const SETS: [[bool; 2]; 3] = [[true, false], [false, true], [true, true]];

/// The treatment with so many mistakes, numbers among them, that explains all steps.
pub(super) fn found(
    search: &Search,
    schemes: &[Candidate],
    obstacles: &Obstacles,
    mistakes: usize,
) -> Option<Told> {
    let bases = bases(obstacles, mistakes);
    let tried = bases
        .par_iter()
        .flat_map_iter(|base| schemes.iter().map(move |scheme| (base, scheme)));
    let fits = tried.filter_map(|(base, scheme)| {
        let one = One {
            search,
            scheme,
            base: *base,
            at: search.missed(scheme, base, FITTED),
        };
        let wrong = base.mistakes().count();
        let sets = SETS.into_iter().filter(|set| {
            let count = set.iter().filter(|own| **own).count();
            wrong + count == mistakes
        });
        let sized = || {
            (wrong + 1 == mistakes)
                .then(|| one.sized(obstacles))
                .flatten()
        };
        let bounce = match obstacles.penalty() {
            Some(_) => None,
            None => sets
                .into_iter()
                .find_map(|set| one.coefficients(obstacles, set)),
        };
        Some((bounce.or_else(sized)?, scheme))
    });
    let mut fits = fits.collect::<Vec<_>>().into_iter();
    let (bounce, _) = fits.next()?;
    let mut told = Told::new(bounce, search.fitting(schemes, &bounce));
    told.others = fits
        .map(|(bounce, _)| bounce)
        .filter(|other| *other != bounce)
        .collect();
    Some(told)
}

/// The treatments with fewer mistakes than these, to have numbers of their own.
fn bases(obstacles: &Obstacles, mistakes: usize) -> Vec<Bounce> {
    let (places, partners) = relevant(obstacles);
    let rubs = obstacles.surfaces().any(|one| one.friction[0] > 0.0);
    let frictions = ["coulomb", "friction_of_compression", "friction_forgotten"];
    let frictions = FRICTIONS
        .iter()
        .filter(|row| frictions.contains(&row.id) && (rubs || row.id == "coulomb"));
    let force = obstacles.penalty();
    let ways = WAYS.iter().filter(|way| match way.does {
        Way::Event | Way::Once(_) | Way::Of(..) | Way::Within(_) => force.is_none(),
        Way::Force { whole, .. } => whole && force.is_some(),
        Way::Soft | Way::Never => false,
    });
    let mut all = Vec::new();
    for way in ways {
        for friction in frictions.clone() {
            for (place, partner) in places
                .iter()
                .flat_map(|place| partners.iter().map(move |partner| (place, partner)))
            {
                let bounce = Bounce {
                    place,
                    friction,
                    partner,
                    force: force.unwrap_or_default(),
                    ..Bounce::new(way)
                };
                if bounce.is_sensible() && bounce.mistakes().count() < mistakes {
                    all.push(bounce);
                }
            }
        }
    }
    let simple = |bounce: &Bounce| {
        let is = |row: &str, first: &str| usize::from(row != first);
        is(bounce.place.id, PLACES[0].id) + is(bounce.partner.id, PARTNERS[0].id)
    };
    all.sort_by_key(|bounce| (bounce.mistakes().count(), simple(bounce) > 1));
    all
}

/// A treatment beside a scheme, and the steps that it does not explain.
struct One<'a> {
    search: &'a Search<'a>,
    scheme: &'a Candidate,
    base: Bounce,
    at: Vec<Transition>,
}

impl One<'_> {
    /// The treatment with coefficients of its own.
    fn coefficients(&self, obstacles: &Obstacles, [e, mu]: [bool; 2]) -> Option<Bounce> {
        let asked = |of: fn(&Surface) -> f64| {
            let mut all = obstacles.surfaces().map(|surface| of(&surface));
            let first = all.next()?;
            all.all(|other| other == first).then_some(first)
        };
        let asked = [
            asked(|surface| surface.restitution),
            asked(|surface| surface.friction[0]),
        ];
        let with = |found: [f64; 2]| {
            let wrong = |at: usize| Wrong {
                found: found[at],
                asked: asked[at],
            };
            Bounce {
                own: Own {
                    restitution: e.then(|| wrong(0)),
                    friction: mu.then(|| wrong(1)),
                    ..Own::NONE
                },
                ..self.base
            }
        };
        let start = [asked[0].unwrap_or(0.5), asked[1].unwrap_or(0.1)];
        // Where friction stops what slides, its number makes no difference.
        let starts = [start, [start[0], 0.01]];
        let found = starts
            .into_iter()
            .find_map(|start| self.solved(&with, start, [e, mu]))?;
        let sensible = found.iter().all(|number| SENSIBLE.contains(number));
        // None is a mistake of its own.
        let sensible = sensible && !(mu && found[1] < LEFT);
        let plain = |bounce: &Bounce| {
            let [a, b] = [bounce.own.restitution, bounce.own.friction];
            // What equals the scene's number is none of its own.
            [a, b]
                .into_iter()
                .flatten()
                .all(|one| Some(one.found) != one.asked)
        };
        sensible
            .then(|| self.plain(found, &with))
            .flatten()
            .filter(plain)
    }

    /// The treatment with other radii, or with surfaces elsewhere.
    fn sized(&self, obstacles: &Obstacles) -> Option<Bounce> {
        let radii = obstacles.particles().map(|one| obstacles.radius(one));
        let radii: Vec<f64> = radii.collect();
        let equal = radii.windows(2).all(|two| two[0] == two[1]);
        let radius = radii.first().copied().filter(|_| equal);
        let with = |[factor, more]: [f64; 2]| Bounce {
            own: Own {
                size: Some(Size {
                    factor,
                    more,
                    radius,
                }),
                ..Own::NONE
            },
            ..self.base
        };
        let smallest = radii.into_iter().fold(f64::INFINITY, f64::min);
        let factors = FACTORS.iter().filter(|_| smallest > 0.0);
        let factors = factors.map(|factor| with([*factor, 0.0]));
        let first = self.at.first()?;
        let mut nearer = Vec::new();
        if matches!(self.base.way.does, Way::Once(_)) && !self.base.place.says.is_empty() {
            // What is put on a surface shows where that is.
            nearer.extend(self.at.iter().map(|t| self.gap(obstacles, t.to)));
        }
        if matches!(self.base.way.does, Way::Event) {
            let gaps = [first.from, first.to].map(|k| self.gap(obstacles, k));
            let (low, high) = (gaps[0].min(gaps[1]), gaps[0].max(gaps[1]));
            let tried = (0..PLACES_TRIED).map(|k| {
                let part = f64::from(k) / f64::from(PLACES_TRIED - 1);
                low - (high - low) + 2.0 * part * (high - low)
            });
            let own = |more: f64| (smallest + more >= 0.0).then(|| with([1.0, more]));
            let left = |more: &f64| {
                let off = own(*more).and_then(|one| self.off(&one));
                off.map_or(f64::INFINITY, |off| norm(&off))
            };
            let best = tried.min_by(|a, b| left(a).total_cmp(&left(b)));
            let solved = best.and_then(|best| {
                let shifted = |[more, _]: [f64; 2]| with([1.0, more.max(-smallest)]);
                self.solved(&shifted, [best, 0.0], [true, false])
            });
            nearer.extend(solved.map(|[more, _]| more));
        }
        let fits = |bounce: &Bounce| {
            !self
                .search
                .fitting(std::slice::from_ref(self.scheme), bounce)
                .is_empty()
        };
        let factor = factors.into_iter().find(fits);
        let shifted = |[more, _]: [f64; 2]| with([1.0, more]);
        factor.or_else(|| {
            let some = nearer
                .into_iter()
                .filter(|more| more.abs() > obstacles.closed());
            some.into_iter()
                .find_map(|more| self.plain([more, 0.0], &shifted))
        })
    }

    /// The smallest gap of a row, m.
    fn gap(&self, obstacles: &Obstacles, k: usize) -> f64 {
        let rows = self.search.question.rows;
        let state: State = self.search.replay.state(k, None);
        let at = |particle: usize| three(&state.x, particle);
        let near = obstacles.near_now(&state);
        let among = near
            .pairs()
            .filter(|(_, against)| matches!(against, Against::Particle(_)));
        let gaps = obstacles
            .pairs()
            .chain(among)
            .map(|(particle, against)| obstacles.gap(particle, against, rows.time(k), at));
        gaps.fold(f64::INFINITY, f64::min)
    }

    fn off(&self, bounce: &Bounce) -> Option<Vec<f64>> {
        self.search.off(self.scheme, bounce, &self.at)
    }

    /// The numbers that leave next to nothing of the steps that are not explained; None where none do.
    fn solved(
        &self,
        with: &dyn Fn([f64; 2]) -> Bounce,
        start: [f64; 2],
        free: [bool; 2],
    ) -> Option<[f64; 2]> {
        let mut here = start;
        let mut off = self.off(&with(here))?;
        let begins = norm(&off);
        let mut least = begins;
        for _ in 0..STEPS {
            let slope = |at: usize| {
                let mut ahead = here;
                ahead[at] += SLOPE;
                if !free[at] {
                    return Some(vec![0.0; off.len()]);
                }
                let ahead = self.off(&with(ahead))?;
                Some(
                    ahead
                        .iter()
                        .zip(&off)
                        .map(|(a, b)| (a - b) / SLOPE)
                        .collect(),
                )
            };
            let slopes: Vec<Vec<f64>> = (0..2).map(slope).collect::<Option<_>>()?;
            let step = solved(&slopes, &off)?;
            let next = [here[0] - step[0], here[1] - step[1]];
            let Some(there) = self.off(&with(next)) else {
                break;
            };
            if norm(&there) >= least {
                break;
            }
            (least, here, off) = (norm(&there), next, there);
        }
        (begins > 0.0 && least <= LEFT * begins).then_some(here)
    }

    /// The treatment with the plainest of these numbers that fits.
    fn plain(&self, found: [f64; 2], with: &dyn Fn([f64; 2]) -> Bounce) -> Option<Bounce> {
        let short = |count: usize| found.map(|one| digits(one, count).parse().unwrap_or(one));
        let own = with(found).own;
        let numbers = [own.restitution, own.friction].iter().flatten().count();
        let few = self.at.len() <= numbers.max(1);
        let most = if few { SHORT } else { PLAIN };
        let all = (1..=most).map(short).chain((!few).then_some(found));
        let one = std::slice::from_ref(self.scheme);
        all.map(with)
            .find(|bounce| !self.search.fitting(one, bounce).is_empty())
    }
}
