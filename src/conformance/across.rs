//! Stability across: motion a method's Jacobian may not know of.

use super::Law;
use super::finding::Verdict;
use super::stability::{PUBLISHED, W, unstable};
use super::systems::Across;
use crate::integrators::Stable;
use crate::measure::CheckStatus;

pub(super) const LAW: Law = Law {
    id: "stability-across",
    summary: "motion across a spring is as stable as claimed: as motion along it, unless its \
              stiffness is left out",
    derivation: "the one-step matrix 1e-6 inside and outside the limit: six decimals are published",
    judge: |subject| {
        let Some(oscillator) = subject.claims.oscillator else {
            return Ok(Verdict::skip("the oscillator"));
        };
        let at = |z: f64| unstable(subject.build, &Across { w: W }, z);
        let (limit, holds) = match oscillator.stable {
            Stable::AlwaysAlong { across: limit } | Stable::Below(limit) => {
                let holds = !at(limit - PUBLISHED)? && at(limit + PUBLISHED)?;
                (Some(limit), holds)
            }
            Stable::Always => {
                let mut holds = true;
                for z in [0.1, 1.0, 2.1, 10.0] {
                    holds &= !at(z)?;
                }
                (None, holds)
            }
            Stable::Never => (None, at(0.1)?),
        };
        let (status, verb) = if holds {
            (CheckStatus::Pass, "is")
        } else {
            (CheckStatus::Fail, "is not")
        };
        let message = format!(
            "{verb} stable across a spring as claimed: {:?}",
            oscillator.stable
        );
        Ok(Verdict::new(status, None, limit, message))
    },
};
