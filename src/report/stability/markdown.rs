//! The limits as GitHub shows them.

use super::{facts, growth, limit, map_heading, measured, notes, place, ratio};
use crate::outcome::{Report, Stability, StabilityRow};
use crate::report::markdown::{escape, heading, images, table};
use crate::report::words::{self, NOTHING};

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
    let mut text = heading(report);
    text += &scene(report, stability);
    text += "## Limits\n\n";
    text += &limits(report, stability);
    let remarks = notes(stability);
    if !remarks.is_empty() {
        text += "## Remarks\n\n";
        for (subject, sentence) in remarks {
            text += &format!("- **{}**: {}\n", escape(&subject), escape(&sentence));
        }
        text += "\n";
    }
    if let Some(heading) = map_heading(stability) {
        text += &format!("## Map\n\n{}. {MAP}\n", escape(&heading));
    }
    text += &pictures(report, stability);
    text + LEGEND
}

fn scene(report: &Report, stability: &Stability) -> String {
    let scene = &report.scene;
    let mut rows = vec![
        vec!["file".to_owned(), escape(&scene.file)],
        vec!["particles".to_owned(), scene.particles.to_string()],
        vec!["springs".to_owned(), scene.springs.to_string()],
        vec!["own integrator".to_owned(), escape(&scene.own_method)],
        vec![
            "timestep asked about".to_owned(),
            format!("{} s", words::short(stability.timestep_s)),
        ],
    ];
    let facts = facts(stability).into_iter();
    rows.extend(facts.map(|(label, text)| vec![label.to_owned(), escape(&text)]));
    table(&["scene", ""], &rows)
}

fn limits(report: &Report, stability: &Stability) -> String {
    let h = stability.timestep_s;
    let any = |wanted: fn(&StabilityRow) -> bool| stability.rows.iter().any(wanted);
    let smooth = any(|row| row.smooth_below_s.or(row.measured_smooth_below_s).is_some());
    let along = any(|row| row.tightest.is_some());
    let mut header = vec![
        "engine",
        "predicted limit (s)",
        "measured limit (s)",
        "ratio",
    ];
    if along {
        header.extend(["tightest along the way (s)", "at t (s)"]);
    }
    if smooth {
        header.extend(["smooth below (s)", "measured (s)"]);
    }
    let at = format!("h = {} s", words::short(h));
    header.extend([
        "growth predicted (1/s)",
        "growth measured (1/s)",
        at.as_str(),
    ]);
    let row = |row: &StabilityRow| {
        let name = escape(&row.engine);
        let mut cells = vec![
            if row.engine == report.scene.own_method {
                format!("**{name}**")
            } else {
                name
            },
            limit(row.predicted_limit_s, row.unconditional),
            measured(row),
            ratio(row),
        ];
        if along {
            let tightest = row.tightest.as_ref();
            cells.push(limit(tightest.map(|tightest| tightest.limit_s), false));
            cells.push(tightest.map_or(NOTHING.into(), |tightest| words::short(tightest.t_s)));
        }
        if smooth {
            cells.push(limit(row.smooth_below_s, false));
            cells.push(limit(row.measured_smooth_below_s, false));
        }
        cells.extend([
            growth(row.growth_per_s),
            growth(row.measured_growth_per_s),
            place(row, h),
        ]);
        cells
    };
    let rows: Vec<Vec<String>> = stability.rows.iter().map(row).collect();
    table(&header, &rows)
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
        let rows: Vec<Vec<String>> = admissible
            .panels
            .iter()
            .map(|panel| {
                vec![
                    words::short(panel.stiffness_n_m),
                    format!("{:.1} %", 100.0 * panel.share),
                ]
            })
            .collect();
        text += &table(&["stiffness (N/m)", "admitted"], &rows);
    }
    text
}
