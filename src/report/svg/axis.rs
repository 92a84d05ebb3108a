//! The axis of a chart: its range, the map from values to places, and its ticks.

/// How values are spread over an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    Linear,
    /// Logarithmic; the range is positive.
    Log,
    /// Linear within ±`linear` (a power of ten); beyond, each decade is one more unit.
    SymLog {
        linear: f64,
    },
}

/// A range of values under a scale. Not to be confused with the direction in space,
/// [`scene::Axis`](crate::scene::Axis).
#[derive(Debug, Clone, Copy)]
pub struct ChartAxis {
    pub scale: Scale,
    /// Smallest and largest value, the first below the second.
    pub range: [f64; 2],
}

/// Values beyond this are drawn as this, so that no difference overflows.
pub const HUGE: f64 = 1e300;

impl ChartAxis {
    /// A linear axis. A range without a width gets room around it, so that it can be divided by.
    pub fn linear(range: [f64; 2]) -> ChartAxis {
        let (scale, range) = (Scale::Linear, opened(range));
        ChartAxis { scale, range }
    }

    /// An axis that is logarithmic where both ends are positive and lie apart, else linear.
    pub fn logarithmic(range: [f64; 2]) -> ChartAxis {
        let ([lo, hi], scale) = (range, Scale::Log);
        if lo > 1.0 / HUGE && hi < HUGE && hi > 1.001 * lo {
            return ChartAxis { scale, range };
        }
        ChartAxis::linear(range)
    }

    /// The place of a value: 0 at the lower end, 1 at the upper, outside beyond them.
    pub fn place(&self, value: f64) -> f64 {
        let [lo, hi] = self.range.map(|end| self.forward(end));
        (self.forward(value) - lo) / (hi - lo)
    }

    /// The value at a part of the axis: the inverse of [`ChartAxis::place`].
    pub fn at(&self, part: f64) -> f64 {
        let [lo, hi] = self.range.map(|end| self.forward(end));
        let forward = lo + part * (hi - lo);
        match self.scale {
            Scale::Linear => forward,
            Scale::Log => 10_f64.powf(forward),
            Scale::SymLog { linear } if forward.abs() <= 1.0 => forward * linear,
            Scale::SymLog { linear } => {
                forward.signum() * linear * 10_f64.powf(forward.abs() - 1.0)
            }
        }
    }

    /// The axis over cells of one size, from the outer edge of the first to that of the last, given their
    /// middles in ascending order. It is logarithmic where all are positive.
    pub fn of_cells(middles: &[f64]) -> ChartAxis {
        let [first, last] = [middles.first(), middles.last()].map(|v| v.copied().unwrap_or(1.0));
        let axis = ChartAxis::logarithmic([first, last]);
        let half = 0.5 / (middles.len().max(2) - 1) as f64;
        ChartAxis {
            range: [axis.at(-half), axis.at(1.0 + half)],
            ..axis
        }
    }

    fn forward(&self, value: f64) -> f64 {
        let value = value.clamp(-HUGE, HUGE);
        match self.scale {
            Scale::Linear => value,
            Scale::Log => value.max(1.0 / HUGE).log10(),
            Scale::SymLog { linear } if value.abs() <= linear => value / linear,
            Scale::SymLog { linear } => {
                // Logarithms are subtracted, since a quotient could overflow.
                value.signum() * (1.0 + value.abs().log10() - linear.log10())
            }
        }
    }

    /// Values and their labels, about `wanted` of them.
    pub fn ticks(&self, wanted: usize) -> Vec<(f64, String)> {
        match self.scale {
            Scale::Linear => linear_ticks(self.range, wanted),
            Scale::Log => log_ticks(self.range, wanted),
            Scale::SymLog { linear } => self.decades(linear, wanted),
        }
    }

    /// Zero and every n-th power of ten on both sides.
    fn decades(&self, linear: f64, wanted: usize) -> Vec<(f64, String)> {
        let first = linear.log10().round() as i32;
        let [lo, hi] = self.range.map(|end| self.forward(end));
        let every = ((hi - lo) / wanted.max(1) as f64).ceil().max(1.0) as usize;
        // The first tick is as far from zero as from the second.
        let exponents = (first + every as i32 - 1..=300).step_by(every);
        let both = exponents.flat_map(|exponent| {
            let (value, label) = (10_f64.powi(exponent), power_of_ten(exponent));
            [(value, label.clone()), (-value, format!("−{label}"))]
        });
        let inside = both.filter(|(value, _)| (self.range[0]..=self.range[1]).contains(value));
        [(0.0, "0".to_string())].into_iter().chain(inside).collect()
    }
}

/// The smallest and the largest of the finite values; `None` without any. The range of ranges takes their
/// ends, flattened.
pub fn range(values: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    let finite = values.into_iter().filter(|v| v.is_finite());
    finite.fold(None, |range, v| {
        let [lo, hi] = range.unwrap_or([v, v]);
        Some([v.min(lo), v.max(hi)])
    })
}

/// The range of points along x (0) or y (1).
pub fn span(points: &[[f64; 2]], axis: usize) -> Option<[f64; 2]> {
    range(points.iter().map(|point| point[axis]))
}

/// The range with room on both sides, as a part of itself.
pub fn padded([lo, hi]: [f64; 2], part: f64) -> [f64; 2] {
    let room = part * (hi / 2.0 - lo / 2.0) * 2.0;
    [lo - room, hi + room]
}

/// The range of the calm lines, widened for the wild ones (growing, diverged) by at most half the calm span
/// on each side, so that the calm lines stay readable. `spans` says of each line whether it is wild, and its
/// span. Where all lines are wild, the one with the smallest span counts as calm.
pub fn tamed(spans: impl IntoIterator<Item = (bool, [f64; 2])>) -> Option<[f64; 2]> {
    let (wild, calm): (Vec<_>, Vec<_>) = spans.into_iter().partition(|(is_wild, _)| *is_wild);
    let size = |(_, [lo, hi]): &(bool, [f64; 2])| hi - lo;
    let smallest = wild.iter().min_by(|a, b| size(a).total_cmp(&size(b)));
    let calm = range(calm.into_iter().flat_map(|(_, span)| span));
    let core = calm.or(smallest.map(|(_, span)| *span))?;
    let room = (core[1] - core[0]) / 2.0;
    Some(wild.iter().fold(core, |[lo, hi], (_, span)| {
        [
            lo.min(span[0].max(core[0] - room)),
            hi.max(span[1].min(core[1] + room)),
        ]
    }))
}

/// The range within [`HUGE`], with room around a constant.
fn opened([lo, hi]: [f64; 2]) -> [f64; 2] {
    let (lo, hi) = (lo.clamp(-HUGE, HUGE), hi.clamp(-HUGE, HUGE));
    let size = lo.abs().max(hi.abs());
    if size < 1e-290 {
        return [-1.0, 1.0];
    }
    // A millionth of the size is the finest a label can show.
    if hi - lo < 1e-6 * size {
        let middle = lo / 2.0 + hi / 2.0;
        return [middle - 1e-6 * size, middle + 1e-6 * size];
    }
    [lo, hi]
}

fn linear_ticks([lo, hi]: [f64; 2], wanted: usize) -> Vec<(f64, String)> {
    let step = step((hi - lo) / wanted.max(1) as f64);
    let (first, last) = ((lo / step - 1e-9).ceil(), (hi / step + 1e-9).floor());
    let size = lo.abs().max(hi.abs());
    (0..=(last - first).clamp(0.0, 50.0) as u32)
        .map(|i| {
            let value = (first + f64::from(i)) * step;
            (value, label(value, step, size))
        })
        .collect()
}

/// Ticks at powers of ten: every n-th where there are many; also 2 and 5 times them where there are few.
fn log_ticks([lo, hi]: [f64; 2], wanted: usize) -> Vec<(f64, String)> {
    let inside = |value: &f64| (lo * (1.0 - 1e-9)..=hi * (1.0 + 1e-9)).contains(value);
    let (first, last) = (lo.log10().floor() as i32, hi.log10().ceil() as i32);
    let decades = (first..=last).filter(|e| inside(&10_f64.powi(*e)));
    let decades: Vec<i32> = decades.collect();
    if decades.len() >= 2 {
        let every = decades.len().div_ceil(wanted.max(1));
        let kept = decades.into_iter().filter(|e| e % every as i32 == 0);
        return kept.map(|e| (10_f64.powi(e), power_of_ten(e))).collect();
    }
    (first..=last)
        .flat_map(|e| [1.0, 2.0, 5.0].map(|factor| factor * 10_f64.powi(e)))
        .filter(inside)
        .take(wanted.max(2))
        .map(|value| (value, format!("{value}").replace('-', "−")))
        .collect()
}

/// The smallest of 1, 2, 5 times a power of ten that is not below `least`.
fn step(least: f64) -> f64 {
    let power = 10_f64.powi(least.log10().floor() as i32);
    let mut steps = [1.0, 2.0, 5.0].into_iter().map(|factor| factor * power);
    steps
        .find(|step| *step >= least * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

/// A tick's label, with enough digits to tell neighbours apart; scientific for very large or small axes.
fn label(value: f64, step: f64, size: f64) -> String {
    if value.abs() < 0.5 * step {
        return "0".into();
    }
    let finest = (step.log10() + 1e-9).floor() as i32;
    let text = if size >= 1e5 || step < 1e-4 {
        let digits = (value.abs().log10().floor() as i32 - finest).clamp(0, 12) as usize;
        format!("{value:.digits$e}")
    } else {
        format!("{value:.*}", (-finest).max(0) as usize)
    };
    text.replace('-', "−")
}

/// `1`, `10`, `100`, `10³`, `10⁻²`.
fn power_of_ten(exponent: i32) -> String {
    if (0..=2).contains(&exponent) {
        return ["1", "10", "100"][exponent as usize].into();
    }
    let superscript = |c: char| match c.to_digit(10) {
        Some(digit) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize],
        None => '⁻',
    };
    let exponent: String = exponent.to_string().chars().map(superscript).collect();
    format!("10{exponent}")
}
