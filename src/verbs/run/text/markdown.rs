//! The outcomes as GitHub shows them.

use super::{identity, ledger, table};
use crate::report::markdown::{checks, heading, images, remarks, scene, section};
use crate::report::words::escape;
use crate::report::{Shown, words};
use crate::verbs::Report;

const LEGEND: &str = "\
## How to read this

- **Energy** is the balance B = E + dissipated - injected, so that damping and wind do not count as errors. The
  *energy error* is the largest |B - B(0)| over the run, relative to the scene's energy scale S.
- **Class** is the fitted trend of B set against its fluctuation: *bounded* (no trend to speak of), *drifting*,
  *dissipating* or *growing* (the trend outweighs the fluctuation).
- **Deviation** is the largest distance of any particle from the same particle in the named rapier engine.
  It is not an error: rapier's spring joint is linearly implicit Euler at h = dt/n, which dissipates by design, so a
  good integrator departs from it. `rapier-forces` applies the scene's own forces to rapier's bodies and must
  equal symplectic Euler bit for bit.
- **Error** is the largest distance from the truth; *floor* means below ten times the truth's own error bar.
- *Diverged*, *failed* and *unsupported* are results, not fast runs: their time is not shown.
- Times vary from run to run; everything else is reproducible.
";

/// One report, with its figures linked as files beside it.
pub fn render(report: &Report) -> String {
    let facts = &report.header.scene;
    let scale = facts
        .energy_scale_j
        .map_or("none".into(), |s| format!("{} J", words::short(s)));
    let more = vec![
        (
            "timestep",
            words::timestep(facts.timestep, &report.view().timesteps()),
        ),
        ("duration", format!("{} s", words::short(facts.duration))),
        ("energy scale S", scale),
        ("truth", words::truth(&report.header.truth)),
    ];
    let text = heading(report) + &scene(report, more);
    let text = text + &images(report) + "## Outcomes\n\n" + &table::markdown(report);
    let text = text + &remarks(&report.view().notes(report)) + &checks(&report.header.checks);
    let fault = identity::fault(report);
    let fault = fault.iter().map(|line| format!("- {}\n", escape(line)));
    let text = text + &section("First fault", fault.collect());
    text + &ledger::energies(report) + &ledger::effects(&facts.effects) + LEGEND
}
