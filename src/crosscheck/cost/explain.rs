//! Why a reference engine's line is what it is: explained, not scored.

use crate::engines::EngineRow;

/// One sentence on the engine's line.
pub(super) fn engine(row: &EngineRow) -> String {
    match (row.dissipates, row.equals) {
        (None, Some(method)) => format!(
            "it moves its bodies by {method} under the forces computed here, so its errors are that \
             method's, and what it takes longer is the engine around it"
        ),
        _ => "its spring joints are linearly implicit Euler at h = dt over its iterations, a method of \
              order 1: a tenth of the error takes ten times the steps, each a solve of all joints among \
              bodies; distance from the truth at its usual steps is a choice (stability at any stiffness, \
              a world that also has contacts), not a fault"
            .to_owned(),
    }
}
