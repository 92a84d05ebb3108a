//! Numbers of contact that a program has in the place of the scene's.

use super::{Bounce, Way};
use crate::measure::identify::words::digits;
use crate::physics::ParticleSystem;
use crate::physics::constraints::contact::{Obstacles, Surface};

/// The ids of numbers of a program's own, and what they are, after "at contact it".
pub(super) const NUMBERS: [(&str, &str); 5] = [
    ("restitution", "has another restitution than the scene"),
    ("friction", "has another friction than the scene"),
    (
        "radius",
        "has other radii than the scene, or surfaces elsewhere",
    ),
    (
        "stiffness",
        "has another stiffness of its penalty than the scene",
    ),
    (
        "damping",
        "has another damping of its penalty than the scene",
    ),
];

/// Most digits of a coefficient that a person writes.
const WRITTEN: usize = 4;

/// A number of the program's own, and the scene's where that is one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrong {
    pub found: f64,
    pub asked: Option<f64>,
}

/// Radii that a program has: `factor` times the scene's, and `more`, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    pub factor: f64,
    pub more: f64,
    /// The radius in the scene, m, where all are equal: a factor is then a shift as well.
    pub radius: Option<f64>,
}

impl Size {
    fn of(&self, radius: f64) -> f64 {
        self.factor * radius + self.more
    }

    fn says(&self) -> String {
        let shifted = |more: f64| {
            let way = if more < 0.0 { "farther away" } else { "nearer" };
            format!(
                "has surfaces {} m {way} than they are",
                digits(more.abs(), 6)
            )
        };
        let or = self.radius.map(|radius| shifted(self.of(radius) - radius));
        let or = or.map_or_else(String::new, |or| format!(", or {or}"));
        match self.factor {
            0.0 => format!(
                "leaves the radius out{or}: the gap is the distance of the centre less the radius"
            ),
            1.0 => shifted(self.more),
            factor => format!("has {} times the radius{or}", digits(factor, 6)),
        }
    }
}

/// The program's own numbers; None where they are the scene's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Own {
    /// e.
    pub restitution: Option<Wrong>,
    /// µ.
    pub friction: Option<Wrong>,
    pub size: Option<Size>,
    /// The stiffness, N/m, and the damping, N s/m, of the scene's penalty, where the program has others.
    pub penalty: Option<[Wrong; 2]>,
}

impl Own {
    pub const NONE: Self = Self {
        restitution: None,
        friction: None,
        size: None,
        penalty: None,
    };

    /// Whether one of them is not the scene's.
    pub(in super::super) fn any(&self) -> bool {
        *self != Self::NONE
    }

    /// Whether a person would write its coefficients.
    pub(in super::super) fn is_plain(&self) -> bool {
        let written = |one: Wrong| digits(one.found, WRITTEN).parse() == Ok(one.found);
        let mut all = self.restitution.into_iter().chain(self.friction);
        all.all(written)
    }

    /// An id and a clause for each.
    pub(super) fn rows(&self) -> impl Iterator<Item = (&'static str, String)> {
        let number = |name: &str, wrong: Wrong| {
            let asked = wrong
                .asked
                .map_or("the scene's".to_owned(), |asked| digits(asked, 6));
            format!("has a {name} of {}, not {asked}", digits(wrong.found, 6))
        };
        let restitution = self
            .restitution
            .map(|e| ("restitution", number("restitution", e)));
        let friction = self.friction.map(|mu| ("friction", number("friction", mu)));
        let radius = self.size.map(|size| ("radius", size.says()));
        let differs = |(_, wrong): &(&str, Wrong)| Some(wrong.found) != wrong.asked;
        let penalty = self
            .penalty
            .map(|[k, c]| [("stiffness", k), ("damping", c)]);
        let penalty = penalty.into_iter().flatten().filter(differs);
        let penalty = penalty.map(move |(id, wrong)| (id, number(id, wrong)));
        let others = restitution.into_iter().chain(friction).chain(radius);
        others.chain(penalty)
    }

    fn surface(&self, surface: Surface) -> Surface {
        let [sliding, sticking] = surface.friction;
        let restitution = self.restitution.map_or(surface.restitution, |e| e.found);
        let friction = self.friction.map_or(surface.friction, |mu| {
            let ratio = if sliding > 0.0 {
                sticking / sliding
            } else {
                1.0
            };
            [mu.found, ratio * mu.found]
        });
        Surface {
            restitution,
            friction,
        }
    }
}

impl Bounce {
    /// Whether it has obstacles of its own: beside a step the rest is done without.
    pub(in super::super) fn alters(&self) -> bool {
        let event = matches!(self.way.does, Way::Event);
        self.own.any() || event && !(self.partner.does.meets && self.rubs())
    }

    /// The scene's obstacles with its own numbers.
    pub(in super::super) fn met_by(&self, system: &ParticleSystem) -> ParticleSystem {
        let altered = |all: &Obstacles| {
            let mut all = all.resurfaced(|surface| self.own.surface(surface));
            if !self.rubs() {
                all = all.resurfaced(|surface| Surface {
                    friction: [0.0; 2],
                    ..surface
                });
            }
            if let Some(size) = self.own.size {
                all = all.resized(|radius| size.of(radius));
            }
            if !self.partner.does.meets {
                all = all.apart();
            }
            Some(all)
        };
        system.clone().with_obstacles(altered)
    }
}
