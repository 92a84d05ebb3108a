//! The table of outcome keys that a scene's `expect` may name.

use crate::integrators;
use crate::scene::{KeyKind, Names, OutcomeKey};
use crate::solvers::rapier;
use crate::verbs::scheme;
use std::sync::LazyLock;

/// The methods, engines and keys that a scene file may refer to. [`verbs::names`](crate::verbs::names) has all names.
pub fn names() -> &'static Names {
    static NAMES: LazyLock<Names> = LazyLock::new(|| Names {
        methods: integrators::ids(integrators::fixed()),
        aliases: integrators::ALIASES,
        engines: rapier::IDS.to_vec(),
        externals: Vec::new(),
        checks: Vec::new(),
        keys: keys(),
    });
    &NAMES
}

/// Dotted paths into an outcome; `*` stands for each reference engine.
///
/// The table leaves out keys that the expectation itself states (`engine`, `kind`, `timestep`, `substep`), keys that
/// vary from run to run (`work.wall_s`), lists, and the parts of the final energy.
fn keys() -> Vec<OutcomeKey> {
    let word = |words: &[&'static str]| KeyKind::Word(words.to_vec());
    let rows = [
        (
            "status",
            word(&["completed", "diverged", "failed", "unsupported"]),
        ),
        ("stopped_at_s", KeyKind::Number),
        ("reason", KeyKind::Text),
        ("position_error_m.final", KeyKind::Number),
        ("position_error_m.max", KeyKind::Number),
        ("position_error_m.rms", KeyKind::Number),
        ("velocity_error_m_s.final", KeyKind::Number),
        ("velocity_error_m_s.max", KeyKind::Number),
        ("velocity_error_m_s.rms", KeyKind::Number),
        ("deviation_m.*.final", KeyKind::Number),
        ("deviation_m.*.max", KeyKind::Number),
        ("deviation_m.*.first_exceeds_s", KeyKind::Number),
        ("energy.initial_j", KeyKind::Number),
        ("energy.final_j", KeyKind::Number),
        ("energy.relative_error_max", KeyKind::Number),
        ("energy.drift_per_s", KeyKind::Number),
        ("energy.fluctuation", KeyKind::Number),
        ("energy.dissipated_j", KeyKind::Number),
        ("energy.injected_j", KeyKind::Number),
        ("energy.projected_j", KeyKind::Number),
        ("energy.samples", KeyKind::Number),
        (
            "energy.class",
            word(&["bounded", "drifting", "dissipating", "growing"]),
        ),
        ("rods.length_error_max_m", KeyKind::Number),
        ("rods.velocity_along_max_m_s", KeyKind::Number),
        (
            "rods.length_growth.law",
            word(&["rounding", "bounded", "power"]),
        ),
        ("rods.length_growth.exponent", KeyKind::Number),
        ("rods.tension_max.tension_n", KeyKind::Number),
        ("rods.tension_min.tension_n", KeyKind::Number),
        ("energy.limited_j", KeyKind::Number),
        ("energy.impacts_j", KeyKind::Number),
        ("energy.friction_j", KeyKind::Number),
        ("contact.deepest_m", KeyKind::Number),
        ("contact.particle", KeyKind::Number),
        ("contact.collider", KeyKind::Number),
        ("contact.other", KeyKind::Number),
        ("contact.inside", KeyKind::Text),
        ("contact.t_s", KeyKind::Number),
        ("contact.touching", KeyKind::Number),
        ("contact.impacts", KeyKind::Number),
        ("strain.largest", KeyKind::Number),
        ("strain.spring", KeyKind::Number),
        ("strain.t_s", KeyKind::Number),
        ("strain.met", word(&["true", "false"])),
        ("strain.corrections", KeyKind::Number),
        ("strain.sweeps", KeyKind::Number),
        ("momentum.linear_error_max_kg_m_s", KeyKind::Number),
        ("momentum.angular_error_max_kg_m2_s", KeyKind::Number),
        ("work.steps", KeyKind::Number),
        ("work.force_evaluations", KeyKind::Number),
        ("work.linear_solves", KeyKind::Number),
        ("work.world.bodies", KeyKind::Number),
        ("work.world.joints", KeyKind::Number),
        ("identified.method", word(&scheme::ids())),
        ("identified.substeps", KeyKind::Number),
        ("identified.defect", KeyKind::Number),
        ("identified.relative", KeyKind::Number),
        ("identified.runner_up", KeyKind::Text),
        ("identified.runner_up_defect", KeyKind::Number),
        ("identified.decisive", word(&["true", "false"])),
        (
            "identified.undecided",
            word(&["same_map", "data_too_coarse", "near"]),
        ),
    ];
    let mut keys = Vec::new();
    for (path, kind) in rows {
        // A path without `*` has nothing to replace and gives one key.
        let engines = if path.contains('*') {
            &rapier::IDS[..]
        } else {
            &[""]
        };
        keys.extend(engines.iter().map(|engine| OutcomeKey {
            path: path.replace('*', engine),
            kind: kind.clone(),
        }));
    }
    let laws = [
        "separation",
        "impact_friction",
        "sliding_friction",
        "energy_gain",
    ];
    let parts = [
        "off", "bound", "found", "asked", "judged", "particle", "t_s",
    ];
    keys.extend(laws.iter().flat_map(|law| {
        parts.iter().map(move |part| OutcomeKey {
            path: format!("contact.{law}.{part}"),
            kind: KeyKind::Number,
        })
    }));
    keys
}
