//! A trajectory as rows of data, as files and other programs give it.

/// States a whole number of steps apart, not necessarily always the same number.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    /// Length of a step, s.
    pub timestep: f64,
    /// Coordinates of a state, 3 a particle.
    pub dim: usize,
    /// Step number of each row, strictly increasing.
    pub steps: Vec<u64>,
    /// Positions, m: one row after the other.
    pub x: Vec<f64>,
    /// Velocities, m/s, as `x`; None where only positions are known.
    pub v: Option<Vec<f64>>,
    /// How exactly the positions were written down.
    pub precision: Precision,
    /// How exactly the velocities were written down, often otherwise; as the positions where there
    /// are none.
    pub precision_v: Precision,
    /// The last row of the file may have been cut inside its last number, and is not among these.
    pub cut: bool,
}

/// How exactly data is given. Rounding to it is the best a replay can be held to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    Double,
    Single,
    /// Singles, printed with this many digits after the decimal point: small ones are rounded to these.
    SingleDecimals(u32),
    /// Rounded to this many digits after the decimal point.
    Decimals(u32),
    /// Rounded to this many significant digits.
    Digits(u32),
}

impl Precision {
    /// Half a unit of the last digit `value` is given to, in the value's unit.
    pub fn half_unit(self, value: f64) -> f64 {
        let magnitude = value.abs();
        // Half the spacing of numbers at this magnitude, at most.
        let double = magnitude.max(f64::MIN_POSITIVE) * (0.5 * f64::EPSILON);
        match self {
            Self::Double => double,
            Self::Single => {
                magnitude.max(f64::from(f32::MIN_POSITIVE)) * (0.5 * f64::from(f32::EPSILON))
            }
            Self::SingleDecimals(digits) => {
                let single = Self::Single.half_unit(value);
                single.max(Self::Decimals(digits).half_unit(value))
            }
            // Text may give more digits than the double has that was written down.
            Self::Decimals(digits) => double.max(0.5 * power_of_ten(-i64::from(digits))),
            Self::Digits(_) if magnitude == 0.0 => double,
            Self::Digits(digits) => {
                let exponent = magnitude.log10().floor() as i64;
                double.max(0.5 * power_of_ten(exponent + 1 - i64::from(digits)))
            }
        }
    }
}

fn power_of_ten(exponent: i64) -> f64 {
    10f64.powi(exponent.clamp(-400, 400) as i32)
}

impl Rows {
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// Half a unit of the last digit that a value of coordinate `i` is given to: positions first,
    /// then velocities.
    pub fn half_unit(&self, i: usize, value: f64) -> f64 {
        let precision = if i < self.dim {
            self.precision
        } else {
            self.precision_v
        };
        precision.half_unit(value)
    }

    /// Seconds since the start.
    pub fn time(&self, k: usize) -> f64 {
        self.steps[k] as f64 * self.timestep
    }

    pub fn x(&self, k: usize) -> &[f64] {
        &self.x[k * self.dim..(k + 1) * self.dim]
    }

    pub fn v(&self, k: usize) -> Option<&[f64]> {
        let v = self.v.as_ref()?;
        Some(&v[k * self.dim..(k + 1) * self.dim])
    }
}
