//! Each kind of expectation passes and fails, and what is not there never passes.

use super::{oscillator, run};
use springcheck::integrators;
use springcheck::measure::{Check, CheckStatus};
use springcheck::scene::{Expectation, Scene, Scope, Wanted};
use springcheck::solvers::rapier;
use springcheck::truth::Demand;
use springcheck::verbs::names;
use springcheck::verbs::run::Outcome;
use springcheck::verbs::run::{Choice, expect};
use springcheck::verbs::{Body, Report};

fn judged(expect: &str) -> (Scene, Report, Vec<Check>) {
    let scene = oscillator(expect);
    let report = run(&scene, &Choice::expected(&scene));
    let checks = expect::check(&scene, &report);
    (scene, report, checks)
}

/// The one check of one expectation.
fn only(expect: &str) -> Check {
    let (_, _, mut checks) = judged(expect);
    assert_eq!(checks.len(), 1, "{checks:?}");
    checks.remove(0)
}

/// The right expectation passes; each wrong one fails, and says these things.
fn holds(right: &str, wrong: &[(&str, &[&str])]) {
    let check = only(right);
    assert_eq!(check.status, CheckStatus::Pass, "{}", check.message);
    assert_eq!(check.id, "expect");
    for (wrong, said) in wrong {
        let check = only(wrong);
        assert_eq!(
            check.status,
            CheckStatus::Fail,
            "{wrong}: {}",
            check.message
        );
        assert!(check.message.contains("at h = 0.1 s"), "{}", check.message);
        for part in *said {
            let found = check.message.contains(part);
            assert!(found, "{wrong}: should say {part:?}: {}", check.message);
        }
    }
}

#[test]
fn words() {
    holds(
        "  explicit_euler: {energy.class: growing}",
        &[(
            "  explicit_euler: {energy.class: [bounded, dissipating]}",
            &["explicit_euler: energy.class should be bounded or dissipating, found growing"],
        )],
    );
    holds(
        "  rk4: {status: [diverged, completed]}",
        &[(
            "  rk4: {status: failed}",
            &["should be failed, found completed"],
        )],
    );
    holds(
        "  velocity_verlet: {identified.decisive: true}",
        &[(
            "  velocity_verlet: {identified.decisive: false}",
            &["found true"],
        )],
    );
    holds(
        "  velocity_verlet: {identified.method: velocity_verlet}",
        &[(
            "  velocity_verlet: {identified.method: rk4}",
            &["found velocity_verlet"],
        )],
    );
}

/// Explicit Euler multiplies the energy by 1 + z^2 a step: by 1.01^100 = 2.7048 here. Its error in
/// units of S = E(0) is 1.7048.
#[test]
fn bounds() {
    let key = "energy.relative_error_max";
    let line = |bounds: &str| format!("  explicit_euler: {{{key}: {{{bounds}}}}}");
    let wrong = [
        (line("below: 1.70"), "below 1.7, found 1.705e0"),
        (line("above: 1.71"), "above 1.71, found"),
        (line("above: 1, below: 1.70"), "above 1.0 and below 1.7"),
        (line("above: 1.71, below: 9"), "above 1.71 and below 9.0"),
    ];
    for right in ["below: 1.71", "above: 1.70", "above: 1.70, below: 1.71"] {
        let wrong: Vec<_> = wrong
            .iter()
            .map(|(line, said)| (line.as_str(), std::slice::from_ref(said)))
            .collect();
        holds(&line(right), &wrong);
    }
    // The bound shown is the one that decides.
    assert_eq!(only(&wrong[2].0).bound, Some(1.70));
    assert_eq!(only(&wrong[3].0).bound, Some(1.71));
    let measured = only(&line("below: 2")).measured.expect("a number");
    assert!((measured - (1.01_f64.powi(100) - 1.0)).abs() < 1e-12);
    // Strict: 100 steps are neither below nor above 100.
    holds(
        "  rk4: {work.steps: {above: 99, below: 101}}",
        &[
            ("  rk4: {work.steps: {below: 100}}", &["found 100,"]),
            ("  rk4: {work.steps: {above: 100}}", &["found 100,"]),
        ],
    );
}

/// Its first outcome, to be changed.
fn first(report: &mut Report) -> &mut Outcome {
    match &mut report.body {
        Body::Run { outcomes } => &mut outcomes[0],
        _ => panic!("no run"),
    }
}

#[test]
fn text_and_nulls() {
    // Nobody fails here, so the reason is put in; whoever completes gives none.
    let (scene, mut report, _) = judged("  rk4: {reason: {contains: particle 1}}");
    let mut status = |reason: Option<&str>| {
        first(&mut report).reason = reason.map(str::to_owned);
        expect::check(&scene, &report)[0].clone()
    };
    let right = status(Some("in step 3: particle 1 is no longer finite"));
    assert_eq!(right.status, CheckStatus::Pass, "{}", right.message);
    let other = status(Some("in step 3: particle 2 is no longer finite"));
    assert_eq!(other.status, CheckStatus::Fail);
    assert!(other.message.contains("found in step 3: particle 2"));
    let none = status(None);
    assert_eq!(none.status, CheckStatus::Fail);
    assert!(none.message.contains("no value (the run completed)"));

    // One end is fixed, so that momentum is not kept: no bound is met, not even one from above.
    holds(
        "  velocity_verlet: {energy.class: bounded}",
        &[
            (
                "  rk4: {momentum.linear_error_max_kg_m_s: {below: 1e300}}",
                &["no value (the scene does not conserve it)"],
            ),
            (
                "  rk4: {momentum.linear_error_max_kg_m_s: {above: -1}}",
                &["no value"],
            ),
            ("  rk4: {stopped_at_s: {below: 1}}", &["the run completed"]),
            (
                "  rk4: {identified.undecided: same_map}",
                &["no value (it is decided)"],
            ),
        ],
    );
    let (scene, _, _) = judged("  rk4: {position_error_m.max: {below: 1}}");
    let blind = Choice {
        truth: Demand::None,
        ..Choice::expected(&scene)
    };
    let checks = expect::check(&scene, &run(&scene, &blind));
    assert_eq!(checks[0].status, CheckStatus::Fail);
    let message = &checks[0].message;
    assert!(
        message.contains("there is no truth: not asked for"),
        "{message}"
    );
}

#[test]
fn a_status_says_what_led_to_it() {
    let scene = oscillator("  rk4: {status: completed}");
    let mut report = run(&scene, &Choice::expected(&scene));
    let outcome = first(&mut report);
    outcome.status = springcheck::solvers::Status::Diverged;
    outcome.reason = Some("in step 7: particle 1 is no longer finite".into());
    let message = &expect::check(&scene, &report)[0].message;
    assert_eq!(
        message,
        "rk4: status should be completed, found diverged (in step 7: particle 1 is no longer \
         finite), at h = 0.1 s"
    );
}

/// What each word is about, and which key wins.
#[test]
fn all_rest_and_own_lines() {
    let (_, report, checks) = judged(
        "  all: {status: completed, energy.class: bounded}\n  explicit_euler: {energy.class: \
         growing}\n  rest: {energy.class: [bounded, drifting, dissipating, growing]}",
    );
    // Two keys of every integrator, nothing of engines, and nothing else runs.
    assert_eq!(checks.len(), 2 * integrators::fixed().len());
    assert_eq!(report.outcomes().len(), integrators::fixed().len());
    assert!(checks.iter().all(|c| c.status == CheckStatus::Pass));
    let from = |subject: &str| {
        let check = checks.iter().find(|c| c.subject == subject);
        check.expect("a check").derivation.clone()
    };
    assert!(from("explicit_euler energy.class").ends_with("`explicit_euler`"));
    assert!(from("explicit_euler status").ends_with("`all`"));
    assert!(from("rk4 energy.class").ends_with("`rest`"));
    // Mutated: without its own line explicit Euler is judged by `all`, and only it and the others
    // that are not bounded fail.
    let (_, _, checks) = judged("  all: {energy.class: bounded}");
    let fails = |id: &str| {
        let subject = format!("{id} energy.class");
        let check = checks.iter().find(|c| c.subject == subject);
        check.expect("a check").status == CheckStatus::Fail
    };
    assert!(fails("explicit_euler") && fails("implicit_euler") && !fails("velocity_verlet"));
}

#[test]
fn only_what_is_expected_runs() {
    let scene = oscillator(
        "  rapier-forces: {status: completed}\n  heun: {deviation_m.rapier.max: {above: 0}}",
    );
    let report = run(&scene, &Choice::expected(&scene));
    let ran: Vec<&str> = report
        .outcomes()
        .iter()
        .map(|o| o.engine.as_str())
        .collect();
    // rapier because the deviation is from it.
    assert_eq!(ran, ["heun", "rapier", "rapier-forces"]);
    assert!(report.header.checks.iter().all(|check| check.id != "order"));
    let checks = expect::check(&scene, &report);
    assert!(
        checks.iter().all(|c| c.status == CheckStatus::Pass),
        "{checks:?}"
    );
    assert!(rapier::IDS.contains(&"rapier-forces"));
}

#[test]
fn what_is_left_out_changes_no_key() {
    // From rest, so that the energy scale is the truth's; a deviation is from an engine that runs.
    let mut scene = crate::testkit::scenes::shipped("pa1/scene01.yml");
    scene.duration = 0.1;
    let value = |report: &Report, key: &str| {
        let outcome = serde_json::to_value(&report.outcomes()[0]).expect("JSON");
        let found = key
            .split('.')
            .try_fold(&outcome, |value, key| value.get(key));
        found.cloned()
    };
    let mut moved = 0;
    for key in &names().keys {
        scene.expect = vec![Expectation {
            scope: Scope::Engine("rk4".into()),
            key: key.path.clone(),
            wanted: Wanted::Contains("x".into()),
        }];
        let expected = Choice::expected(&scene);
        let whole = Choice {
            truth: Demand::Auto,
            identify: true,
            prove: true,
            ..expected.clone()
        };
        let blind = Choice {
            truth: Demand::None,
            identify: false,
            ..expected.clone()
        };
        let [found, whole, blind] =
            [&expected, &whole, &blind].map(|choice| value(&run(&scene, choice), &key.path));
        assert_eq!(found, whole, "{}", key.path);
        moved += usize::from(blind != whole);
    }
    // Errors of two kinds, three each; three energies over their scale; identities, some of them null.
    assert!(moved >= 12, "{moved}");
}

#[test]
fn what_did_not_run_is_skipped() {
    let scene = oscillator(
        "  rk4: {status: completed, deviation_m.rapier.max: {below: 1}}\n  heun: {status: \
         completed}",
    );
    let mut choice = Choice::expected(&scene);
    choice.solvers.retain(|solver| solver.id == "rk4");
    let checks = expect::check(&scene, &run(&scene, &choice));
    let said: Vec<(&str, CheckStatus)> = checks
        .iter()
        .map(|c| (c.subject.as_str(), c.status))
        .collect();
    let expected = [
        ("rk4 status", CheckStatus::Pass),
        ("rk4 deviation_m.rapier.max", CheckStatus::Skip),
        ("heun", CheckStatus::Skip),
    ];
    // In the registry's order.
    assert_eq!(said.len(), expected.len());
    assert!(expected.iter().all(|one| said.contains(one)), "{said:?}");

    // Another timestep or another duration: nothing is judged, and that is said once.
    choice.timesteps = vec![0.05];
    let finer = expect::check(&scene, &run(&scene, &choice));
    let mut longer = scene.clone();
    longer.duration = 11.0;
    let choice = Choice::expected(&longer);
    let longer = expect::check(&scene, &run(&longer, &choice));
    for (checks, why) in [
        (finer, "own timestep, 0.1 s"),
        (longer, "10.0 s, and 11.0 s"),
    ] {
        let [check] = &checks[..] else {
            panic!("{checks:?}");
        };
        assert_eq!(
            (check.subject.as_str(), check.status),
            ("scene", CheckStatus::Skip)
        );
        assert!(check.message.contains(why), "{}", check.message);
    }
    assert!(expect::check(&oscillator(""), &run(&scene, &choice)).is_empty());
}
