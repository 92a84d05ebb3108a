//! Limits on the size of a scene and of its numbers.
//!
//! The bounds lie far outside any sensible scene. They keep sums, squares and products of accepted
//! numbers (energies, k/m, 1/h²) inside the range of a double, so that a NaN met later is the
//! integrator's doing and not the file's. A bound that only one key has stands on that key's row.

use super::error::Refusal;
use super::expectation::Names;
use super::values::Number;
use super::words::{did_you_mean, shorten};

/// The largest file read, in bytes: 64 MiB, about 300,000 particles.
pub const FILE_BYTES: usize = 64 << 20;

/// The deepest nesting of flow collections; a scene needs four.
pub const NESTING: usize = 64;

/// The most steps a run may take: duration / timestep.
pub const STEPS: f64 = 1e9;

/// The longest name, in characters.
pub const NAME_CHARS: usize = 200;

/// The most entries of `expect`, of one engine in it, and of one list of words there. YAML aliases could
/// multiply them.
pub const EXPECTED: usize = 64;

/// The longest key or word under `expect`, in bytes.
pub const WORD_BYTES: usize = 200;

/// The smallest initial distance of two attracting particles, m. At 0 the force is infinite.
pub const ATTRACTION_DISTANCE: f64 = 1e-12;

/// The largest component of a driven particle's velocity, m/s, and of its acceleration, m/s²: that of the widest and
/// fastest sine. The rows of a table could lie so near in time that neither is finite.
pub const DRIVEN_SPEED: f64 = 1e12;
pub const DRIVEN_ACCELERATION: f64 = 1e36;

/// The values a number may take, and its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The smallest value.
    pub low: f64,
    /// The largest value.
    pub high: f64,
    /// The unit, as messages write it.
    pub unit: &'static str,
}

impl Bounds {
    pub(super) const fn signed(high: f64, unit: &'static str) -> Self {
        Self::from(-high, high, unit)
    }

    pub(super) const fn not_negative(high: f64, unit: &'static str) -> Self {
        Self::from(0.0, high, unit)
    }

    pub(super) const fn from(low: f64, high: f64, unit: &'static str) -> Self {
        Self { low, high, unit }
    }

    /// The number, if it is finite and within the bounds.
    pub(super) fn judge(self, number: Number) -> Result<f64, Refusal> {
        let x = number.value();
        let Bounds { low, high, unit } = self;
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
            format!("at most {} ({unit})", plain(high))
        } else {
            format!("at least {} ({unit})", plain(low))
        };
        let help = match unit {
            "rad" => "angles are in radians: 180 degrees are 3.14159",
            _ => "",
        };
        Refusal::because(format!("expected {expected}, found {number}"), help)
    }
}

/// A bound as people write it: `3.14159`, `1e12`.
fn plain(bound: f64) -> String {
    match bound.abs() {
        b if (1e-3..1e4).contains(&b) => format!("{}", (bound * 1e5).round() / 1e5),
        _ => format!("{bound:e}"),
    }
}

/// A coordinate of a position, and of `plot.y_range`.
pub const POSITION: Bounds = Bounds::signed(1e12, "m");
/// A radius or half extent of an obstacle.
pub const OBSTACLE: Bounds = Bounds::from(1e-30, 1e12, "m");
/// The last vertex of a mesh.
pub const VERTICES: f64 = 1e7;
/// A spring's stiffness.
pub const STIFFNESS: Bounds = Bounds::not_negative(1e18, "N/m");
/// Rest lengths over the distances at the start.
pub const REST_RATIO: Bounds = Bounds::not_negative(1e6, "a ratio");
/// An acceleration of gravity, or a component of it.
pub const GRAVITY: Bounds = Bounds::signed(1e12, "m/s²");
/// The timestep.
pub const TIMESTEP: Bounds = Bounds::from(1e-30, 1e12, "s");
/// The simulated time.
pub const DURATION: Bounds = Bounds::from(1e-30, 1e12, "s");
/// A bound of an expectation.
pub const BOUND: Bounds = Bounds::signed(f64::MAX, "in the key's unit");

/// What a text may be, said twice: for reading, with advice, and for the schema.
#[derive(Debug)]
pub struct Form {
    /// Accepts a text or refuses it.
    pub(super) judge: fn(&str) -> Result<(), Refusal>,
    /// The texts that it accepts, as a regular expression of ECMA-262.
    pub pattern: &'static str,
}

/// A scene's name.
pub const NAME: Form = Form {
    judge: name,
    pattern: r"^(?=.*\S)[^\u0000-\u001f\u007f-\u009f]{1,200}$",
};
/// A scene's description.
pub const DESCRIPTION: Form = Form {
    judge: description,
    pattern: r"^[^\u0000-\u0008\u000b-\u001f\u007f-\u009f]*$",
};
/// The name of another program.
pub const EXTERNAL: Form = Form {
    judge: external,
    pattern: r"^[\p{Alphabetic}\p{N}][\p{Alphabetic}\p{N}_.+-]{0,31}$",
};

/// Checks a scene's name.
fn name(name: &str) -> Result<(), Refusal> {
    if name.trim().is_empty() {
        let message = "expected a name, found none";
        return Refusal::because(message, "without the key it is the file's");
    }
    if name.chars().count() > NAME_CHARS {
        let message = format!("expected at most {NAME_CHARS} characters");
        return Refusal::because(message, "the rest may go into `description`");
    }
    if name.contains(char::is_control) {
        return Refusal::because("expected one line without control characters", "");
    }
    Ok(())
}

/// Checks that reports may print the text: an escape sequence would reach the terminal.
fn description(text: &str) -> Result<(), Refusal> {
    if text.contains(|c: char| c.is_control() && !matches!(c, '\n' | '\t')) {
        return Refusal::because("expected text without control characters", "");
    }
    Ok(())
}

/// The longest name of another program, in characters; longer ones would push numbers out of tables.
pub const EXTERNAL_CHARS: usize = 32;

/// Checks the name of another program, which stands in tables, figures and names of files.
///
/// # Errors
/// A [`Refusal`] that says what a name is made of.
pub fn external(name: &str) -> Result<(), Refusal> {
    let plain = |c: char| c.is_alphanumeric() || "_.+-".contains(c);
    let starts = name.starts_with(char::is_alphanumeric);
    let short = name.chars().count() <= EXTERNAL_CHARS;
    if starts && short && name.chars().all(plain) {
        return Ok(());
    }
    Refusal::because(
        format!(
            "expected a name of 1 to {EXTERNAL_CHARS} letters, digits, `_`, `.`, `+` and `-`, beginning with a \
             letter or digit, found `{}`",
            shorten(name)
        ),
        "",
    )
}

/// The id of the integrator, which must exist.
pub(super) fn method<'a>(word: &'a str, names: &Names) -> Result<&'a str, Refusal> {
    let id = names.meant(word);
    known(id, &names.methods, "integrator")?;
    Ok(id)
}

/// Checks that the word is one of those known.
pub(super) fn known(word: &str, words: &[&str], what: &str) -> Result<(), Refusal> {
    if words.contains(&word) {
        return Ok(());
    }
    let (word, list) = (shorten(word), words.join(", "));
    let message = format!("unknown {what} `{word}`: expected one of {list}");
    Refusal::because(message, did_you_mean(&word, words).unwrap_or_default())
}
