//! The text of `run` and `compare`: one row for each engine and timestep, and the first deviating step of a
//! comparison.

mod contact;
mod identity;
mod laws;
mod ledger;
mod rods;
mod strain;
mod table;
mod verdict;

pub use laws::missed;
use table::beside;
pub use table::{engine, several_timesteps};

use crate::report::markdown::{findings, opening, section};
use crate::report::words::{self, escape, grouped, listed};
use crate::report::{Note, View};
use crate::solvers::{SolverKind, Status};
use crate::verbs::run::Outcome;
use crate::verbs::{Body, Report};

const LEGEND: &str = "\
## How to read this

- **Energy** is the balance B = E + dissipated - injected, so that damping and wind do not count as errors. The
  *energy error* is the largest |B - B(0)| over the run, in units of the scene's energy S: what it starts with
  in motion and springs, or its largest kinetic energy, whichever is larger.
- The **word** beside it is the fitted trend of B set against its fluctuation: *bounded* (no trend to speak of),
  *drifting*, *dissipating* or *growing* (the trend outweighs the fluctuation). *Steady* is off by less than a
  millionth of S, whatever its trend; *unsteady* by more than S without a trend; *few samples* are fewer than 13
  instants, which show none.
- **Deviation** is the largest distance of any particle from the same particle in the named rapier engine.
  It is not an error: rapier's spring joint is linearly implicit Euler at h = dt/n, which dissipates by design, so a
  good integrator departs from it. `rapier-forces` applies the scene's own forces to rapier's bodies and must
  equal symplectic Euler bit for bit.
- **Error** is the largest distance from the truth; *floor* means below ten times the truth's own error bar.
- *Diverged*, *failed* and *unsupported* are results, not fast runs: their time is not shown.
- Times vary from run to run; everything else is reproducible.
";

/// The parts that the terminal and the page show.
pub fn view<'a>(report: &'a Report, outcomes: &[Outcome], columns: usize) -> View<'a> {
    let mut facts = vec![("truth", words::truth(&report.header.truth))];
    // A comparison would count only the evaluations made to judge it.
    if let Body::Run { .. } = report.body {
        facts.extend(ledger::lines(report));
        facts.extend(ledger::own_loads(report));
        facts.extend(strain::own(report));
        facts.extend(contact::own(report));
    }
    if let Some(unbooked) = contact::unbooked(report) {
        let said = facts.iter().any(|(label, _)| *label == "contact");
        facts.push((if said { "" } else { "contact" }, unbooked));
    }
    facts.extend(rods::lines(report));
    // The verdict of a comparison is the identity.
    let said = |outcome: &Outcome, sentence: &String| {
        matches!(report.body, Body::Compare { .. })
            && identity::sentence(outcome).as_ref() == Some(sentence)
    };
    let remarks = outcomes.iter().flat_map(|outcome| {
        let sentences = sentences(outcome).into_iter();
        let sentences = sentences.filter(move |sentence| !said(outcome, sentence));
        sentences.map(move |sentence| (outcome, sentence))
    });
    let mut remarks: Vec<_> = remarks.collect();
    remarks.sort_by_key(|(outcome, sentence)| rank(report, outcome, sentence));
    let labels = ["fault"].into_iter().chain(std::iter::repeat(""));
    View {
        columns,
        header: &report.header,
        timesteps: outcomes.iter().map(|outcome| outcome.timestep).collect(),
        clauses: verdict::clauses(report),
        facts,
        lines: table::lines(report, columns),
        notes: Note::of(remarks.into_iter(), |outcomes| {
            subjects(report, outcomes, usize::MAX)
        }),
        last: labels.zip(identity::fault(report)).collect(),
    }
}

/// The outcome that the terminal's lines are about: that of the scene's own integrator, else the first that `has` what they
/// say.
fn spoken_of(report: &Report, has: impl Fn(&Outcome) -> bool) -> Option<&Outcome> {
    let with = || report.outcomes().iter().filter(|outcome| has(outcome));
    let own = with().find(|outcome| report.header.is_own(&outcome.engine));
    own.or_else(|| with().next())
}

/// The place of a remark: the terminal shows the first few.
fn rank(report: &Report, outcome: &Outcome, sentence: &str) -> u8 {
    let identity = identity::sentence(outcome).is_some_and(|identity| identity == sentence);
    match outcome.status {
        _ if report.header.is_own(&outcome.engine) => 0,
        // What a row is step by step matters less than what it does.
        _ if identity => 4,
        // How rapier's joints differ is what surprises most.
        Status::Completed if outcome.kind == SolverKind::Rapier => 1,
        Status::Completed => 3,
        _ => 2,
    }
}

/// The Markdown page.
pub fn page(report: &Report, view: &View) -> String {
    let scene = &report.header.scene;
    let scale = scene.energy_scale_j;
    let scale = scale.map_or("none".into(), |s| format!("{} J", words::short(s)));
    let more = vec![
        ("timestep", words::timestep(scene.timestep, &view.timesteps)),
        ("duration", format!("{} s", words::short(scene.duration))),
        ("energy scale S", scale),
        ("truth", words::truth(&report.header.truth)),
    ];
    let fault = identity::fault(report);
    let fault = fault.iter().map(|line| format!("- {}\n", escape(line)));
    [
        opening(view, more),
        section("Outcomes", table::markdown(report)),
        report.images(),
        findings(view),
        section("First fault", fault.collect()),
        section("Where the energy is at the end", ledger::energies(report)),
        section("Loads", ledger::loads(report)),
        section("Rods", rods::markdown(report)),
        section("Strain limit", strain::table(report)),
        section("Contact", contact::table(report)),
        section("Effects that ran", ledger::effects(report)),
        LEGEND.to_owned(),
    ]
    .concat()
}

/// The outcome's remarks. The reason for ending early comes first where no remark repeats it.
pub fn sentences(outcome: &Outcome) -> Vec<String> {
    let remarks: Vec<String> = outcome.remarks.iter().map(|r| words::one_line(r)).collect();
    let reason = outcome.reason.as_deref().map(words::one_line);
    let repeats = |remark: &String| {
        reason
            .as_ref()
            .is_some_and(|reason| remark.contains(reason))
    };
    let is_said = outcome.status == Status::Completed || remarks.iter().any(repeats);
    let ending = (!is_said).then(|| ending(outcome, reason));
    let sentences = ending.into_iter().chain(remarks);
    sentences.chain(identity::sentence(outcome)).collect()
}

/// `diverged at 1.23 s: ...`
fn ending(outcome: &Outcome, reason: Option<String>) -> String {
    let mut text = words::id(outcome.status);
    if let Some(t) = outcome.stopped_at_s {
        text += &format!(" at {} s", words::short(t));
    }
    if let Some(reason) = reason {
        text += &format!(": {reason}");
    }
    text
}

/// Names the engines of `chosen`, at most `limit` of them. Each has its timesteps, unless these are all that the
/// report has of the engine: `midpoint, rk4 at h = 0.05 and 2 more`.
pub fn subjects(report: &Report, chosen: &[&Outcome], limit: usize) -> String {
    let engines = grouped(chosen.iter().map(|o| (words::short(o.timestep), &o.engine)));
    let hidden = engines.len().saturating_sub(limit);
    // "and 1 more" would be no shorter than the name.
    let hidden = if hidden == 1 { 0 } else { hidden };
    let named = engines.iter().take(engines.len() - hidden);
    let named = named.map(|(engine, timesteps)| {
        let of_engine = |o: &&Outcome| o.engine == **engine;
        let all = report.outcomes().iter().filter(of_engine).count();
        let name = words::one_line(engine);
        match timesteps.len() < all {
            true => format!("{name} at h = {}", timesteps.join(", ")),
            false => name,
        }
    });
    let more = (hidden > 0).then(|| format!("{hidden} more"));
    listed(&named.chain(more).collect::<Vec<_>>())
}
