//! A scheme by its name, as `compare` prints it: an integrator or a composed scheme, in one step or in substeps.

use crate::integrators::{self, Method};
use crate::measure::identify::{MISTAKES, Wrong, composed_schemes};
use crate::scene::words::nearest;
use std::str::FromStr;

/// A scheme that a program may be meant to follow.
#[derive(Debug, Clone)]
pub struct Scheme {
    /// `rk4`, `velocity_verlet_explicit_damping`, `symplectic_euler/4`.
    pub label: String,
    /// The integrator that it is, and whose facts hold; None for a composed scheme, and for substeps.
    pub method: Option<&'static Method>,
}

impl From<&'static Method> for Scheme {
    fn from(method: &'static Method) -> Self {
        Self {
            label: method.id.to_owned(),
            method: Some(method),
        }
    }
}

impl FromStr for Scheme {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, substeps) = match text.split_once('/') {
            Some((name, substeps)) => (name, Some(substeps)),
            None => (text, None),
        };
        let id = integrators::meant(name);
        let method = integrators::find(id).filter(|method| method.pair().is_none());
        if method.is_none() && !composed_schemes().iter().any(|(known, _)| known == id) {
            let known = ids();
            return Err(match nearest(id, &known) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!(
                    "expected one of {}, or another scheme that `compare` names",
                    integrators::ids(integrators::fixed()).join(", ")
                ),
            });
        }
        let substeps = match substeps.map(str::parse::<u32>) {
            None => 1,
            Some(Ok(n)) if n > 0 => n,
            Some(_) => return Err(format!("expected {id}/N with N substeps, found `{text}`")),
        };
        Ok(match substeps {
            1 => Self {
                label: id.to_owned(),
                method,
            },
            n => Self {
                label: format!("{id}/{n}"),
                method: None,
            },
        })
    }
}

/// What a composed scheme does, in words; None for every other name.
pub fn says(id: &str) -> Option<&'static str> {
    let composed = composed_schemes().iter().find(|(known, _)| known == id);
    composed.map(|(_, says)| says.as_str())
}

/// The ids of methods, composed schemes and wrong steps: all that a trajectory's rows may be named as.
pub fn ids() -> Vec<&'static str> {
    let steps = MISTAKES
        .iter()
        .filter(|mistake| matches!(mistake.wrong, Wrong::Step { .. }));
    integrators::ids(integrators::fixed())
        .into_iter()
        .chain(composed_schemes().iter().map(|(id, _)| id.as_str()))
        .chain(steps.map(|mistake| mistake.id))
        .collect()
}
