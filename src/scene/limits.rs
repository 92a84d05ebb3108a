//! How large a scene and its numbers may be.
//!
//! The bounds lie far outside any sensible scene. They keep sums, squares and products of accepted
//! numbers (energies, k/m, 1/h²) inside the range of a double, so that a NaN met later is the
//! integrator's doing and not the file's.

/// The largest file read, in bytes: 64 MiB, about 300,000 particles.
pub const FILE_BYTES: usize = 64 << 20;

/// The deepest nesting of flow collections; a scene needs four.
pub const NESTING: usize = 64;

/// The most steps a run may take: duration / timestep.
pub const STEPS: f64 = 1e9;

/// The longest name, in characters.
pub const NAME_CHARS: usize = 200;

/// The most entries of `expect`, of one engine in it, and of one list of words there: an alias could
/// multiply them.
pub const EXPECTED: usize = 64;

/// The longest key or word under `expect`, in bytes.
pub const WORD_BYTES: usize = 200;

/// What a number stands for, and the values it may take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// The smallest value.
    pub low: f64,
    /// The largest value.
    pub high: f64,
    /// Its unit, as messages write it.
    pub unit: &'static str,
}

const fn signed(high: f64, unit: &'static str) -> Quantity {
    Quantity {
        low: -high,
        high,
        unit,
    }
}

const fn not_negative(high: f64, unit: &'static str) -> Quantity {
    Quantity {
        low: 0.0,
        high,
        unit,
    }
}

const fn positive(low: f64, high: f64, unit: &'static str) -> Quantity {
    Quantity { low, high, unit }
}

/// A coordinate of a position, and of `plot.y_range`.
pub const POSITION: Quantity = signed(1e12, "m");
/// A component of a velocity.
pub const VELOCITY: Quantity = signed(1e12, "m/s");
/// A particle's mass.
pub const MASS: Quantity = positive(1e-30, 1e30, "kg");
/// A particle's radius.
pub const RADIUS: Quantity = not_negative(1e12, "m");
/// A particle's linear drag coefficient.
pub const DRAG: Quantity = not_negative(1e18, "N s/m");
/// A spring's stiffness.
pub const STIFFNESS: Quantity = not_negative(1e18, "N/m");
/// A spring's cubic stiffness.
pub const CUBIC: Quantity = not_negative(1e18, "N/m³");
/// A spring's damping.
pub const DAMPING: Quantity = not_negative(1e18, "N s/m");
/// A spring's rest length.
pub const REST_LENGTH: Quantity = not_negative(1e12, "m");
/// The constant of a pairwise attraction; negative repels.
pub const G: Quantity = signed(1e30, "N m²/kg²");
/// A component of the wind's direction, before it is normalised.
pub const DIRECTION: Quantity = signed(1e12, "any unit");
/// The wind's force; negative blows the other way.
pub const WIND: Quantity = signed(1e18, "N");
/// The timestep.
pub const TIMESTEP: Quantity = positive(1e-30, 1e12, "s");
/// The simulated time.
pub const DURATION: Quantity = positive(1e-30, 1e12, "s");
/// The signed acceleration of gravity.
pub const GRAVITY: Quantity = signed(1e12, "m/s²");
/// The implicit methods' relative residual.
pub const TOLERANCE: Quantity = positive(1e-300, 1.0, "relative");
/// What a number is expected to stay below or above.
pub const BOUND: Quantity = signed(f64::MAX, "in the key's unit");
/// The smallest distance two attracting particles may start at: at 0 the force is infinite.
pub const ATTRACTION_DISTANCE: f64 = 1e-12;
