//! Factors of channels that bring a scheme nearest to recorded rows: Gauss-Newton on one-step replays.

use super::candidate::Candidate;
use super::channels::{self, Channel};
use super::mistakes::Mistake;
use super::replay::{FIT, Replay};
use super::transition::Transition;
use crate::physics::{ParticleSystem, State};
use crate::scene::Scene;
use nalgebra::{DMatrix, DVector};

/// Most Gauss-Newton steps.
const STEPS: usize = 12;
/// A step that leaves more than this part of the difference is slow.
const SLOW: f64 = 0.5;
/// Most times that one of them is halved.
const HALVINGS: usize = 3;
/// Step of the slopes' differences.
const STEP: f64 = 1e-4;
/// What turns to nothing has no direction.
const NOTHING: f64 = 1e-3;

/// A scheme that deviations are looked for in.
#[derive(Clone)]
pub(super) struct Base {
    pub(super) scheme: Candidate,
    /// What its forces are, where they are not the scene's own.
    pub(super) mistake: Option<&'static Mistake>,
}

impl Base {
    /// The scheme with these factors; None where the scene then has nothing for the mistake to change.
    pub(super) fn varied(&self, scene: &Scene, factors: &[(Channel, f64)]) -> Option<Candidate> {
        let mut scheme = self.scheme.clone();
        for (channel, factor) in factors {
            scheme = channel.step(scheme, 3 * scene.particles.len(), *factor);
        }
        let Some(wrong) = channels::changed(scene, factors.iter().copied()) else {
            return Some(scheme);
        };
        let forces = match self.mistake {
            Some(mistake) => mistake.forces(&wrong)?,
            None => ParticleSystem::new(&wrong),
        };
        Some(scheme.under(&forces))
    }
}

/// The states where a scheme arrives from the starts of the fitted transitions; None where it cannot.
type Arrive<'a> = dyn Fn(&Candidate) -> Option<Vec<State>> + Send + Sync + 'a;

/// A scheme and what it leaves of the rows that it is fitted to.
pub(super) struct Model<'a> {
    pub(super) scene: &'a Scene,
    pub(super) replay: &'a Replay<'a>,
    pub(super) base: Base,
    /// The transitions, with what rounding explains of each number.
    at: Vec<(Transition, Vec<f64>)>,
    arrive: Box<Arrive<'a>>,
    /// Predicted minus recorded, in units.
    pub(super) residuals: DVector<f64>,
}

/// A channel and how residuals change with its factor.
pub(super) struct Slope {
    pub(super) channel: Channel,
    slope: DVector<f64>,
}

/// Factors, the scheme with them, and what they leave.
pub(super) struct Fit {
    pub(super) candidate: Candidate,
    pub(super) factors: Vec<(Channel, f64)>,
    pub(super) residuals: DVector<f64>,
    /// Whether all factors, or the values they make, are numbers that a person would have written.
    pub(super) plain: bool,
    /// How many factors were fitted; some may have been found to be 1.
    pub(super) numbers: usize,
}

impl<'a> Model<'a> {
    /// None where the scheme cannot take the steps.
    pub(super) fn new(
        scene: &'a Scene,
        replay: &'a Replay<'a>,
        base: Base,
        at: Vec<(Transition, Vec<f64>)>,
        arrive: Box<Arrive<'a>>,
    ) -> Option<Self> {
        let residuals = DVector::zeros(0);
        let model = Self {
            scene,
            replay,
            base,
            at,
            arrive,
            residuals,
        };
        let residuals = model.residuals_of(&model.base.scheme)?;
        Some(Self { residuals, ..model })
    }

    fn residuals_of(&self, candidate: &Candidate) -> Option<DVector<f64>> {
        let mut all = Vec::new();
        for ((transition, units), state) in self.at.iter().zip((self.arrive)(candidate)?) {
            all.extend(self.replay.off(transition, &state, units));
        }
        let finite = all.iter().all(|r| r.is_finite());
        finite.then(|| DVector::from_vec(all))
    }

    fn residuals_at(&self, factors: &[(Channel, f64)]) -> Option<DVector<f64>> {
        self.residuals_of(&self.base.varied(self.scene, factors)?)
    }

    /// The slopes of these channels; None where the scheme cannot take the steps with some of them.
    pub(super) fn slopes(&self, channels: &[Channel]) -> Option<Vec<Slope>> {
        let suiting = channels.iter().filter(|c| c.suits(&self.base.scheme));
        suiting.map(|channel| self.slope(*channel)).collect()
    }

    /// The fits with one factor more, from where this one ends: the `most` that the linear model finds best there.
    pub(super) fn grown(&self, fit: &Fit, channels: &[Channel], most: usize) -> Vec<Fit> {
        let own =
            (0..fit.factors.len()).map(|place| self.slope_at(&fit.factors, &fit.residuals, place));
        let Some(own) = own.collect::<Option<Vec<DVector<f64>>>>() else {
            return Vec::new();
        };
        let new = |channel: &&Channel| fit.factors.iter().all(|(own, _)| own != *channel);
        let larger = channels.iter().filter(new).filter_map(|channel| {
            let mut factors = fit.factors.clone();
            factors.push((*channel, 1.0));
            let slope = self.slope_at(&factors, &fit.residuals, factors.len() - 1)?;
            let slopes = [&own[..], &[slope]].concat();
            Some((left(&slopes, &fit.residuals)?, factors, slopes))
        });
        let mut larger: Vec<_> = larger.collect();
        larger.sort_by(|a, b| a.0.total_cmp(&b.0));
        larger.truncate(most);
        let fits = larger.into_iter().filter_map(|(_, factors, slopes)| {
            self.descend(factors, slopes, fit.residuals.clone())
        });
        fits.collect()
    }

    /// How residuals change with one of these factors.
    fn slope_at(
        &self,
        factors: &[(Channel, f64)],
        residuals: &DVector<f64>,
        place: usize,
    ) -> Option<DVector<f64>> {
        let mut moved = factors.to_vec();
        moved[place].1 += STEP;
        Some((self.residuals_at(&moved)? - residuals) / STEP)
    }

    pub(super) fn slope(&self, channel: Channel) -> Option<Slope> {
        let moved = self.residuals_at(&[(channel, 1.0 + STEP)])?;
        let slope = (moved - self.unvaried(channel)?) / STEP;
        Some(Slope { channel, slope })
    }

    /// The residuals where the factor of this channel is 1.
    fn unvaried(&self, channel: Channel) -> Option<DVector<f64>> {
        if channel.switches() {
            self.residuals_at(&[(channel, 1.0)])
        } else {
            Some(self.residuals.clone())
        }
    }

    /// What the linear model leaves of the difference.
    pub(super) fn predicted(&self, set: &[&Slope]) -> Option<f64> {
        let slopes: Vec<DVector<f64>> = set.iter().map(|s| s.slope.clone()).collect();
        left(&slopes, &self.residuals)
    }

    /// The factors of these channels, from the scene's own numbers; None where they are none. One that switches is
    /// fitted alone.
    pub(super) fn fit(&self, set: &[&Slope]) -> Option<Fit> {
        let factors: Vec<(Channel, f64)> = set.iter().map(|s| (s.channel, 1.0)).collect();
        let slopes = set.iter().map(|s| s.slope.clone()).collect();
        let residuals = self.unvaried(factors.first()?.0)?;
        self.descend(factors, slopes, residuals)
    }

    /// The fit from these factors, where residuals have these slopes.
    fn descend(
        &self,
        mut factors: Vec<(Channel, f64)>,
        mut slopes: Vec<DVector<f64>>,
        mut residuals: DVector<f64>,
    ) -> Option<Fit> {
        for taken in 0..STEPS {
            let mut step = least_squares(&slopes, &residuals)?;
            let here = residuals.norm();
            for halving in 0..=HALVINGS {
                let moved = factors.iter().zip(step.iter());
                let moved: Vec<(Channel, f64)> = moved.map(|((c, f), s)| (*c, f - s)).collect();
                let next = self.residuals_at(&moved);
                let nearer = next.as_ref().is_some_and(|next| next.norm() <= here);
                if let (true, Some(next)) = (nearer || halving == HALVINGS, next) {
                    (factors, residuals) = (moved, next);
                    break;
                }
                step *= 0.5;
            }
            let largest = factors.iter().fold(0.0, |m: f64, f| m.max(f.1.abs()));
            if step.amax() <= 1e-13 * (1.0 + largest) {
                break;
            }
            if taken > 1 && residuals.norm() > SLOW * here {
                // It converges to something else than rounding.
                break;
            }
            for (place, slope) in slopes.iter_mut().enumerate() {
                let mut moved = factors.clone();
                let by = STEP.min(step.amax().max(1e-7));
                moved[place].1 += by;
                *slope = (self.residuals_at(&moved)? - &residuals) / by;
            }
        }
        // A number that a person would have written is taken for the one meant, if it does as well.
        let mut plain = true;
        for (place, slope) in slopes.iter().enumerate() {
            let (channel, factor) = factors[place];
            let within = FIT / slope.norm();
            let h = self.replay.rows.timestep;
            let rounded = channel
                .rounded(self.scene, h, factor, within)
                .and_then(|rounded| {
                    let mut factors = factors.clone();
                    factors[place].1 = rounded;
                    let residuals = self.residuals_at(&factors)?;
                    (residuals.amax() <= FIT).then_some((factors, residuals))
                });
            plain &= rounded.is_some();
            if let Some(rounded) = rounded {
                (factors, residuals) = rounded;
            }
        }
        // What is as the scene has it is no deviation.
        factors.retain(|(channel, factor)| channel.switches() || *factor != 1.0);
        if factors.is_empty() {
            return None;
        }
        let says = |(channel, factor): &(Channel, f64)| {
            factor.is_finite() && !(channel.switches() && factor.abs() < NOTHING)
        };
        factors.iter().all(says).then_some(())?;
        Some(Fit {
            candidate: self.base.varied(self.scene, &factors)?,
            factors,
            residuals,
            plain,
            numbers: slopes.len(),
        })
    }
}

/// What the linear model leaves.
fn left(slopes: &[DVector<f64>], residuals: &DVector<f64>) -> Option<f64> {
    let step = least_squares(slopes, residuals)?;
    Some((residuals - DMatrix::from_columns(slopes) * step).norm())
}

/// The steps that make slopes times them the residuals, in the sense of least squares; None where slopes
/// are no numbers, or one changes nothing.
fn least_squares(slopes: &[DVector<f64>], residuals: &DVector<f64>) -> Option<DVector<f64>> {
    let norms: Vec<f64> = slopes.iter().map(|slope| slope.norm()).collect();
    if norms.iter().any(|norm| !norm.is_finite() || *norm < 1.0) {
        return None;
    }
    let columns: Vec<DVector<f64>> = slopes.iter().zip(&norms).map(|(s, n)| s / *n).collect();
    let matrix = DMatrix::from_columns(&columns);
    // Channels that are nearly parallel together explain no more than one of them.
    let mut step = matrix.svd(true, true).solve(residuals, 1e-9).ok()?;
    for (step, norm) in step.iter_mut().zip(&norms) {
        *step /= norm;
    }
    step.iter().all(|s| s.is_finite()).then_some(step)
}
