//! Reports of rests.

use super::plain;
use super::samples::empty;
use crate::report::{terminal, verdict::verdict};
use crate::verbs::tests::data::*;

fn with(rest: AtRest) -> Report {
    let mut report = empty("circle");
    report.header.checks.clear();
    report.body = Body::Rest { outcomes: [], rest };
    report.series = SeriesState::Nothing;
    report
}

/// A hanging string, refined.
pub fn found() -> Report {
    let refined = |scaling: &str, links: u64, moved: f64, omega: f64| Refined {
        scaling: scaling.into(),
        links,
        particles: 10 * links as usize + 1,
        moved_m: Some(moved),
        omega_rad_s: vec![omega, 2.5 * omega],
        reason: None,
    };
    let trend = |quantity: &str, order: f64, limit: Option<f64>| Trend {
        scaling: "continuum".into(),
        quantity: quantity.into(),
        order: Some(order),
        limit,
    };
    let oscillation = |omega: Option<f64>, growth: Option<f64>| Oscillation {
        omega_rad_s: omega,
        growth_per_s: growth,
        particle: 10,
        axis: 0,
    };
    with(AtRest {
        reason: None,
        found: Some(Balance {
            farthest: Some(Moved {
                particle: 10,
                by_m: [0.0, 0.0, -0.04905],
            }),
            force_left_n: 1e-14,
            newton_iterations: 6,
            potential_j: [("gravity", [4.4145, 4.09]), ("springs", [0.0, 0.16])]
                .map(|(id, energies)| (id.to_owned(), energies))
                .into(),
            tension_max: None,
            tension_min: None,
            reactions: Vec::new(),
            oscillations: vec![
                oscillation(None, Some(3.0)),
                oscillation(Some(0.0), None),
                oscillation(Some(3.656), None),
            ],
            growing: 1,
            free: 1,
            counted: true,
            left_out: vec!["magnetic turns what moves, which the frequencies leave out".into()],
        }),
        refined: vec![
            refined("continuum", 1, 0.0501, 3.656),
            refined("continuum", 2, 0.0493, 3.663),
            refined("continuum", 4, 0.0491, 3.665),
            refined("none", 1, 0.0501, 3.656),
            refined("none", 2, 0.1962, 3.403),
            refined("none", 4, 0.7848, 2.730),
        ],
        trends: vec![
            trend("moved_m", 2.0, Some(0.04903)),
            trend("omega_rad_s[0]", -1.0, None),
        ],
    })
}

/// Nothing holds it.
pub fn falling() -> Report {
    with(AtRest {
        reason: Some("nothing holds particle 1: it moves on without end".into()),
        found: None,
        refined: Vec::new(),
        trends: Vec::new(),
    })
}

#[test]
fn a_rest_says_first_what_a_student_asks() {
    let text = plain(&terminal::render(found().view()));
    insta::assert_snapshot!(text, @r"
    circle  2 particles, 1 spring, 5 s at h = 0.01 s, symplectic_euler
    A spring of rest length 0, started sideways: the truth is an ellipse.

    at rest particle 10 is 0.04905 m along -z from its start; IT IS UNSTABLE: a nudge grows in 1 of its
    motions, fastest of particle 10 along x, twice as far every 231 ms; 1 motion costs no energy that
    rounding shows, such as particle 10 along x: a mechanism.

    frequency          period
      (rad/s)    (Hz)     (s)  moves most
    ──────────────────────────────────────────────
        grows       -       -  particle 10 along x
            0       -       -  particle 10 along x
        3.656  0.5819   1.719  particle 10 along x
    small oscillations about the rest, without dampers

    what refining does
                                   moved  1st freq.  2nd freq.  period
    scaling    links  particles      (m)    (rad/s)    (rad/s)     (s)
    ──────────────────────────────────────────────────────────────────
    continuum      1         11  0.05010      3.656      9.140   1.719
    continuum      2         21  0.04930      3.663      9.157   1.715
    continuum      4         41  0.04910      3.665      9.162   1.714
    none           1         11  0.05010      3.656      9.140   1.719
    none           2         21   0.1962      3.403      8.508   1.846
    none           4         41   0.7848      2.730      6.825   2.302
    continuum: stiffness and mass are scaled; none: each link keeps its own

    continuum: the distance moved tends to 0.04903 m at order 2.00
    continuum: the lowest frequency does not settle, differences grow as links^1.00

    - rest: magnetic turns what moves, which the frequencies leave out
    - rest: start it a little aside, and the rest that it falls to is found

    energy   gravity 4.415 to 4.090 J, springs 0 to 0.1600 J
    left     a force of 1.0e-14 N, after 6 Newton iterations
    ");
    assert!(verdict(&falling().view()).starts_with("NO REST: nothing holds particle 1"));
    assert_eq!(found().svg().len(), 1);
    assert!(falling().svg().is_empty());
}
