//! The laws of contact in words: how far an engine is off each.

use crate::measure::{Contact, Laws, Residual};
use crate::report::words::{self, short};
use crate::verbs::run::Outcome;

/// What is off by less is rounding.
const ROUNDING: f64 = 1e-9;

/// A cell of the table.
pub fn cell(law: Option<Residual>) -> Option<String> {
    law.map(|law| short(law.off))
}

/// A sentence for each law that was judged, of so many impacts in all.
pub fn sentences(laws: &Laws, impacts: Option<u64>) -> Vec<String> {
    let Laws {
        separation,
        impact_friction,
        sliding_friction,
        energy_gain,
    } = *laws;
    let mut all = Vec::new();
    all.extend(separation.map(|law| {
        let text = format!(
            "in {} it separates at {} of the speed it came with",
            judged(law.judged, impacts),
            ratio(law.found)
        );
        if law.off <= ROUNDING {
            format!(
                "{text}, as e = {} asks, to {}",
                short(law.asked),
                words::sci(law.off)
            )
        } else {
            format!(
                "{text}, where e = {} asks {}: {}",
                short(law.asked),
                short(law.asked),
                verdict(&law)
            )
        }
    }));
    all.extend(impact_friction.map(|law| {
        let cone = format!("µ = {} times the normal impulse", short(law.asked));
        if law.off <= ROUNDING {
            format!("friction of impacts is at most {cone}, as Coulomb's law asks")
        } else {
            let found = ratio(law.found);
            format!(
                "friction of an impact is {found} of the normal impulse, more than {cone}: {}",
                verdict(&law)
            )
        }
    }));
    all.extend(sliding_friction.map(|law| {
        if law.off <= ROUNDING {
            return "friction of what slides is µ N against the sliding, and of what sticks no more than it may be".to_owned();
        }
        let found = ratio(law.found);
        let asked = ratio(law.asked);
        let asks = match found == asked {
            true => "as Coulomb's law asks, but in another direction".to_owned(),
            false => format!("where Coulomb's law asks {asked}"),
        };
        format!("friction on a surface is {found} of the normal force, {asks}: {}", verdict(&law))
    }));
    all.extend(energy_gain.map(|law| {
        if !law.broken() {
            return "impacts and friction put no energy in".to_owned();
        }
        format!(
            "an impact or friction puts {} J in, of particle {} at {} s, where none may",
            short(law.off),
            law.particle,
            short(law.t_s)
        )
    }));
    all
}

/// `7 impacts`, or where more are known to have been `7 of its 153 impacts, which nothing else disturbs,`
fn judged(judged: u64, impacts: Option<u64>) -> String {
    match impacts {
        Some(all) if all > judged => format!(
            "{} of its {}, which nothing else disturbs,",
            words::count(judged),
            words::plural(all, "impact")
        ),
        _ => words::plural(judged, "impact"),
    }
}

/// A law that is missed by less than this beyond its bound is missed by rounding.
const CLEARLY: f64 = 1e-6;

/// What a program misses by more than rounding and the forces between its rows explain, where its treatment of contact does
/// not say it: that is replayed to rounding, but for what the scene asks of things at rest.
pub fn missed(outcome: &Outcome) -> Vec<String> {
    let Some(contact) = &outcome.contact else {
        return Vec::new();
    };
    let treated = outcome
        .identified
        .as_ref()
        .and_then(|found| found.contact.as_ref());
    let treatment = treated.and_then(|treated| treated.treatment.as_deref());
    let known = treated.is_some_and(|treated| !treated.mistakes.is_empty());
    let laws = &contact.laws;
    let friction = laws.sliding_friction;
    let all = match treatment {
        _ if known => [None; 4],
        Some(_) => [None, None, friction, None],
        None => [
            laws.separation,
            laws.impact_friction,
            friction,
            laws.energy_gain,
        ],
    };
    let broken = |law: &Residual| law.off > 2.0 * law.bound + CLEARLY;
    let [separation, impact_friction, sliding_friction, energy_gain] =
        all.map(|law| law.filter(broken));
    let laws = Laws {
        separation,
        impact_friction,
        sliding_friction,
        energy_gain,
    };
    sentences(&laws, contact.impacts)
}

/// For the terminal: the laws that are missed, or else one that is kept.
pub fn summary(contact: &Contact) -> Vec<String> {
    let laws = [
        contact.laws.separation,
        contact.laws.impact_friction,
        contact.laws.sliding_friction,
        contact.laws.energy_gain,
    ];
    let mut all = sentences(&contact.laws, contact.impacts);
    let broken = laws.iter().flatten().map(Residual::broken);
    let missed: Vec<String> = (all.iter().zip(broken))
        .filter(|(_, broken)| *broken)
        .map(|(text, _)| text.clone())
        .collect();
    if missed.is_empty() {
        all.truncate(1);
        return all;
    }
    missed
}

/// `off by 0.1 (particle 0 at 0.4 s), more than forces between its rows and rounding explain (0.02)`
fn verdict(law: &Residual) -> String {
    let explain = if law.broken() {
        "more than forces between its rows and rounding explain"
    } else {
        "no more than forces between its rows and rounding may explain"
    };
    format!(
        "off by {} (particle {} at {} s), {explain} ({})",
        short(law.off),
        law.particle,
        short(law.t_s),
        short(law.bound)
    )
}

/// Without its rounding.
fn ratio(value: f64) -> String {
    short((value * 1e6).round() / 1e6)
}
