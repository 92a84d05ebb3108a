//! Two tables: the energy at the end, and the effects that ran, with the bodies and joints of rapier's worlds.

use crate::measure::{Energy, Loads, Reaction, Tension};
use crate::report::EffectUse;
use crate::report::table::Table;
use crate::report::terminal::clip;
use crate::report::words::{self, escape};
use crate::scene::object::called;
use crate::solvers::Built;
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
    if report.outcomes().iter().any(|o| o.strain.is_some()) {
        table.markdown("limited", |(_, energy)| number(energy.limited_j));
    }
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
        let held = loads.reactions_final.iter().take(HELD);
        let held = held.map(|held| escape(&reaction(held, report)));
        let hidden = loads.reactions_final.len().saturating_sub(HELD);
        let more = (hidden > 0).then(|| format!("{hidden} more"));
        let all: Vec<String> = held.chain(more).collect();
        (!all.is_empty()).then(|| all.join("; "))
    });
    let limited = match rows.iter().any(|(o, _)| o.strain.is_some()) {
        true => {
            " The impulses of the strain limit are left out: their sum stands under *Strain limit*."
        }
        false => "",
    };
    let intro = "Newtons. A spring pulls where its tension is above 0, its damper included, and pushes below. What holds a \
                 fixed particle is minus the sum of the other forces on it.";
    format!("{intro}{limited}\n\n{}", table.in_markdown())
}

/// Fixed particles that a text names.
const HELD: usize = 4;

/// The loads of one engine, for the terminal.
pub fn own_loads(report: &Report) -> Vec<(&'static str, String)> {
    let spoken = super::spoken_of(report, |o| o.loads.is_some());
    let Some((engine, loads)) =
        spoken.and_then(|o| Some((words::one_line(&o.engine), o.loads.as_ref()?)))
    else {
        return Vec::new();
    };
    let mut lines = Vec::new();
    if let Some(most) = &loads.tension_max {
        lines.push(("tension", format!("{engine}: at most {}", tension(most))));
    }
    for (at, held) in loads.reactions_final.iter().take(HELD).enumerate() {
        let label = if at == 0 { "reaction" } else { "" };
        let mut text = format!("{engine} at the end: {}", reaction(held, report));
        if spoken.is_some_and(|o| o.strain.is_some()) {
            text += ", without what the strain limit does";
        }
        lines.push((label, text));
    }
    lines
}

/// `14.7 N in spring 3 at 0.5 s`
fn tension(tension: &Tension) -> String {
    let (newtons, t) = (words::short(tension.tension_n), words::short(tension.t_s));
    format!("{newtons} N in spring {} at {t} s", tension.spring)
}

/// `particle 0 is held by (0, 0, 9.81) N`
fn reaction(reaction: &Reaction, report: &Report) -> String {
    let force = reaction.force_n.map(words::short).join(", ");
    let particle = called(&report.header.scene.objects, reaction.particle);
    format!("particle {particle} is held by ({force}) N")
}

fn number(value: Option<f64>) -> Option<String> {
    value.map(words::short)
}

/// The table of the effects that ran: evaluations and time; and what rapier's worlds were built of.
pub fn effects(report: &Report) -> String {
    let effects = &report.header.scene.effects;
    let mut text = worlds(report).map_or_else(String::new, |worlds| format!("{worlds}.\n"));
    if effects.is_empty() {
        return text;
    }
    let mut table = Table::new(effects);
    table.markdown("effect", |effect| escape(&effect.id));
    table.markdown("acts on", |effect| effect.members.to_string());
    table.markdown("evaluations", |effect| words::count(effect.evaluations));
    table.markdown("time each", time_each);
    table.markdown("share of the forces' time", |effect| share(effect, effects));
    if !text.is_empty() {
        text.insert(0, '\n');
    }
    table.in_markdown() + &text
}

/// The effects for the terminal, one line each, and rapier's worlds: label and text.
pub fn lines(report: &Report) -> Vec<(&'static str, String)> {
    let effects = &report.header.scene.effects;
    let line = |(at, effect): (usize, &EffectUse)| {
        let label = if at == 0 { "effects" } else { "" };
        let id = clip(&words::one_line(&effect.id), 24);
        let on = words::count(effect.members as u64);
        let evaluations = words::count(effect.evaluations);
        let each = time_each(effect).map(|time| format!("{time} each"));
        // The share of a lone effect is all.
        let share = share(effect, effects).filter(|_| effects.len() > 1);
        let share = share.map(|share| format!("{share} of the time"));
        let facts = [Some(format!("{evaluations} evaluations")), each, share];
        let facts: Vec<String> = facts.into_iter().flatten().collect();
        (label, format!("{id} on {on}: {}", facts.join(", ")))
    };
    let lines = effects.iter().enumerate().map(line);
    let worlds = worlds(report).map(|worlds| ("worlds", worlds));
    lines.chain(worlds).collect()
}

/// The bodies and joints of rapier's worlds, each size once; None where none was built.
fn worlds(report: &Report) -> Option<String> {
    let mut worlds: Vec<(Built, Vec<&str>)> = Vec::new();
    for outcome in report.outcomes() {
        let Some(built) = outcome.work.world else {
            continue;
        };
        match worlds.iter_mut().find(|(other, _)| *other == built) {
            Some((_, engines)) if engines.contains(&outcome.engine.as_str()) => {}
            Some((_, engines)) => engines.push(&outcome.engine),
            None => worlds.push((built, vec![&outcome.engine])),
        }
    }
    let each = worlds.iter().map(|(Built { bodies, joints }, engines)| {
        let joints = match joints {
            0 => "no joints".to_owned(),
            joints => words::plural(*joints, "joint"),
        };
        let bodies = match bodies {
            1 => "1 body".to_owned(),
            bodies => format!("{} bodies", words::count(*bodies)),
        };
        let engines = words::one_line(&engines.join(", "));
        format!("{engines}: {bodies}, {joints}")
    });
    let each: Vec<String> = each.collect();
    (!each.is_empty()).then(|| each.join("; "))
}

/// The wall time of one evaluation.
fn time_each(effect: &EffectUse) -> Option<String> {
    effect.wall_ns.map(|ns| words::seconds(ns * 1e-9))
}

/// Its part of the time that all effects took.
fn share(effect: &EffectUse, effects: &[EffectUse]) -> Option<String> {
    let time = |effect: &EffectUse| Some(effect.wall_ns? * effect.evaluations as f64);
    let whole: f64 = effects.iter().filter_map(time).sum();
    let part = time(effect)? / whole;
    part.is_finite().then(|| format!("{:.0} %", 100.0 * part))
}
