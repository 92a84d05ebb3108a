//! The result of `stability` in words: how limits and growth are written.

mod terminal;
mod verdict;

use crate::report::markdown::{findings, opening, section};
use crate::report::table::Table;
use crate::report::terminal::Tone;
use crate::report::words::{self, NOTHING, digits, escape, listed, one_line};
use crate::report::{Note, View};
use crate::verbs::Report;
use crate::verbs::stability::{Largest, LargestFound, LargestRow, Stability, StabilityRow};

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

/// The parts that the terminal and the page have in common.
pub fn view<'a>(report: &'a Report, stability: &'a Stability, columns: usize) -> View<'a> {
    let all = stability.rows.len();
    let said = stability.rows.iter().flat_map(|row| {
        let remarks = row.remarks.iter().map(|remark| one_line(remark));
        remarks.map(|remark| (one_line(&row.engine), remark))
    });
    let asked = stability.largest.iter();
    let said = said.chain(asked.flat_map(|largest| {
        largest.rows.iter().filter_map(|row| {
            let why = one_line(row.reason.as_ref()?);
            let remark = format!("largest {} not known: {why}", one_line(&largest.vary));
            Some((one_line(&row.engine), remark))
        })
    }));
    View {
        columns,
        header: &report.header,
        timesteps: Vec::new(),
        clauses: verdict::clauses(report, stability),
        facts: facts(stability),
        lines: terminal::lines(report, stability, columns),
        notes: Note::of(said, |engines| match engines.len() {
            several if several == all && all > 2 => "all".to_owned(),
            _ => listed(engines),
        }),
        last: Vec::new(),
    }
}

/// The page in Markdown.
pub fn page(report: &Report, stability: &Stability, view: &View) -> String {
    let step = format!("{} s", words::short(stability.timestep_s));
    let mut more = vec![("timestep asked about", step)];
    more.extend(facts(stability));
    let map = map_heading(stability).map(|heading| format!("{}. {MAP}", escape(&heading)));
    [
        opening(view, more),
        section("Limits", table(report, stability).in_markdown()),
        findings(view),
        section("Largest value", largest(stability)),
        section("Map", map.unwrap_or_default()),
        report.images(),
        admissible(stability).unwrap_or_default(),
        LEGEND.to_owned(),
    ]
    .concat()
}

/// The largest stable values as a section: what is asked, and the table.
fn largest(stability: &Stability) -> String {
    let of = |largest: &Largest| {
        let table = largest_table(largest).in_markdown();
        format!("{}\n\n{table}", escape(&largest_heading(largest)))
    };
    stability.largest.as_deref().map(of).unwrap_or_default()
}

/// What the table of largest values answers.
fn largest_heading(largest: &Largest) -> String {
    let [low, high] = largest.tried.map(words::short);
    format!(
        "The largest {} ({}) at which a step of {} s is within the predicted limit, of values from {low} to {high}:",
        one_line(&largest.vary),
        largest.unit,
        words::short(largest.timestep_s)
    )
}

fn largest_table(largest: &Largest) -> Table<'_, LargestRow> {
    let mut table = Table::new(&largest.rows);
    table.engines(|row| (row.engine.clone(), ' '));
    let value = format!("largest ({})", largest.unit);
    table.right(&value, &value, 0, largest_value);
    table
}

/// The number, or in words that there is none.
fn largest_value(row: &LargestRow) -> Option<String> {
    match row.found {
        LargestFound::Value => row.value.map(digits),
        LargestFound::EveryValue => Some("every value".into()),
        LargestFound::NoValue => Some("no value".into()),
        LargestFound::NotKnown => Some("not known".into()),
    }
}

/// The legend of the picture of admissible places, and their fraction at each stiffness.
fn admissible(stability: &Stability) -> Option<String> {
    let admissible = stability.admissible.as_ref()?;
    let mut table = Table::new(&admissible.panels);
    table.markdown("stiffness (N/m)", |panel| words::short(panel.stiffness_n_m));
    table.markdown("admitted", |panel| format!("{:.1} %", 100.0 * panel.share));
    Some(format!(
        "Two particles at rest at x1 and x2: coloured where one step of h = {} s leaves the spring's force no \
         larger than it was. ({} takes two: its first moves nothing.)\n\n{}\n",
        words::short(admissible.timestep_s),
        escape(&admissible.engine),
        table.in_markdown()
    ))
}

/// The table of limits, in the terminal and in Markdown.
fn table<'a>(report: &Report, stability: &'a Stability) -> Table<'a, StabilityRow> {
    let h = stability.timestep_s;
    let header = &report.header;
    let any = |wanted: fn(&StabilityRow) -> bool| stability.rows.iter().any(wanted);
    let mut table = Table::new(&stability.rows);
    table.engines(|row| (row.engine.clone(), header.mark(&row.engine)));
    table.right("predicted\nlimit (s)", "predicted limit (s)", 0, |row| {
        limit(row.predicted_limit_s, row.unconditional)
    });
    table.right("measured\nlimit (s)", "measured limit (s)", 0, measured);
    table.right("ratio", "ratio", 2, ratio);
    if any(|row| row.tightest.is_some()) {
        let tightest = |row: &StabilityRow| row.tightest.clone();
        let [terminal, markdown] = ["tightest on\nthe way (s)", "tightest on the way (s)"];
        table.right(terminal, markdown, 3, |row| {
            limit(tightest(row).map(|tightest| tightest.limit_s), false)
        });
        table.markdown("at t (s)", |row| {
            tightest(row).map(|tightest| words::short(tightest.t_s))
        });
    }
    // The terminal leaves the column out by itself where no row has a number.
    let smooth = any(|row| row.smooth_below_s.or(row.measured_smooth_below_s).is_some());
    let below = if smooth { "smooth below (s)" } else { "" };
    table.right("smooth\nbelow (s)", below, 4, |row| {
        limit(row.smooth_below_s, false)
    });
    if smooth {
        table.markdown("measured (s)", |row| {
            limit(row.measured_smooth_below_s, false)
        });
    }
    table.right("growth/s\npredicted", "growth predicted (1/s)", 1, |row| {
        row.growth_per_s.map(digits)
    });
    table.right("growth/s\nmeasured", "growth measured (1/s)", 1, |row| {
        row.measured_growth_per_s.map(digits)
    });
    let step = words::short(h);
    let [terminal, markdown] = [format!("at h =\n{step} s"), format!("h = {step} s")];
    table.left(&terminal, &markdown, |row| {
        let tone = |holds| if holds { Tone::Good } else { Tone::Bad };
        (place(row, h), row.holds(h).map(tone))
    });
    table
}

/// A limit: four digits, `never` for 0, `always` where every step is stable.
fn limit(limit: Option<f64>, unconditional: bool) -> String {
    match limit {
        Some(0.0) => "never".into(),
        Some(h) => digits(h),
        None if unconditional => "always".into(),
        None => NOTHING.into(),
    }
}

/// The measured limit, or its bracket.
fn measured(row: &StabilityRow) -> String {
    match row.measured_between_s {
        Some([low, high]) => format!("{}..{}", digits(low), digits(high)),
        None => limit(row.measured_limit_s, row.measured_unconditional),
    }
}

/// Measured over predicted, where both are numbers above 0.
fn ratio(row: &StabilityRow) -> Option<String> {
    let [predicted, measured] = [row.predicted_limit_s?, row.measured_limit_s?];
    (predicted > 0.0 && measured > 0.0).then(|| match measured / predicted {
        // Four decimals, above 1 as below.
        ratio if (0.1..10.0).contains(&ratio) => format!("{ratio:.4}"),
        ratio => digits(ratio),
    })
}

/// The place of the step: inside the limit, or how many times beyond.
fn place(row: &StabilityRow, timestep: f64) -> String {
    match (row.holds(timestep), row.limit()) {
        (Some(true), _) => "inside".into(),
        (Some(false), Some(limit)) if limit > 0.0 && timestep / limit < 1e6 => {
            format!("{} x beyond", digits(timestep / limit))
        }
        (Some(false), _) => "beyond".into(),
        (None, _) if row.unsupported => "unsupported".into(),
        (None, _) => NOTHING.into(),
    }
}

/// The facts about the whole scene, line by line: label and text.
fn facts(stability: &Stability) -> Vec<(&'static str, String)> {
    let fastest = match stability.omega_max_rad_s {
        Some(omega) => format!("fastest mode {} rad/s", digits(omega)),
        None if stability.unsure => "fastest mode not known (damping couples too many)".to_owned(),
        None => "nothing oscillates".to_owned(),
    };
    let forces = if stability.linear {
        "every force is linear: limits are the same wherever the state is".to_owned()
    } else {
        format!(
            "forces are not linear: predicted about the start, and along the trajectory up to {} s",
            words::short(stability.horizon_s)
        )
    };
    let out = (!stability.excluded.is_empty()).then(|| listed(&stability.excluded));
    let mut facts = vec![("linear", format!("{fastest}; {forces}"))];
    facts.extend(out.map(|out| ("left out", out)));
    facts
}

/// The heading of the map: its size, its quantity and the steps of a cell.
fn map_heading(stability: &Stability) -> Option<String> {
    let map = stability.map.as_ref()?;
    Some(format!(
        "{} x {} cells of {}, {} steps each at most",
        map.values.len(),
        map.timesteps_s.len(),
        one_line(&map.vary),
        words::count(map.steps_per_cell)
    ))
}
