//! Judges one value: is it there, is it a number of its kind, does the particle exist.

use super::leaf::Numbers;
use super::limits::Quantity;
use super::locate::Problem;
use super::number::Number;
use super::path::At;

/// The value, or an error at its container.
pub(super) fn required<T>(value: Option<T>, at: At, help: &str) -> Result<T, Problem> {
    value.ok_or_else(|| Problem::new(at, "missing", help))
}

/// The number as a quantity: finite and within its bounds.
pub(super) fn quantity(number: Number, kind: Quantity, at: At) -> Result<f64, Problem> {
    let x = number.value();
    let Quantity { low, high, unit } = kind;
    if (low..=high).contains(&x) {
        return Ok(x);
    }
    let expected = if !x.is_finite() {
        format!("a finite number ({unit})")
    } else if low > 0.0 && x <= 0.0 {
        format!("a positive number ({unit})")
    } else if low == 0.0 && x < 0.0 {
        format!("a number of at least 0 ({unit})")
    } else if x > high {
        format!("at most {high:e} ({unit})")
    } else {
        format!("at least {low:e} ({unit})")
    };
    Err(Problem::new(
        at,
        format!("expected {expected}, found {number}"),
        "",
    ))
}

/// The quantity, or what holds where the file is silent.
pub(super) fn quantity_or(
    number: Option<Number>,
    default: f64,
    kind: Quantity,
    at: At,
) -> Result<f64, Problem> {
    number.map_or(Ok(default), |number| quantity(number, kind, at))
}

/// Each of the numbers as a quantity.
pub(super) fn quantities<const N: usize>(
    numbers: Numbers<N>,
    kind: Quantity,
    at: At,
) -> Result<[f64; N], Problem> {
    let mut values = [0.0; N];
    for (i, (value, number)) in values.iter_mut().zip(numbers.0).enumerate() {
        *value = quantity(number, kind, at.index(i))?;
    }
    Ok(values)
}

/// The id of one of `count` particles.
pub(super) fn particle(number: Number, count: usize, at: At) -> Result<usize, Problem> {
    number.whole().filter(|id| *id < count).ok_or_else(|| {
        let last = count.saturating_sub(1);
        let message = format!("expected a particle from 0 to {last}, found {number}");
        let help = match number {
            Number::Real(_) => "ids are whole numbers",
            Number::Whole(_) => "ids count from 0, in the order of `particles`",
        };
        Problem::new(at, message, help)
    })
}

/// Two different particles.
pub(super) fn ends(numbers: Numbers<2>, count: usize, at: At) -> Result<[usize; 2], Problem> {
    let [a, b] = numbers.0;
    let ends = [
        particle(a, count, at.index(0))?,
        particle(b, count, at.index(1))?,
    ];
    if ends[0] == ends[1] {
        let message = format!("expected two different particles, found {a} twice");
        return Err(Problem::new(at, message, ""));
    }
    Ok(ends)
}
