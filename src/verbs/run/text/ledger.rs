//! Two tables: the energy at the end, and the effects that ran.

use crate::measure::{Energy, Loads, Reaction, Tension};
use crate::report::EffectUse;
use crate::report::table::Table;
use crate::report::terminal::clip;
use crate::report::words::{self, escape};
use crate::verbs::Report;
use crate::verbs::run::Outcome;

/// The table of the final energy by effect, the dissipated and injected energy, and the momentum errors.
pub fn energies(report: &Report) -> String {
    let rows: Vec<(&Outcome, &Energy)> = report
        .outcomes()
        .iter()
        .filter_map(|outcome| Some((outcome, outcome.energy.as_ref()?)))
        .collect();
    let Some((_, first)) = rows.first() else {
        return String::new();
    };
    let header = &report.header;
    let mut table = Table::new(&rows);
    table.engines(|(o, _)| (super::engine(o), header.mark(&o.engine)));
    table.markdown("kinetic", |(_, energy)| number(energy.kinetic_final_j));
    // An effect without potential energy would only add a column of zeros.
    for (id, _) in first
        .potential_final_j
        .iter()
        .filter(|(_, joules)| **joules != 0.0)
    {
        table.markdown(&escape(id), |(_, energy)| {
            number(energy.potential_final_j.get(id).copied())
        });
    }
    table.markdown("dissipated", |(_, energy)| number(energy.dissipated_j));
    table.markdown("injected", |(_, energy)| number(energy.injected_j));
    table.markdown("E final - E initial", |(_, energy)| {
        let change = energy.final_j.zip(energy.initial_j);
        number(change.map(|(end, start)| end - start))
    });
    if report.outcomes().iter().any(|o| o.momentum.is_some()) {
        table.markdown("momentum off by", |(o, _)| {
            number(o.momentum.as_ref().and_then(|m| m.linear_error_max))
        });
        table.markdown("angular momentum off by", |(o, _)| {
            number(o.momentum.as_ref().and_then(|m| m.angular_error_max))
        });
    }
    let intro = "Joules at the last recorded instant; momenta in kg m/s and kg m²/s, where the scene \
                 conserves them.";
    format!("{intro}\n\n{}", table.in_markdown())
}

/// The table of the largest tensions and of what holds fixed particles at the end; empty where nobody asked.
pub fn loads(report: &Report) -> String {
    let rows: Vec<(&Outcome, &Loads)> = report
        .outcomes()
        .iter()
        .filter_map(|outcome| Some((outcome, outcome.loads.as_ref()?)))
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let mut table = Table::new(&rows);
    table.engines(|(o, _)| (super::engine(o), report.header.mark(&o.engine)));
    table.markdown("largest tension", |(_, loads)| {
        loads.tension_max.as_ref().map(tension)
    });
    table.markdown("smallest tension", |(_, loads)| {
        loads.tension_min.as_ref().map(tension)
    });
    table.markdown("holds at the end", |(_, loads)| {
        let held = loads.reactions_final.iter().take(HELD).map(reaction);
        let hidden = loads.reactions_final.len().saturating_sub(HELD);
        let more = (hidden > 0).then(|| format!("{hidden} more"));
        let all: Vec<String> = held.chain(more).collect();
        (!all.is_empty()).then(|| all.join("; "))
    });
    let intro = "Newtons. A spring pulls where its tension is above 0, its damper included, and pushes below. What holds a \
                 fixed particle is minus the sum of the other forces on it.";
    format!("{intro}\n\n{}", table.in_markdown())
}

/// Fixed particles that a text names.
const HELD: usize = 4;

/// The loads of the first engine that has some, for the terminal.
pub fn own_loads(report: &Report) -> Vec<(&'static str, String)> {
    let first = report.outcomes().iter().find(|o| o.loads.is_some());
    let Some((engine, loads)) =
        first.and_then(|o| Some((words::one_line(&o.engine), o.loads.as_ref()?)))
    else {
        return Vec::new();
    };
    let mut lines = Vec::new();
    if let Some(most) = &loads.tension_max {
        lines.push(("tension", format!("{engine}: at most {}", tension(most))));
    }
    for (at, held) in loads.reactions_final.iter().take(HELD).enumerate() {
        let label = if at == 0 { "reactions" } else { "" };
        lines.push((label, format!("{engine} at the end: {}", reaction(held))));
    }
    lines
}

/// `14.7 N in spring 3 at 0.5 s`
fn tension(tension: &Tension) -> String {
    let (newtons, t) = (words::short(tension.tension_n), words::short(tension.t_s));
    format!("{newtons} N in spring {} at {t} s", tension.spring)
}

/// `particle 0 is held by (0, 0, 9.81) N`
fn reaction(reaction: &Reaction) -> String {
    let force = reaction.force_n.map(words::short).join(", ");
    format!("particle {} is held by ({force}) N", reaction.particle)
}

fn number(value: Option<f64>) -> Option<String> {
    value.map(words::short)
}

/// The table of the effects that ran: evaluations and time.
pub fn effects(effects: &[EffectUse]) -> String {
    if effects.is_empty() {
        return String::new();
    }
    let mut table = Table::new(effects);
    table.markdown("effect", |effect| escape(&effect.id));
    table.markdown("acts on", |effect| effect.members.to_string());
    table.markdown("evaluations", |effect| words::count(effect.evaluations));
    table.markdown("time each", time_each);
    table.in_markdown()
}

/// The effects for the terminal, one line each: label and text.
pub fn lines(effects: &[EffectUse]) -> Vec<(&'static str, String)> {
    let ids = effects.iter().map(|effect| words::one_line(&effect.id));
    let lines = effects
        .iter()
        .zip(ids)
        .enumerate()
        .map(|(i, (effect, id))| {
            let label = if i == 0 { "effects" } else { "" };
            let id = clip(&id, 24);
            let on = words::count(effect.members as u64);
            let evaluations = words::count(effect.evaluations);
            let cost = time_each(effect).map_or(String::new(), |time| format!(", {time} each"));
            (
                label,
                format!("{id} on {on}: {evaluations} evaluations{cost}"),
            )
        });
    lines.collect()
}

/// The wall time of one evaluation.
fn time_each(effect: &EffectUse) -> Option<String> {
    effect.wall_ns.map(|ns| words::seconds(ns * 1e-9))
}
