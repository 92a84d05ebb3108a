//! Dormand and Prince's pair of orders 5 and 4.

use super::{ErrorEstimate, Pair};
use crate::integrators::{Coefficients, MethodRow, Tableau};

pub(in crate::integrators) const DORMAND_PRINCE_54: MethodRow = MethodRow {
    id: "dormand_prince54",
    name: "Dormand-Prince 5(4)",
    coefficients: Coefficients::Pair(Pair {
        tableau: DORMAND_PRINCE_5,
        estimate: ErrorEstimate::Embedded {
            order: 4,
            weights: &ERROR_4,
        },
        first_same_as_last: true,
    }),
    energy: None,
    source: "Dormand, Prince 1980, J. Comput. Appl. Math. 6, 19; Hairer, Nørsett, Wanner, \
             Solving ODEs I, II.5 (DOPRI5)",
    not: "the pair of Fehlberg, which advances the fourth order",
};

/// The seven stages of RK5(4)7M (Dormand, Prince 1980, J. Comput. Appl. Math. 6, table 2; Hairer,
/// Nørsett, Wanner, Solving ODEs I, II.5, table 5.2), order 5. The last stage is the step's end.
///
/// Not to be confused with RK5(4)7S of the same paper, which has a larger region of stability.
pub const DORMAND_PRINCE_5: Tableau = Tableau {
    a: &[
        &[],
        &[1.0 / 5.0],
        &[3.0 / 40.0, 9.0 / 40.0],
        &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
        &[
            19372.0 / 6561.0,
            -25360.0 / 2187.0,
            64448.0 / 6561.0,
            -212.0 / 729.0,
        ],
        &[
            9017.0 / 3168.0,
            -355.0 / 33.0,
            46732.0 / 5247.0,
            49.0 / 176.0,
            -5103.0 / 18656.0,
        ],
        &[
            35.0 / 384.0,
            0.0,
            500.0 / 1113.0,
            125.0 / 192.0,
            -2187.0 / 6784.0,
            11.0 / 84.0,
        ],
    ],
    b: &[
        35.0 / 384.0,
        0.0,
        500.0 / 1113.0,
        125.0 / 192.0,
        -2187.0 / 6784.0,
        11.0 / 84.0,
        0.0,
    ],
    c: &[0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0],
};

/// Σ e k estimates the error of the embedded method of order 4: b less its weights
/// (`e1` to `e7` in the authors' `dopri5.f`).
pub const ERROR_4: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339_200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];
