//! `--partition`: parts of a suite on several machines.

use crate::folder::{Folder, assert_holds};
use std::collections::BTreeSet;

/// Four parts of a suite of four cases accepted at once, by four processes in one folder, are the files
/// that one process makes.
#[test]
fn parts_accepted_at_once_are_the_whole() {
    let whole = Folder::with_goldens();
    let parts = Folder::with_suite();
    std::thread::scope(|scope| {
        for part in 1..=4 {
            let parts = &parts;
            scope.spawn(move || {
                let part = format!("slice:{part}/4");
                let reason = "first goldens";
                let run = parts.volref(&["accept", "*", "--partition", &part, "--reason", reason]);
                assert_eq!(run.code, 0, "{part}: {}", run.stderr);
                assert_eq!(run.stdout.matches("its first golden").count(), 1, "{part}");
            });
        }
    });
    assert_eq!(whole.files(), parts.files());
}

#[test]
fn every_case_is_verified_by_one_part() {
    let suite = Folder::with_goldens();
    for by in ["slice", "hash"] {
        let mut names = Vec::new();
        for part in 1..=2 {
            let part = format!("{by}:{part}/2");
            let run = suite.volref(&["verify", "--partition", &part, "--json"]);
            assert_eq!(run.code, 0, "{part}: {}", run.stderr);
            let json = run.json();
            let cases = json["cases"].as_array().unwrap();
            names.extend(
                cases
                    .iter()
                    .map(|case| case["name"].as_str().unwrap().to_owned()),
            );
        }
        let all: BTreeSet<String> = names.iter().cloned().collect();
        assert_eq!((names.len(), all.len()), (4, 4), "{by}: {names:?}");
    }
}

/// A golden of no case is the finding of one part.
#[test]
fn what_belongs_to_no_case_is_said_once() {
    let suite = Folder::with_goldens();
    suite.remove("fixtures/cases/plots/curve.toml");
    let codes = [1, 2, 3].map(|part| {
        let part = format!("slice:{part}/3");
        suite.volref(&["verify", "--partition", &part]).code
    });
    assert_eq!(codes, [3, 0, 0]);
}

#[test]
fn parts_of_what_is_validated_come_after_the_filters() {
    let suite = Folder::with_goldens();
    suite.write(
        "images/smoke/shadow.exr",
        suite.read("golden/smoke/shadow.exr"),
    );
    suite.write(
        "images/smoke/plain.exr",
        suite.read("golden/smoke/plain.exr"),
    );
    let validate = |part: &str| {
        let arguments = [
            "validate",
            "smoke",
            "--outputs",
            "images",
            "--only-present",
            "--partition",
        ];
        suite.volref(&[&arguments[..], &[part]].concat())
    };
    for (part, case) in [("slice:1/2", "smoke/plain"), ("slice:2/2", "smoke/shadow")] {
        let run = validate(part);
        assert_eq!(run.code, 0, "{}", run.stderr);
        assert!(
            run.stdout.contains(case) && run.stdout.contains("1 case: 1 passed"),
            "{}",
            run.stdout
        );
    }
    let run = validate("slice:3/3");
    assert_eq!(run.code, 5);
    assert_holds(&run.stderr, "none of the 2 cases is in the part slice:3/3");
}

#[test]
fn parts_of_a_self_test_ask_only_about_their_cases() {
    let suite = Folder::with_goldens();
    let run = suite.volref("selftest --quick --json --partition slice:1/4");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let whole = suite.volref("selftest --quick --partition slice:1/1 smoke");
    assert_eq!(whole.code, 0, "{}", whole.stderr);
}

#[test]
fn auto_reads_the_engine_or_refuses() {
    let suite = Folder::with_goldens();
    let run = |variables: &[(&str, &str)]| {
        let mut command = suite.command("verify --partition auto --json");
        command.envs(variables.iter().copied());
        command.output().unwrap()
    };
    let slurm = run(&[
        ("SLURM_ARRAY_TASK_ID", "3"),
        ("SLURM_ARRAY_TASK_MIN", "1"),
        ("SLURM_ARRAY_TASK_MAX", "4"),
        ("SLURM_ARRAY_TASK_COUNT", "4"),
    ]);
    let by_hand = suite.volref("verify --partition slice:3/4 --json").json();
    let json: serde_json::Value = serde_json::from_slice(&slurm.stdout).unwrap();
    assert_eq!(json["cases"][0]["name"], by_hand["cases"][0]["name"]);
    for (variables, said) in [
        (&[][..], "no engine says which part this is"),
        (
            &[("CI_NODE_INDEX", "3"), ("CI_NODE_TOTAL", "2")],
            "there is no part 3 of 2",
        ),
        (&[("TEST_SHARD_INDEX", "0")], "TEST_TOTAL_SHARDS is not"),
    ] {
        let refused = run(variables);
        let stderr = String::from_utf8(refused.stderr).unwrap();
        assert_eq!(refused.status.code(), Some(2), "{stderr}");
        assert!(stderr.contains(said), "{stderr}");
    }
}
