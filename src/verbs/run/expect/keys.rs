//! What a scene may expect something of: the keys of an outcome, a table.

use crate::integrators;
use crate::measure::identify::{MISTAKES, Wrong};
use crate::scene::{Key, KeyKind, Names};
use crate::solvers::rapier;
use std::sync::LazyLock;

/// A key's kind before its words are known.
enum Row {
    Words(&'static [&'static str]),
    /// An id of a method or of a mistake in one.
    Scheme,
    Number,
    Text,
}

use Row::{Number, Scheme, Text, Words};

/// Dotted paths into an outcome; `*` stands for each reference engine.
///
/// Left out is what the expectation states itself (`engine`, `kind`, `timestep`, `substep`), what
/// varies from run to run (`work.wall_s`), lists, and what the energy at the end is made of.
const ROWS: &[(&str, Row)] = &[
    (
        "status",
        Words(&["completed", "diverged", "failed", "unsupported"]),
    ),
    ("stopped_at_s", Number),
    ("reason", Text),
    ("position_error_m.final", Number),
    ("position_error_m.max", Number),
    ("position_error_m.rms", Number),
    ("velocity_error_m_s.final", Number),
    ("velocity_error_m_s.max", Number),
    ("velocity_error_m_s.rms", Number),
    ("deviation_m.*.final", Number),
    ("deviation_m.*.max", Number),
    ("deviation_m.*.first_exceeds_s", Number),
    ("energy.initial_j", Number),
    ("energy.final_j", Number),
    ("energy.relative_error_max", Number),
    ("energy.drift_per_s", Number),
    ("energy.fluctuation", Number),
    (
        "energy.class",
        Words(&["bounded", "drifting", "dissipating", "growing"]),
    ),
    ("momentum.linear_error_max_kg_m_s", Number),
    ("momentum.angular_error_max_kg_m2_s", Number),
    ("work.steps", Number),
    ("work.force_evaluations", Number),
    ("work.linear_solves", Number),
    ("identified.method", Scheme),
    ("identified.substeps", Number),
    ("identified.defect", Number),
    ("identified.runner_up", Text),
    ("identified.runner_up_defect", Number),
    ("identified.decisive", Words(&["true", "false"])),
    (
        "identified.undecided",
        Words(&["same_map", "data_too_coarse", "nothing_fits"]),
    ),
];

/// Every word a scene file may use that is not its own: for [`scene::parse`](crate::scene::parse)
/// and [`scene::read`](crate::scene::read).
pub fn names() -> &'static Names {
    static NAMES: LazyLock<Names> = LazyLock::new(|| Names {
        methods: integrators::ids(integrators::fixed()),
        engines: rapier::IDS.to_vec(),
        keys: keys(),
    });
    &NAMES
}

fn keys() -> Vec<Key> {
    let mut keys = Vec::new();
    for (path, row) in ROWS {
        let kind = match row {
            Words(words) => KeyKind::Word(words.to_vec()),
            Scheme => KeyKind::Word(schemes()),
            Number => KeyKind::Number,
            Text => KeyKind::Text,
        };
        // Without a `*` there is nothing to replace, and the key is there once.
        let engines = if path.contains('*') {
            rapier::IDS.to_vec()
        } else {
            vec![""]
        };
        keys.extend(engines.iter().map(|engine| Key {
            path: path.replace('*', engine),
            kind: kind.clone(),
        }));
    }
    keys
}

fn schemes() -> Vec<&'static str> {
    let steps = MISTAKES
        .iter()
        .filter(|mistake| matches!(mistake.wrong, Wrong::Step { .. }));
    integrators::ids(integrators::fixed())
        .into_iter()
        .chain(steps.map(|mistake| mistake.id))
        .collect()
}
