//! The answer for one target as a paragraph: which engine reaches it cheapest, how many times the cost of
//! the others is, and which do not reach it.

use super::{at_most, evaluations, metres, price, ratio, setting};
use crate::report::words::{self, grouped, listed};
use crate::verbs::cost::{Cost, CostRank, CostReached, CostTarget};

/// `1e-6 m`.
pub fn label(target: &CostTarget) -> String {
    format!("{} m", metres(target.error_m))
}

/// `rk4 at h = 0.02 s, 0.10 ms (1,000 evaluations)`.
pub fn reached(reached: &CostReached) -> String {
    format!(
        "{} at {}, {}",
        words::one_line(&reached.engine),
        setting(reached.timestep, reached.tolerance),
        price(reached)
    )
}

/// A label and a paragraph for each target. Targets that cannot be judged for the same reason have one
/// paragraph.
pub fn paragraphs(cost: &Cost) -> Vec<(String, String)> {
    let mut above = Vec::new();
    let said = cost.targets.iter().enumerate().map(|(at, target)| {
        let alone = target.reason.is_none().then_some(at);
        (
            metres(target.error_m),
            (alone, paragraph(target, &mut above)),
        )
    });
    let labelled = grouped(said).into_iter();
    labelled
        .map(|((_, text), errors)| (format!("{} m", listed(&errors)), text))
        .collect()
}

/// The paragraph of one target, without its label. Reasons that stand `above` are not said again.
fn paragraph(target: &CostTarget, above: &mut Vec<String>) -> String {
    let mut clauses = Vec::new();
    if let Some(reason) = &target.reason {
        clauses.push(words::one_line(reason));
    }
    let mut there = target.ranking.iter().filter(|rank| rank.reached.is_some());
    let first = there.next().and_then(|rank| rank.reached.as_ref());
    if let Some(first) = first {
        clauses.push(reached(first));
        let rest = there.filter_map(|rank| cost_ratio(rank, first));
        clauses.extend(rest);
        clauses.extend(fewest(target, first));
        clauses.extend(extrapolated(target));
    }
    let missing = misses(&target.ranking, true, above);
    let unreached = "no integrator reaches it";
    clauses.extend(match (first, &target.reason) {
        (None, None) if missing.is_empty() => Some(unreached.to_owned()),
        (None, None) => Some(format!("{unreached}: {missing}")),
        _ => not_reached(missing),
    });
    let beside = target.reference.iter().filter_map(|rank| {
        let times = rank.wall_ratio.map(|r| format!(", {}", ratio(r)));
        Some(reached(rank.reached.as_ref()?) + &times.unwrap_or_default())
    });
    let beside: Vec<String> = beside.collect();
    if !beside.is_empty() {
        clauses.push(format!("beside them, not ranked: {}", listed(&beside)));
    }
    clauses.extend(not_reached(misses(&target.reference, false, above)));
    clauses.join("; ")
}

/// `velocity_verlet 18x`: the ratio of times, or of evaluations where nothing was timed.
fn cost_ratio(rank: &CostRank, first: &CostReached) -> Option<String> {
    let found = rank.reached.as_ref()?;
    let name = words::one_line(&rank.engine);
    if let Some(times) = rank.wall_ratio {
        return Some(format!("{name} {}", ratio(times)));
    }
    let untimed = first.wall_median_s.or(found.wall_median_s).is_none();
    Some(match (first.force_evaluations, found.force_evaluations) {
        (Some(least), Some(count)) if untimed && least > 0 => {
            format!("{name} {}", ratio(count as f64 / least as f64))
        }
        _ => format!("{name}, {}", price(found)),
    })
}

/// The engine with the fewest evaluations, where that is not the fastest.
fn fewest(target: &CostTarget, first: &CostReached) -> Option<String> {
    let fewest = target.fewest_evaluations.as_ref()?;
    if fewest.engine == first.engine {
        return None;
    }
    let count = fewest.force_evaluations?;
    Some(format!(
        "fewest evaluations: {} at {}, {}{}",
        words::one_line(&fewest.engine),
        setting(fewest.timestep, fewest.tolerance),
        at_most(fewest),
        evaluations(count)
    ))
}

/// The engines that would reach the target at finer settings than were tried, and at what cost.
fn extrapolated(target: &CostTarget) -> Option<String> {
    let would = target.ranking.iter().filter_map(|rank| {
        let times = ratio(rank.extrapolated_wall_ratio?);
        Some(format!("{} {times}", words::one_line(&rank.engine)))
    });
    let would = would.collect::<Vec<_>>().join(", ");
    (!would.is_empty()).then(|| format!("not reached, but by their slopes about: {would}"))
}

fn not_reached(by: String) -> Option<String> {
    (!by.is_empty()).then(|| format!("not reached by {by}"))
}

/// Characters from which a reason is not said twice.
const LONG: usize = 40;

/// The engines that do not reach the target, and why. Equal reasons stand once. Where a reason differs
/// from the one before in a number alone, only the number stands.
fn misses(ranks: &[CostRank], ranked: bool, above: &mut Vec<String>) -> String {
    // Integrators with an extrapolated cost are left out: `extrapolated` names them.
    let priced = |rank: &&CostRank| rank.extrapolated_wall_ratio.is_some() && ranked;
    let missing = ranks.iter().filter(|rank| rank.reached.is_none());
    let said = grouped(missing.filter(|rank| !priced(rank)).map(|rank| {
        let reason = rank.reason.as_deref().map(words::one_line);
        (words::one_line(&rank.engine), reason.unwrap_or_default())
    }));
    let because = |at: usize, reason: &str| {
        let mut before = said.iter().take(at);
        // The number of another sentence would not say what it counts.
        let number = before
            .find_map(|(known, _)| other_number(known, reason))
            .filter(|_| reason.starts_with("nearest"));
        match number.map_or(reason.to_owned(), str::to_owned).as_str() {
            "" => String::new(),
            text if text.len() > LONG && above.iter().any(|known| known == text) => {
                " (as above)".to_owned()
            }
            text => format!(" ({text})"),
        }
    };
    let texts = said.iter().enumerate();
    let texts = texts.map(|(at, (reason, names))| listed(names) + &because(at, reason));
    let text = texts.collect::<Vec<_>>().join(", ");
    above.extend(said.into_iter().map(|(reason, _)| reason));
    text
}

/// The one number in which `text` differs from `known`; None where they differ otherwise.
fn other_number<'a>(known: &str, text: &'a str) -> Option<&'a str> {
    let (mut old, mut new) = (known.split(' '), text.split(' '));
    let mut found = None;
    loop {
        match (old.next(), new.next()) {
            (None, None) => return found,
            (Some(a), Some(b)) if a == b => {}
            (Some(a), Some(b)) if found.is_none() => {
                a.parse::<f64>().ok()?;
                b.parse::<f64>().ok()?;
                found = Some(b);
            }
            _ => return None,
        }
    }
}
