//! `volref list`, and the command as a whole.

use crate::folder::{Folder, Run, assert_holds, assert_shown};
use serde_json::Value;
use std::process::Stdio;

#[test]
fn text() {
    let suite = Folder::with_suite();
    assert_shown!(suite.volref("list").shown(), @r"
    exit code 0
    --- stdout
    family  cases  asks of a renderer
    plots       1
    smoke       3

    In all 4 cases.

    `volref list FAMILY` lists its cases, with what they show.
    ");
}

/// An outline: smoke comes first, then families without a line of their own.
const OUTLINE: &str = "\
core = [\"smoke/shadow\", \"plots/curve\"]

[[family]]
name = \"smoke\"
asks = \"is smoke where it should be?\"
";

#[test]
fn families_in_their_order_and_the_core_set() {
    let suite = Folder::with_suite();
    suite.write("fixtures/suite.toml", OUTLINE);
    assert_shown!(suite.volref("list").shown(), @r"
    exit code 0
    --- stdout
    family  cases  asks of a renderer
    smoke       3  is smoke where it should be?
    plots       1

    In all 4 cases.

    The core set, 2 cases that a renderer is asked first, as the filter core:
      smoke/shadow plots/curve

    `volref list FAMILY` lists its cases, with what they show.
    ");
    assert_shown!(suite.volref("list core").shown(), @r"
    exit code 0
    --- stdout
    plots/curve   deterministic
        a diamond [a test]
    smoke/shadow  deterministic
        a diamond [a test]
    ");
    let listed = suite.volref("list --json").json();
    let names = |key: &str, all: &Value| -> Vec<String> {
        let entries = all[key].as_array().unwrap().iter();
        entries
            .map(|it| format!("{} {} {}", it["name"], it["core"], it["asks"]))
            .collect()
    };
    assert_eq!(
        names("families", &listed),
        [
            "\"smoke\" 1 \"is smoke where it should be?\"",
            "\"plots\" 1 null"
        ]
    );
    assert_eq!(
        names("cases", &listed),
        [
            "\"plots/curve\" true null",
            "\"smoke/nearest\" false null",
            "\"smoke/plain\" false null",
            "\"smoke/shadow\" true null",
        ]
    );
    // Every command that takes filters knows the word, beside others.
    let run = suite.volref("accept core plain --reason first");
    run.expect(0, "");
    let run = suite.volref("verify core --verbose");
    run.expect(0, "");
    assert_holds(
        &run.stdout,
        "smoke/shadow … plots/curve … 2 cases: 2 passed",
    );
}

#[test]
fn an_outline_with_a_mistake() {
    let suite = Folder::with_suite();
    let place = "fixtures/suite.toml:1:8";
    suite.write("fixtures/suite.toml", "core = [\"smoke/gone\"]\n");
    let help = "add its manifest, fixtures/cases/smoke/gone.toml";
    suite
        .volref("list")
        .expect(2, &[place, "\"smoke/gone\"", help]);
    suite.write("fixtures/suite.toml", "[[family]]\nname = \"smoke\"\n");
    suite.volref("list").expect(2, "fixtures/suite.toml … asks");
    // A suite without a core set has no such filter.
    suite.write("fixtures/suite.toml", "");
    suite
        .volref("list core")
        .expect(5, "no case matches \"core\"");
}

#[test]
fn json() {
    let suite = Folder::with_suite();
    let run = suite.volref("list plots --json");
    assert_shown!(run.shown(), @r#"
    exit code 0
    --- stdout
    {
      "cases": [
        {
          "class": "deterministic",
          "computes": "what the scene says",
          "core": false,
          "depth": null,
          "exposure": 0.0,
          "family": "plots",
          "gate": "deterministic",
          "name": "plots/curve",
          "opacity": false,
          "scene": "fixtures/scenes/plots/curve.toml",
          "shows": "a diamond",
          "source": "a test"
        }
      ],
      "families": [
        {
          "asks": null,
          "cases": 1,
          "core": 0,
          "name": "plots"
        }
      ],
      "schema": "volref/list/1"
    }
    "#);
}

/// Every mistake that a verdict may name, without a suite.
#[test]
fn mistakes() {
    let run = Folder::new().volref("list --mistakes");
    assert_holds(&run.stdout, &["\nopacity-uncorrected\n    "]);
    let run = Folder::new().volref("list --mistakes --json");
    let listed: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let listed = listed["mistakes"].as_array().unwrap();
    let catalogue: Vec<_> = volref::variations::mistakes::catalogue().collect();
    assert_eq!(listed.len(), catalogue.len());
    for (entry, mistake) in listed.iter().zip(catalogue) {
        assert_eq!(entry["name"], mistake.name);
        assert_eq!(entry["advice"], mistake.advice);
    }
    let run = Folder::new().volref("list --mistakes figures");
    assert_eq!(run.code, 2, "{}", run.stderr);
}

#[test]
fn filters() {
    let suite = Folder::with_suite();
    for (filter, found) in [
        ("smoke", "smoke/nearest smoke/plain smoke/shadow"),
        ("smoke/plain", "smoke/plain"),
        ("plain", "smoke/plain"),
        ("*/*a*", "smoke/nearest smoke/plain smoke/shadow"),
        ("{plots,smoke/s*}", "plots/curve smoke/shadow"),
    ] {
        let run = suite.volref(&["list", filter]);
        let lines = run.stdout.lines().filter(|line| !line.starts_with(' '));
        let names = lines.map(|line| line.split(' ').next().unwrap());
        assert_eq!(names.collect::<Vec<_>>().join(" "), found, "{filter}");
    }
}

/// Whatever command takes filters takes them so: `list` and `verify` run through all there is.
#[test]
fn a_filter_that_begins_with_an_exclamation_mark_excludes() {
    let suite = Folder::with_goldens();
    let names = |filters: &[&str]| {
        let run = suite.volref(&[&["list"], filters].concat());
        let lines = run
            .stdout
            .lines()
            // What a case shows is set in.
            .filter(|line| !line.starts_with(' '))
            .filter_map(|line| line.split_whitespace().next());
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(names(&["!smoke"]), ["plots/curve"]);
    assert_eq!(
        names(&["!plain", "!plots/*"]),
        ["smoke/nearest", "smoke/shadow"]
    );
    assert_eq!(names(&["smoke", "!smoke/[np]*"]), ["smoke/shadow"]);
    assert_eq!(
        names(&["!smoke/shadow", "smoke"]),
        ["smoke/nearest", "smoke/plain"]
    );
    let run = suite.volref(&["verify", "!smoke", "--json"]);
    assert!(!run.stdout.contains("smoke/plain") && run.stdout.contains("plots/curve"));
    for command in ["list", "verify", "selftest"] {
        let run = suite.volref(&[command, "!smok/plain"]);
        run.expect(
            5,
            "no case matches \"!smok/plain\" … did you mean \"!smoke/plain\"?",
        );
        let run = suite.volref(&[command, "smoke", "!smoke/*"]);
        run.expect(5, "no case matches \"smoke !smoke/*\" … excluded");
    }
    suite
        .volref(&["list", "!"])
        .expect(2, "\"!\" is not a pattern");
    suite
        .volref(&["list", "!!plots"])
        .expect(2, "one ! stands before");
    // A manifest that cannot be read is excluded, too.
    suite.write("fixtures/cases/plots/broken.toml", "class = 1");
    suite.volref(&["list", "!broken"]).expect(0, "");
    suite.volref("list").expect(2, "broken.toml");
}

#[test]
fn a_filter_that_matches_nothing_decides_nothing() {
    let suite = Folder::with_goldens();
    let before = suite.files();
    for command in [
        &["list", "smok/plain"][..],
        &["verify", "plots", "smok/plain"],
        &["accept", "plots", "smok/plain", "--reason", "none"],
    ] {
        let run = suite.volref(command);
        run.expect(
            5,
            "no case matches \"smok/plain\" … did you mean \"smoke/plain\"?",
        );
    }
    assert_eq!(suite.files(), before);

    let run = suite.volref("list nosuch");
    run.expect(
        5,
        "no case matches \"nosuch\" … `volref list` shows all cases",
    );
    assert!(!run.message().contains("did you mean"), "{}", run.stderr);
}

#[test]
fn a_filter_that_is_no_pattern() {
    let run = Folder::with_suite().volref("list smoke/{a");
    run.expect(2, "\"smoke/{a\" is not a pattern … unclosed");
}

#[test]
fn a_folder_that_is_no_suite() {
    let folder = Folder::new();
    folder.write("fixtures/cases", "a file where a folder should be");
    folder
        .volref("list --suite .")
        .expect(2, "contains no suite … fixtures/cases … --suite DIR");
    let run = folder.volref("verify --suite nowhere");
    run.expect(2, "nowhere contains no suite");
}

#[test]
fn a_manifest_with_a_mistake() {
    let suite = Folder::with_suite();
    suite.edit("fixtures/cases/smoke/plain.toml", "shows =", "show =");
    let place = "fixtures/cases/smoke/plain.toml:2:1";
    let run = suite.volref("list");
    run.expect(2, &[place, "unknown key `show`", "did you mean `shows`?"]);
    // Other cases are not held up by it.
    for chosen in ["smoke", "plain", "*"] {
        suite.volref(&["list", chosen]).expect(2, &[place]);
    }
    for other in ["plots", "nearest"] {
        suite.volref(&["list", other]).expect(0, "");
    }
    suite.write("fixtures/cases/smoke/plain.toml", [0xff, 0xfe]);
    let run = suite.volref("verify");
    run.expect(2, "fixtures/cases/smoke/plain.toml … UTF-8");
}

/// `volref list | true`: the reader is gone before the first byte. No panic, no complaint.
#[test]
fn a_closed_pipe_is_no_error() {
    let suite = Folder::with_suite();
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    for arguments in [&["list"][..], &["schema"], &["--help"]] {
        let mut command = suite.command(arguments);
        let child = command
            .stdout(writer.try_clone().unwrap())
            .stderr(Stdio::piped());
        let run = Run::of(child.spawn().unwrap().wait_with_output().unwrap());
        assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{arguments:?}");
    }
    let mut command = suite.command("list nothing");
    let child = command
        .stderr(writer.try_clone().unwrap())
        .stdout(Stdio::piped());
    let run = Run::of(child.spawn().unwrap().wait_with_output().unwrap());
    assert_eq!(run.code, 5);
}

#[test]
fn version() {
    let run = Folder::new().volref("--version");
    assert_eq!(
        run.stdout,
        concat!("volref ", env!("CARGO_PKG_VERSION"), "\n")
    );
    assert_eq!(run.code, 0);
}

#[test]
fn usage_mistakes() {
    let folder = Folder::with_scenes();
    for (arguments, message) in [
        (&[][..], "Usage: volref <COMMAND>"),
        (&["verfy"], "'verify'"),
        (&["verify", "--threads", "0"], "0 is not in 1..=1024"),
        (&["render", "scene.toml"], "--output <FILE>"),
        (&["accept", "--reason", "r"], "<CASE>"),
        (
            &["plan", "scene.toml", "--force", "scatering"],
            "[possible values: surfaces",
        ),
        (
            &["compare", "a.exr", "b.exr", "--gate", "ssim"],
            "unknown gate \"ssim\"",
        ),
        (&["schema", "plot"], "scene, case"),
    ] {
        folder.volref(arguments).expect(2, &[message]);
    }
}

#[test]
fn completions_know_every_command() {
    let folder = Folder::new();
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let run = folder.volref(&["completions", shell]);
        for word in ["validate", "selftest", "only-present"] {
            assert!(run.stdout.contains(word), "{shell}: {word}");
        }
    }
}
