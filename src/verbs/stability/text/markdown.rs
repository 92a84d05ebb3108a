//! The limits as GitHub shows them.

use super::{facts, map_heading, table};
use crate::report::markdown::{heading, images, remarks, scene};
use crate::report::table::Table;
use crate::report::words::escape;
use crate::report::{View, words};
use crate::verbs::Report;
use crate::verbs::stability::Stability;

const LEGEND: &str = "\
## How to read this

- **Predicted limit**: the largest step up to which, at every smaller one too, no mode of the scene linearised about
  its start grows under the method. *never*: some mode grows at every step; *always*: none does at any.
- **Measured limit**: the largest step that running the scene finds stable, to a thousandth of itself;
  *a..b* where the work allowed ended between a step found stable and one found not.
- **Growth** is that of the amplitude at the step asked about, as a rate: ln(spectral radius) / h.
- **Smooth below**: where nothing oscillates in truth, the largest step at which every mode decays without changing
  sign from step to step.
- Where a step is a linear map, prediction and measurement must agree. Elsewhere the state moves away from where it was
  linearised, and the remarks say what that does.
";

const MAP: &str = "\
Each cell is a run of its own. *Stable*: its energy stays within bounds. *Dissipating*: the method loses energy that
nothing in the scene takes. *Growing*: it gains without bound. *Failed*: a step could not be taken, or numbers
left their range. Growth too slow to show over these steps is not seen. The line is the predicted limit; what has none
is stable everywhere, at no step, or is not predicted.
";

/// One report, with its figures linked as files beside it.
pub fn render(report: &Report, stability: &Stability) -> String {
    let step = format!("{} s", words::short(stability.timestep_s));
    let mut more = vec![("timestep asked about", step)];
    more.extend(facts(stability));
    let mut text = heading(report) + &scene(report, more);
    text += "## Limits\n\n";
    text += &table(report, stability).in_markdown();
    text += &remarks(&stability.notes(report));
    if let Some(heading) = map_heading(stability) {
        text += &format!("## Map\n\n{}. {MAP}\n", escape(&heading));
    }
    text += &pictures(report, stability);
    text + LEGEND
}

fn pictures(report: &Report, stability: &Stability) -> String {
    let mut text = images(report);
    if let Some(admissible) = &stability.admissible {
        text += &format!(
            "Two particles at rest at x1 and x2: coloured where one step of h = {} s leaves the spring's force no \
             larger than it was. ({} takes two: its first moves nothing.)\n\n",
            words::short(admissible.timestep_s),
            escape(&admissible.engine)
        );
        let mut table = Table::new(&admissible.panels);
        table.markdown("stiffness (N/m)", |panel| words::short(panel.stiffness_n_m));
        table.markdown("admitted", |panel| format!("{:.1} %", 100.0 * panel.share));
        text += &table.in_markdown();
    }
    text
}
