//! Any bytes: whole finite states at increasing steps, or an error; never a panic.
//!
//! `mkdir -p fuzz/corpus/trajectory && cp tests/inputs/trajectories/samples/*.[cn]* fuzz/corpus/trajectory/`,
//! then `cargo +nightly fuzz run trajectory -- -dict=fuzz/trajectory.dict`.

#![no_main]

use libfuzzer_sys::fuzz_target;
use springcheck::scene::{self, Names};
use springcheck::trajectory::{self, Expected, Layout};
use std::sync::LazyLock;

/// The samples' scene: one free particle on one axis, which takes every form there is.
static EXPECTED: LazyLock<Expected> = LazyLock::new(|| {
    let yaml = b"solver: {type: midpoint, timestep: 0.25}\n\
        particles: [{pos: [0, 0, 2], fixed: true}, {pos: [0, 0, 1], mass: 2}]\n\
        springs: [{particle_ids: [0, 1], stiffness: 20}]";
    let names = Names {
        methods: vec!["midpoint"],
        ..Names::default()
    };
    let scene = scene::parse(yaml, "fuzz.yml", &names).expect("a scene");
    Expected::new(&scene, scene.solver.timestep)
});

fuzz_target!(|bytes: &[u8]| {
    for layout in [None, Some(Layout::Csv)] {
        let rows = match trajectory::read(bytes, "fuzz", layout, &EXPECTED) {
            Ok(rows) => rows,
            Err(error) => {
                assert!(error.to_string().starts_with("fuzz:"));
                continue;
            }
        };
        assert!(!rows.is_empty() && rows.steps.is_sorted_by(|a, b| a < b));
        assert_eq!(rows.x.len(), rows.len() * rows.dim);
        assert!(
            rows.x
                .iter()
                .chain(rows.v.iter().flatten())
                .all(|x| x.is_finite())
        );
        assert!(rows.v.is_none_or(|v| v.len() == rows.x.len()));
    }
});
