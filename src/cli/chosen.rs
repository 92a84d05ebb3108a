//! The integrators and engines a command line names.

use super::rapier::Custom;
use anyhow::Context;
use springcheck::crosscheck::{Choice, ChosenEngine};
use springcheck::engines;
use springcheck::integrators::{self, Method};
use springcheck::scene::Scene;

/// The methods of these ids in this order, all of them for `all`, and `usual` for none.
pub fn methods(
    ids: &[String],
    scene: &Scene,
    usual: Vec<&'static Method>,
) -> anyhow::Result<Vec<&'static Method>> {
    match ids {
        [] => Ok(usual),
        [all] if all == "all" => Ok(Choice::all_methods(scene)),
        ids => each(ids, integrators::find, || {
            format!("integrators: {}, or all", integrators::ids().join(", "))
        }),
    }
}

/// The engines of these ids, none for `none`, and `usual` without ids; after them the rapier rows with
/// settings of the user's own, the same settings once.
pub fn engines(
    ids: &[String],
    rapier: &[Custom],
    usual: Vec<ChosenEngine>,
) -> anyhow::Result<Vec<ChosenEngine>> {
    let mut chosen = match ids {
        [] => usual,
        [none] if none == "none" => Vec::new(),
        ids => {
            let rows = each(ids, engines::find, || {
                format!("engines: {}, or none", engines::ids().join(", "))
            })?;
            rows.into_iter().map(ChosenEngine::from).collect()
        }
    };
    for custom in rapier.iter().map(Custom::chosen) {
        let known = |e: &ChosenEngine| e.row.id == custom.row.id;
        if !chosen.iter().any(known) {
            chosen.push(custom);
        }
    }
    Ok(chosen)
}

/// Looks each id up, once; an unknown one is an error that lists what there is.
fn each<T>(
    ids: &[String],
    find: impl Fn(&str) -> Option<&'static T>,
    known: impl Fn() -> String,
) -> anyhow::Result<Vec<&'static T>> {
    let mut rows = Vec::new();
    for (at, id) in ids.iter().enumerate() {
        if ids[..at].contains(id) {
            continue;
        }
        rows.push(find(id).with_context(|| format!("unknown `{id}`; known {}", known()))?);
    }
    Ok(rows)
}
