//! From values to places on an axis, and the ticks along it.

/// How values are spread over an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    Linear,
    /// Logarithmic; the range is positive.
    Log,
    /// Linear within ±`linear` (a power of ten), one more unit per decade beyond.
    SymLog {
        linear: f64,
    },
}

/// A range of values under a scale.
#[derive(Debug, Clone, Copy)]
pub struct Axis {
    pub scale: Scale,
    /// Smallest and largest value, the first below the second.
    pub range: [f64; 2],
}

/// Values beyond this are drawn as this, so that no difference overflows.
pub const HUGE: f64 = 1e300;

impl Axis {
    /// `range` widened to something that can be divided by: a constant gets room around it.
    pub fn linear(range: [f64; 2]) -> Axis {
        Axis {
            scale: Scale::Linear,
            range: opened(range),
        }
    }

    /// Logarithmic where both ends are positive and lie apart, else linear.
    pub fn logarithmic([lo, hi]: [f64; 2]) -> Axis {
        if lo > 1.0 / HUGE && hi < HUGE && hi > 1.001 * lo {
            Axis {
                scale: Scale::Log,
                range: [lo, hi],
            }
        } else {
            Axis::linear([lo, hi])
        }
    }

    /// 0 at the lower end, 1 at the upper, beyond them outside.
    pub fn place(&self, value: f64) -> f64 {
        let [lo, hi] = self.range.map(|end| self.forward(end));
        (self.forward(value) - lo) / (hi - lo)
    }

    fn forward(&self, value: f64) -> f64 {
        let value = value.clamp(-HUGE, HUGE);
        match self.scale {
            Scale::Linear => value,
            Scale::Log => value.max(1.0 / HUGE).log10(),
            Scale::SymLog { linear } if value.abs() <= linear => value / linear,
            Scale::SymLog { linear } => {
                // Logarithms subtracted, not a quotient taken: that could overflow.
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
        let mut ticks = vec![(0.0, "0".to_string())];
        // The first as far from zero as from the second.
        for exponent in (first + every as i32 - 1..=300).step_by(every) {
            let value = 10_f64.powi(exponent);
            for (sign, value) in [("", value), ("−", -value)] {
                if self.range[0] <= value && value <= self.range[1] {
                    ticks.push((value, format!("{sign}{}", power_of_ten(exponent))));
                }
            }
        }
        ticks
    }
}

/// Room around a constant, order between the ends, nothing beyond [`HUGE`].
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

/// Powers of ten, every n-th where there are many; 1, 2, 5 times them where there are few.
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
    let factor = [1.0, 2.0, 5.0]
        .into_iter()
        .find(|f| f * power >= least * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}

/// As many digits as tell neighbouring ticks apart; scientific for very large or small axes.
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
