//! The examples do what their heads say.

use std::path::Path;
use std::process::{Command, Output};

/// Runs an example that `cargo test` has built beside the program.
fn run(name: &str) -> Output {
    let program = Path::new(env!("CARGO_BIN_EXE_springcheck"));
    let example = program.with_file_name("examples").join(name);
    let example = example.with_extension(std::env::consts::EXE_EXTENSION);
    let source = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("examples")
        .join(name);
    let changed = |path: &Path| path.metadata().and_then(|about| about.modified()).ok();
    assert!(
        changed(&example).is_some_and(|built| Some(built) >= changed(&source.with_extension("rs"))),
        "{} is missing or older than its source: a `cargo test` of everything builds it, or \
         `cargo build --example {name}` in the same profile",
        example.display()
    );
    Command::new(&example)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("started")
}

#[test]
fn the_custom_integrator_is_believed_and_the_one_that_lies_is_caught() {
    let output = run("custom_integrator");
    let text = String::from_utf8(output.stdout).expect("text");
    assert!(output.status.success(), "{text}");
    let of = |who: &str| -> Vec<&str> { text.lines().filter(|l| l.starts_with(who)).collect() };
    let status = |line: &str| line.split_whitespace().nth(2).map(str::to_owned);
    let (honest, liar) = (of("ruth3"), of("leapfrog"));
    // The last line of each is of the run.
    let [honest_laws @ .., honest_run] = &honest[..] else {
        panic!("{text}")
    };
    let [liar_laws @ .., liar_run] = &liar[..] else {
        panic!("{text}")
    };
    assert_eq!(honest_laws.len(), liar_laws.len());
    for line in honest_laws {
        assert_eq!(status(line).as_deref(), Some("pass"), "{line}");
    }
    let accused: Vec<&str> = liar_laws
        .iter()
        .filter(|line| status(line).as_deref() == Some("fail"))
        .filter_map(|line| line.split_whitespace().nth(1))
        .collect();
    let right = ["order", "order-driven", "contact", "exactness"];
    assert_eq!(accused, right, "{text}");
    assert!(
        liar_laws[0].contains("claims order 2, observed 1.000"),
        "{text}"
    );
    // Both are rows beside rapier's.
    assert_eq!(of("rapier ").len(), 1, "{text}");
    for line in [honest_run, liar_run] {
        let apart: f64 = line
            .split_whitespace()
            .nth(2)
            .expect("a column")
            .parse()
            .expect("metres");
        assert!(apart > 0.0, "{line}");
    }
}
