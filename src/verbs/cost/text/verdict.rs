//! The verdict of `cost`: which integrator to use.

use super::{answer, metres, ratio};
use crate::report::verdict::Clause;
use crate::report::words::{self, listed};
use crate::verbs::Report;
use crate::verbs::cost::{Cost, CostReached, CostTarget};

/// One clause for the cheapest integrator of each target, hardest first. The first is followed by what the
/// scene's own integrator takes. The targets that no integrator reaches come last.
pub fn clauses(report: &Report, cost: &Cost) -> Vec<Clause> {
    let mut clauses: Vec<Clause> = Vec::new();
    // The hardest come first, so that easy ones are left out for width.
    let mut hardest: Vec<&CostTarget> = cost.targets.iter().collect();
    hardest.sort_by(|a, b| a.error_m.total_cmp(&b.error_m));
    for target in hardest {
        let leads = clauses.is_empty();
        let Some(clause) = cheapest(target, leads) else {
            continue;
        };
        clauses.push(clause);
        clauses.extend(own(report, target).filter(|_| leads));
    }
    let unreached = |target: &&CostTarget| first(target).is_none();
    let (open, unreached): (Vec<_>, Vec<_>) = cost
        .targets
        .iter()
        .filter(unreached)
        .partition(|target| target.reason.is_some());
    clauses.extend(group("no integrator reaches", &unreached).map(|text| vec![text]));
    if let Some(reason) = open.first().and_then(|target| target.reason.as_ref()) {
        let reason = words::one_line(reason);
        let open = group("nobody can be said to reach", &open);
        clauses.extend(
            open.map(|text| format!("{text}: {reason}"))
                .map(|text| vec![text]),
        );
    }
    if clauses.is_empty() {
        let mut curves = cost.curves.iter();
        let text = match curves.any(|curve| super::nearest(curve).is_some()) {
            false => "no setting gave an error against the truth",
            true => "no target was asked about",
        };
        clauses.push(vec![text.to_owned()]);
    }
    clauses
}

/// The first setting in a target's ranking.
fn first(target: &CostTarget) -> Option<&CostReached> {
    target.ranking.iter().find_map(|rank| rank.reached.as_ref())
}

fn cheapest(target: &CostTarget, leads: bool) -> Option<Clause> {
    let found = first(target)?;
    let lead = if leads { "cheapest to " } else { "to " };
    let label = answer::label(target);
    let name = words::one_line(&found.engine);
    let h = match found.tolerance {
        Some(tolerance) => format!("tolerance {}", metres(tolerance)),
        None => format!("h = {} s", words::short(found.timestep)),
    };
    let timed = found.wall_median_s.map(words::seconds);
    let paid = timed.or(found.force_evaluations.map(super::evaluations));
    let at_most = super::at_most(found);
    let paid = paid.map_or(String::new(), |paid| format!(", {at_most}{paid}"));
    let mut forms = vec![format!("{lead}{label}: {name} at {h}{paid}")];
    if !leads {
        forms.extend([format!("{lead}{label}: {name}"), String::new()]);
    }
    Some(forms)
}

/// `symplectic_euler, the scene's own, takes 6,200x the time`.
fn own(report: &Report, target: &CostTarget) -> Option<Clause> {
    let mut ranks = target.ranking.iter();
    let rank = ranks.find(|rank| report.header.is_own(&rank.engine))?;
    let name = words::one_line(&rank.engine);
    let [long, short] = match (&rank.reached, rank.wall_ratio) {
        (None, _) => ["does not reach it".to_owned(), "does not".to_owned()],
        (Some(_), Some(times)) if times > 1.0 => {
            let times = ratio(times);
            [format!("takes {times} the time"), times]
        }
        _ => return None,
    };
    Some(vec![
        format!("{name}, the scene's own, {long}"),
        format!("{name} {short}"),
        String::new(),
    ])
}

fn group(lead: &str, targets: &[&CostTarget]) -> Option<String> {
    let errors: Vec<String> = targets.iter().map(|t| metres(t.error_m)).collect();
    (!errors.is_empty()).then(|| format!("{lead} {} m", listed(&errors)))
}
