//! The kinds of forces, which a method has to know before it accepts a system.

use std::fmt;
use std::ops::BitOr;

/// A set of kinds: those of one force, of all forces of a system, or those that a method accepts.
///
/// A force is linear in v where f(t, x, v) = f(t, x, 0) + D(x) v. D is then the sum of a symmetric and
/// a skew part, each a kind of its own. The empty set is a force of time and position alone, with or
/// without a potential.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ForceKinds(u8);

impl ForceKinds {
    /// Depends on time and position alone.
    pub const NONE: Self = Self(0);
    /// Linear in v by a symmetric, negative semidefinite D, which takes energy out: dampers, drag.
    pub const DISSIPATIVE: Self = Self(1);
    /// Linear in v by a symmetric D that may feed energy in: drag of the wrong sign.
    pub const NEGATIVE_DAMPING: Self = Self(2);
    /// Linear in v by a skew D, which turns the velocity and does no work: a magnetic field.
    pub const GYROSCOPIC: Self = Self(4);
    /// Depends on v in any other way, as quadratic drag, or in a way that is not known.
    pub const NON_LINEAR: Self = Self(8);
    /// Does work that neither a potential nor its dependence on v accounts for: wind, or a motion that is given.
    pub const DRIVEN: Self = Self(16);
    /// The forces of rods: quadratic in v, and without work but at what is driven.
    pub const CONSTRAINED: Self = Self(32);
    /// All of them.
    pub const ANY: Self = Self(63);
    /// All kinds that are linear in v: what a method accepts that splits the force into that at rest and D v.
    pub const LINEAR: Self = Self(Self::ANY.0 & !Self::NON_LINEAR.0 & !Self::CONSTRAINED.0);

    const WORDS: [(Self, &str); 6] = [
        (Self::DISSIPATIVE, "dissipative"),
        (Self::NEGATIVE_DAMPING, "negatively damped"),
        (Self::GYROSCOPIC, "gyroscopic"),
        (Self::NON_LINEAR, "non-linear in the velocity"),
        (Self::DRIVEN, "driven"),
        (Self::CONSTRAINED, "constrained"),
    ];

    /// Whether the set contains any of these kinds.
    pub const fn has(self, any_of: Self) -> bool {
        self.0 & any_of.0 != 0
    }

    /// Whether a force does that is not one of rods: those do whatever else acts.
    pub const fn depends_on_velocity(self) -> bool {
        self.has(Self(Self::ANY.0 & !Self::DRIVEN.0 & !Self::CONSTRAINED.0))
    }

    /// Whether a force depends on v otherwise than by turning it.
    pub const fn damps(self) -> bool {
        self.without(Self::GYROSCOPIC).depends_on_velocity()
    }

    /// Whether a force can do work that no potential accounts for.
    pub const fn does_work(self) -> bool {
        self.has(Self(
            Self::ANY.0 & !Self::GYROSCOPIC.0 & !Self::CONSTRAINED.0,
        ))
    }

    /// The kinds of this set and of another.
    pub const fn with(self, others: Self) -> Self {
        Self(self.0 | others.0)
    }

    /// The kinds of this set that are not in the other.
    pub const fn without(self, others: Self) -> Self {
        Self(self.0 & !others.0)
    }

    /// The kind of a linear damper with this coefficient c, f = -c v.
    pub fn of_damper(coefficient: f64) -> Self {
        if coefficient > 0.0 {
            Self::DISSIPATIVE
        } else if coefficient < 0.0 {
            Self::NEGATIVE_DAMPING
        } else {
            Self::NONE
        }
    }

    /// The kinds of the same force with its sign flipped.
    pub(crate) fn negated(self) -> Self {
        let swap = |from: Self, to: Self| if self.has(from) { to } else { Self::NONE };
        self.without(Self::DISSIPATIVE | Self::NEGATIVE_DAMPING)
            | swap(Self::DISSIPATIVE, Self::NEGATIVE_DAMPING)
            | swap(Self::NEGATIVE_DAMPING, Self::DISSIPATIVE)
    }

    /// The kinds of several forces together.
    pub(crate) fn union(kinds: impl Iterator<Item = Self>) -> Self {
        kinds.fold(Self::NONE, BitOr::bitor)
    }
}

impl BitOr for ForceKinds {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        self.with(other)
    }
}

impl fmt::Display for ForceKinds {
    /// As an adjective: "gyroscopic or driven".
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = Self::WORDS.iter().filter(|(kind, _)| self.has(*kind));
        let words: Vec<_> = words.map(|(_, word)| *word).collect();
        f.write_str(&words.join(" or "))
    }
}

/// The refusal of forces that a method does not accept: it would step, and be wrong.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{method}: {}", self.reason())]
pub struct Refused {
    /// The method's id, or another name of it.
    pub method: String,
    /// The kinds that are refused.
    pub kinds: ForceKinds,
    /// Ids of the effects that have these kinds, where they are known.
    pub effects: Vec<&'static str>,
}

impl Refused {
    /// The sentence without the method, the same for all that refuse these effects.
    pub fn reason(&self) -> String {
        if self.kinds == ForceKinds::CONSTRAINED {
            return "rods are not taken: their forces depend on the square of the velocity; rattle, velocity_verlet, \
                    explicit Runge-Kutta methods (rk4) and adaptive pairs take them"
                .to_owned();
        }
        let rods = self.kinds.has(ForceKinds::CONSTRAINED);
        let (neither, any) = if rods {
            ("neither rods nor a force", "both")
        } else {
            ("no force", "any")
        };
        format!(
            "{neither} that is {}{} is taken: how velocity is treated needs forces linear in it, as dampers, drag and \
             magnetic fields are; explicit Runge-Kutta methods (rk4), adaptive pairs and symplectic_euler take {any}",
            self.kinds.without(ForceKinds::CONSTRAINED),
            list(&self.effects)
        )
    }
}

fn list(effects: &[&str]) -> String {
    if effects.is_empty() {
        String::new()
    } else {
        format!(" ({})", effects.join(", "))
    }
}
