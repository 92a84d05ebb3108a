//! Any bytes: a scene whose numbers are all finite, or an error with a place; never a panic.
//!
//! `mkdir -p fuzz/corpus/scene && cp scenes/*/*.yml fuzz/corpus/scene/`, then
//! `cargo +nightly fuzz run scene -- -dict=fuzz/scene.dict`.

#![no_main]

use libfuzzer_sys::fuzz_target;
use springcheck::verbs::names;
use springcheck::scene::{self, Wanted};

fuzz_target!(|bytes: &[u8]| {
    let scene = match scene::parse(bytes, "fuzz.yml", names()) {
        Ok(scene) => scene,
        Err(error) => {
            assert!(error.line.is_some() && error.column.is_some());
            assert!(error.to_string().starts_with("fuzz.yml:"));
            return;
        }
    };
    let mut numbers = vec![scene.duration, scene.solver.timestep, scene.solver.gravity];
    numbers.extend(scene.solver.tolerance);
    for p in &scene.particles {
        numbers.extend(p.position.iter().chain(&p.velocity));
        numbers.extend([p.mass, p.radius, p.drag]);
    }
    for s in &scene.springs {
        numbers.extend([s.stiffness, s.damping, s.rest_length]);
    }
    numbers.extend(scene.gravitational.iter().map(|pair| pair.g));
    if let Some(wind) = &scene.wind {
        numbers.extend(wind.direction.iter().chain([&wind.strength]));
    }
    numbers.extend(scene.plot.iter().filter_map(|plot| plot.y_range).flatten());
    for expectation in &scene.expect {
        match &expectation.wanted {
            Wanted::Words(words) => assert!(!words.is_empty()),
            Wanted::Contains(text) => assert!(!text.is_empty()),
            Wanted::Bounds { above, below } => {
                assert!(above.is_some() || below.is_some());
                numbers.extend(above.iter().chain(below));
            }
        }
    }
    numbers.push(scene.size());
    assert!(numbers.iter().all(|x| x.is_finite()), "{scene:?}");
    assert!(scene.steps(scene.solver.timestep) >= 1);
});
