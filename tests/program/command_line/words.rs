//! Wrong words and negative values, help, completions and man pages.

use super::SCENE;
use crate::testkit::program::{output, refuse_all};

#[test]
fn a_wrong_word_is_answered_with_the_nearest() {
    let cases: [(&[&str], &str); 12] = [
        (
            &["run", SCENE, "--integrators", "all,rk4"],
            "`all` stands alone",
        ),
        (
            &["run", SCENE, "--engines", "rapier,none"],
            "`none` stands alone",
        ),
        (&["run", SCENE, "--integrators", "rk44"], "mean `rk4`"),
        (
            &["run", SCENE, "--integrators", "verlocity_verlet"],
            "mean `velocity_verlet`",
        ),
        (
            &["run", SCENE, "--engines", "rapier_forces"],
            "mean `rapier-forces`",
        ),
        (&["cost", SCENE, "--integrators", "dop583"], "mean `dop853`"),
        (
            &["run", SCENE, "--rapier", "iteration=3"],
            "mean `iterations`",
        ),
        (&["run", SCENE, "--external", "p=a {scen}"], "mean `scene`"),
        (&["run", SCENE, "--format", "jsno"], "'json'"),
        (&["run", SCENE, "--truth", "close"], "'closed'"),
        (
            &["stability", SCENE, "--vary", "springs.stifness=1..2"],
            "mean `springs.stiffness`",
        ),
        (&["completions", "man", "rnu"], "mean `run`"),
    ];
    for (args, says) in cases {
        refuse_all(args, &[says]);
    }
    // A negative value is a value.
    let values: [(&[&str], &str); 14] = [
        (&["check", SCENE, "--external-timeout", "-1s"], "'-1s'"),
        (&["check", SCENE, "--partition", "-1/2"], "'-1/2'"),
        (
            &["compare", "x.csv", "--scene", SCENE, "--max-error", "-1"],
            "'-1'",
        ),
        (
            &["compare", "x.csv", "--scene", SCENE, "--max-energy", "-1"],
            "'-1'",
        ),
        (&["run", SCENE, "--timestep", "-0.01"], "timestep -0.01"),
        (&["run", SCENE, "--timestep", "-0.01,0.1"], "timestep -0.01"),
        (&["run", SCENE, "--duration", "-2"], "-2"),
        (&["run", SCENE, "--save", "csv", "--every", "-3"], "'-3'"),
        (&["stability", SCENE, "--timestep", "-1"], "found -1"),
        (&["stability", SCENE, "--admissible", "-1"], "found -1"),
        (&["rest", SCENE, "--refine", "-1"], "'-1'"),
        (&["cost", SCENE, "--timestep", "-1"], "timestep -1"),
        (&["cost", SCENE, "--budget", "-1s"], "'-1s'"),
        (
            &["compare", "x.csv", "--scene", SCENE, "--timestep", "-1"],
            "--timestep -1",
        ),
    ];
    for (args, says) in values {
        refuse_all(args, &[says]);
    }
}

/// The verbs that the program lists.
fn verbs() -> Vec<String> {
    let (_, help, _) = output(&["--help"]);
    let listed = help.split("Commands:\n").nth(1).unwrap_or_default();
    let listed = listed.lines().take_while(|line| !line.is_empty());
    // A verb stands at two spaces; further lines of its text are indented more.
    let verbs = listed.filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
    let verbs = verbs.filter(|verb| !verb.is_empty() && *verb != "help");
    let verbs: Vec<String> = verbs.map(str::to_owned).collect();
    assert!(verbs.len() >= 7, "{verbs:?}");
    verbs
}

#[test]
fn every_verb_has_three_examples() {
    for verb in verbs() {
        let (code, help, _) = output(&[&verb, "--help"]);
        assert_eq!(code, 0);
        let examples = help.split("Examples:\n").nth(1).unwrap_or_default();
        let start = format!("  springcheck {verb} ");
        let lines: Vec<&str> = examples.lines().collect();
        assert_eq!(lines.len(), 3, "{help}");
        assert!(lines.iter().all(|line| line.starts_with(&start)), "{help}");
        assert!(
            help.lines().all(|line| line.chars().count() <= 100),
            "{help}"
        );
    }
}

#[test]
fn completions_and_pages_name_every_verb_and_flag() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let (code, text, _) = output(&["completions", shell]);
        assert_eq!(code, 0);
        let flags = ["integrators", "external-timeout", "no-files", "vary"].map(str::to_owned);
        for word in verbs().into_iter().chain(flags) {
            assert!(text.contains(&word), "{word} for {shell}");
        }
    }
    let (_, page, _) = output(&["completions", "man"]);
    assert!(page.contains(".TH springcheck 1"), "{page}");
    for verb in verbs() {
        assert!(page.contains(&format!("springcheck\\-{verb}(1)")), "{verb}");
        let (code, page, _) = output(&["completions", "man", &verb]);
        assert_eq!(code, 0);
        assert!(
            page.contains(&format!(".TH springcheck-{verb} 1")),
            "{page}"
        );
        // The flags that all verbs have.
        assert!(page.contains("\\-\\-color"), "{page}");
    }
    refuse_all(&["completions", "bash", "run"], &["man pages"]);
}
