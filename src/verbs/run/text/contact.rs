//! Contact in words: impacts, what they and friction took, and how far particles are inside obstacles.

use super::laws;
use crate::measure::{Behaviour, Contact, Energy};
use crate::report::words;
use crate::verbs::Report;
use crate::verbs::run::Outcome;

const INTRO: &str = "\
A step is cut where a particle meets an obstacle, and goes on with the velocity after the impact: Newton's restitution
along the normal, Coulomb's friction across it. What stays in contact is held by normal forces that only push. *Deepest* is
how far a particle was inside an obstacle, at the recorded instants. What impacts and friction take is part of the balance:
B = E + dissipated - injected + impacts + friction. rapier's contact has a law of its own: it acts once a step, and rests a
little inside.

The last columns tell how far each is off the laws, from the rows alone; 0 is right. *Off e*: the speed after an impact, in parts
of the speed before it. *Off the cone*: friction of an impact above µ times its normal impulse, in parts of that. *Off µ N*:
friction of what slides or sticks, in parts of N. *Put in*: energy that an impact or friction adds. What forces do between two
rows, and a run's step, may explain some of it: the sentences below the table say how much. What touches several things at once,
or not for one step alone, is not judged.";

const PENALTY: &str = "\
A spring and a damper press while a particle is inside; a step is cut where one enters and where it leaves. *Impacts* are the
contacts that began. *Deepest* is how far a particle was inside, at the recorded instants. What the damper takes is part of what
is dissipated.";

fn rows(report: &Report) -> Vec<(&Outcome, &Contact)> {
    let outcomes = report.outcomes().iter();
    outcomes
        .filter_map(|outcome| Some((outcome, outcome.contact.as_ref()?)))
        .collect()
}

/// The table of all engines; empty without obstacles.
pub fn table(report: &Report) -> String {
    let rows = rows(report);
    if rows.is_empty() {
        return String::new();
    }
    let mut table = super::beside(report, &rows);
    table.markdown("impacts", |(_, contact)| contact.impacts.map(words::count));
    table.markdown("lost in impacts (J)", |(o, _)| taken(o, |e| e.impacts_j));
    table.markdown("lost to friction (J)", |(o, _)| taken(o, |e| e.friction_j));
    table.markdown("deepest (m)", |(_, contact)| {
        words::short(contact.deepest_m)
    });
    table.markdown("where", |(_, contact)| inside(contact));
    table.markdown("at (s)", |(_, contact)| {
        contact.particle.map(|_| words::short(contact.t_s))
    });
    table.markdown("touching at the end", |(_, contact)| {
        words::count(contact.touching)
    });
    table.markdown("off e", |(_, contact)| laws::cell(contact.laws.separation));
    table.markdown("off the cone", |(_, contact)| {
        laws::cell(contact.laws.impact_friction)
    });
    table.markdown("off µ N", |(_, contact)| {
        laws::cell(contact.laws.sliding_friction)
    });
    table.markdown("put in (J)", |(_, contact)| {
        laws::cell(contact.laws.energy_gain)
    });
    let intro = if presses(&rows) { PENALTY } else { INTRO };
    let mut text = format!("{intro}\n\n{}", table.in_markdown());
    if let Some(unbooked) = unbooked(report) {
        text += &format!("\nWhat is lost: {}.\n", words::escape(&unbooked));
    }
    let said: Vec<(String, Vec<String>)> = rows
        .iter()
        .map(|(outcome, contact)| {
            (
                super::engine(outcome),
                laws::sentences(&contact.laws, contact.impacts),
            )
        })
        .filter(|(_, said)| !said.is_empty())
        .collect();
    if !said.is_empty() {
        text += "\nHow far each is off the laws:\n\n";
        let said = said.iter();
        text.extend(said.map(|(engine, said)| format!("- {engine}: {}.\n", said.join("; "))));
    }
    if let Some((outcome, contact)) = differing(&rows) {
        let engine = super::engine(outcome);
        text += &format!("\nWhere the contact of {engine} differs from these laws:\n\n");
        let differs = contact.differs.iter();
        text.extend(differs.map(|differs| format!("- {differs}\n")));
    }
    text
}

/// The first row that says where its contact differs from the laws.
fn differing<'a>(rows: &[(&'a Outcome, &'a Contact)]) -> Option<(&'a Outcome, &'a Contact)> {
    let differs = |(_, contact): &&(&Outcome, &Contact)| !contact.differs.is_empty();
    rows.iter().find(differs).copied()
}

/// `particle 2 inside collider 0 (plane)`; None where none is inside.
fn inside(contact: &Contact) -> Option<String> {
    let (particle, inside) = contact.particle.zip(contact.inside.as_ref())?;
    Some(format!("particle {particle} inside {inside}"))
}

fn taken(outcome: &Outcome, which: fn(&crate::measure::Energy) -> Option<f64>) -> Option<String> {
    which(outcome.energy.as_ref()?).map(words::short)
}

/// Which rows do not say what impacts and friction take, where there was something to take; None where all say it.
pub fn unbooked(report: &Report) -> Option<String> {
    let rows = rows(report);
    let energies = rows
        .iter()
        .filter_map(|(o, _)| Some((*o, o.energy.as_ref()?)));
    let (say, silent): (Vec<_>, Vec<_>) =
        energies.partition(|(_, energy)| energy.impacts_j.is_some());
    let took =
        |energy: &Energy| is_real(energy, energy.impacts_j) || is_real(energy, energy.friction_j);
    let fell = |energy: &Energy| energy.lost() && energy.behaviour() != Some(Behaviour::Steady);
    let lost = match say.as_slice() {
        [] => silent.iter().any(|(_, energy)| fell(energy)),
        say => say.iter().any(|(_, energy)| took(energy)),
    };
    // What a penalty takes its damper takes.
    if silent.is_empty() || !lost || presses(&rows) {
        return None;
    }
    let outcomes: Vec<&Outcome> = silent.iter().map(|(outcome, _)| *outcome).collect();
    let names = super::subjects(report, &outcomes, usize::MAX);
    let (does, its) = match outcomes.len() {
        1 => ("does", "its"),
        _ => ("do", "their"),
    };
    Some(format!(
        "{names} {does} not say what impacts and friction take: {its} energy counts it as lost"
    ))
}

/// Whether there is a penalty.
fn presses(rows: &[(&Outcome, &Contact)]) -> bool {
    rows.iter().any(|(outcome, _)| {
        let energy = outcome.energy.as_ref();
        energy.is_some_and(|energy| energy.potential_final_j.contains_key("penalty"))
    })
}

/// Whether energy was taken, J: rounding of impacts that lose nothing is nothing.
fn is_real(energy: &Energy, joules: Option<f64>) -> bool {
    let most = energy.initial_j.unwrap_or(0.0).abs();
    joules.is_some_and(|joules| joules.abs() > 1e-12 * most)
}

/// The contact of the scene's own engine, or else the first, for the terminal.
pub fn own(report: &Report) -> Vec<(&'static str, String)> {
    let spoken = super::spoken_of(report, |o| o.contact.is_some());
    let Some((outcome, contact)) = spoken.and_then(|o| Some((o, o.contact.as_ref()?))) else {
        return Vec::new();
    };
    let mut parts = Vec::new();
    if let Some(impacts) = contact.impacts {
        parts.push(words::plural(impacts, "impact"));
    }
    let energy = outcome.energy.as_ref();
    let lost = energy.into_iter().flat_map(|energy| {
        let lost = [
            (energy.impacts_j, "in impacts"),
            (energy.friction_j, "to friction"),
        ];
        lost.into_iter()
            .filter(|(joules, _)| is_real(energy, *joules))
    });
    parts.extend(
        lost.filter_map(|(joules, by)| Some(format!("{} J lost {by}", words::short(joules?)))),
    );
    if let Some(inside) = inside(contact) {
        let deepest = words::short(contact.deepest_m);
        parts.push(format!("at most {deepest} m deep: {inside}"));
    }
    let touching = match contact.touching {
        0 => "nothing touches at the end".to_owned(),
        1 => "one particle touches at the end".to_owned(),
        count => format!("{} particles touch at the end", words::count(count)),
    };
    parts.push(touching);
    let text = format!("{}: {}", words::one_line(&outcome.engine), parts.join(", "));
    let mut said = vec![("contact", text)];
    said.extend(laws::summary(contact).into_iter().map(|law| ("", law)));
    if let Some((outcome, contact)) = differing(&rows(report)) {
        let engine = words::one_line(&outcome.engine);
        let first = contact.differs.first().map_or("", String::as_str);
        said.push(("", format!("{engine}: {first}")));
    }
    said
}
