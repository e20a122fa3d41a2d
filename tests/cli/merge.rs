//! `volref merge`: what several processes judge, joined.

use crate::folder::{Folder, MANIFEST, Run, assert_holds};
use serde_json::Value;

/// Judges each of `parts` parts of a suite in a folder of results of its own, and returns these.
fn in_parts(suite: &Folder, parts: usize, command: &[&str]) -> Vec<String> {
    let results = (1..=parts).map(|part| {
        let (of, folder) = (format!("slice:{part}/{parts}"), format!("part-{part}"));
        let run = suite.volref(&[command, &["--partition", &of, "--results", &folder]].concat());
        assert!([0, 1, 3, 4, 5, 6].contains(&run.code), "{}", run.stderr);
        folder
    });
    results.collect()
}

fn merged(suite: &Folder, folders: &[String], more: &[&str]) -> Run {
    let folders: Vec<&str> = folders.iter().map(String::as_str).collect();
    suite.volref(&[&["merge"], &folders[..], more].concat())
}

/// JSON without the times, which no two runs share, and without the command that made it.
fn timeless(mut value: Value) -> Value {
    for case in value["cases"].as_array_mut().unwrap() {
        case["seconds"] = 0.into();
    }
    value.as_object_mut().unwrap().remove("origin");
    value
}

/// A report without times, and without the command lines that made it.
fn timeless_page(page: &str) -> String {
    let lines = page.lines().filter(|line| !line.contains("volref "));
    let mut text = String::new();
    for line in lines {
        // 0.01 s
        match line.split_once(" s<") {
            Some((before, after)) => {
                text.push_str(before.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.'));
                text.push_str(after);
            }
            None => text.push_str(line),
        }
        text.push('\n');
    }
    text
}

/// Images of a suite of four: one is right, one too bright, one 8-bit, and one is not there.
fn with_images() -> Folder {
    let suite = Folder::with_goldens();
    for case in ["smoke/plain", "smoke/nearest"] {
        let golden = format!("golden/{case}.exr");
        suite.write(&format!("images/{case}.exr"), suite.read(&golden));
    }
    suite.edit(
        "fixtures/scenes/smoke/plain.toml",
        "width = 12",
        "width = 12 # the same",
    );
    for (scene, image) in [
        ("smoke/shadow", "images/smoke/shadow.png"),
        ("smoke/plain", "images/smoke/nearest.exr"),
    ] {
        let scene = format!("fixtures/scenes/{scene}.toml");
        assert_eq!(suite.volref(&["render", &scene, "-o", image]).code, 0);
    }
    suite
}

/// The parts of a self-test, joined, are the self-test of one machine; one part alone says what is missing,
/// and of mistakes that it misses nothing.
#[test]
fn parts_of_a_self_test_are_the_whole() {
    let suite = Folder::with_goldens();
    for filters in [&[][..], &["smoke"]] {
        let whole = suite.volref(&[&["selftest", "--json"], filters].concat());
        assert!([0, 6].contains(&whole.code), "{}", whole.stderr);
        let folders = in_parts(&suite, 2, &[&["selftest"], filters].concat());
        let all = merged(&suite, &folders, &["--json"]);
        assert_eq!(all.code, whole.code, "{}", all.stderr);
        assert_eq!(all.json(), whole.json());
        let backwards: Vec<String> = folders.iter().rev().cloned().collect();
        assert_eq!(
            merged(&suite, &backwards, &[]).stdout,
            merged(&suite, &folders, &[]).stdout
        );

        let part = merged(&suite, &folders[..1], &["--json"]);
        assert_eq!(part.code, 5, "{}", part.stderr);
        let value = part.json();
        assert!(!value["missing"].as_array().unwrap().is_empty());
        assert_eq!(value["summary"]["uncaught"], serde_json::json!([]));
        for folder in folders {
            std::fs::remove_dir_all(suite.path(&folder)).unwrap();
        }
    }
    // Parts that overlap, and try other mistakes in the same case.
    for part in ["slice:1/2", "slice:2/2", "slice:1/3"] {
        let run = suite.volref(&[
            "selftest",
            "--quick",
            "--partition",
            part,
            "--results",
            part,
        ]);
        assert_eq!(run.code, 0, "{}", run.stderr);
    }
    let run = merged(
        &suite,
        &["slice:1/3", "slice:1/2", "slice:2/2"].map(str::to_owned),
        &["--json"],
    );
    assert!([0, 6].contains(&run.code), "{}", run.stderr);
    assert!(run.json().get("missing").is_none());

    let run = suite.volref("selftest --results one");
    assert!([0, 6].contains(&run.code), "{}", run.stderr);
    let page = suite.volref("merge one --report page");
    assert_eq!(page.code, 5);
    assert_holds(&page.stderr, &["results of verify or validate"]);
}

#[test]
fn parts_verified_apart_are_the_whole() {
    let suite = Folder::with_goldens();
    suite.edit(
        "fixtures/scenes/smoke/shadow.toml",
        "resolution = 8",
        "resolution = 9",
    );
    let whole = suite.volref("verify --json --report whole");
    for parts in [1, 3] {
        let folders = in_parts(&suite, parts, &["verify"]);
        let joined = merged(&suite, &folders, &["--json", "--report", "joined"]);
        assert_eq!(joined.code, whole.code);
        assert_eq!(timeless(joined.json()), timeless(whole.json()));
        let pages = ["whole", "joined"]
            .map(|page| timeless_page(&suite.text(&format!("{page}/index.html"))));
        assert!(pages[0].len() > 10_000 && pages[0] == pages[1]);
        for folder in folders {
            std::fs::remove_dir_all(suite.path(&folder)).unwrap();
        }
    }
}

/// With what each part found out about its own cases.
#[test]
fn parts_validated_apart_are_the_whole() {
    let suite = with_images();
    let validate = ["validate", "--outputs", "images"];
    let whole = suite.volref(&[&validate[..], &["--json", "--junit", "whole.xml"]].concat());
    assert_eq!(whole.code, 1, "{}", whole.stderr);
    assert!(
        whole.json()["looks_like"]
            .as_array()
            .is_some_and(|names| !names.is_empty())
    );
    let folders = in_parts(&suite, 2, &validate);
    let joined = merged(&suite, &folders, &["--json", "--junit", "joined.xml"]);
    assert_eq!(joined.code, 1, "{}", joined.stderr);
    assert_eq!(timeless(joined.json()), timeless(whole.json()));
    // In any order, and twice is harmless.
    let folders: Vec<String> = folders.iter().rev().chain(&folders).cloned().collect();
    let again = merged(&suite, &folders, &["--json"]);
    assert_eq!(timeless(again.json()), timeless(whole.json()));
}

#[test]
fn what_is_passed_over_is_not_missing() {
    let suite = with_images();
    let validate = [
        "validate",
        "--outputs",
        "images",
        "--only-present",
        "--explain",
        "0",
    ];
    let whole = suite.volref(&[&validate[..], &["--json"]].concat());
    let folders = in_parts(&suite, 2, &validate);
    let joined = merged(&suite, &folders, &["--json"]);
    assert_eq!(timeless(joined.json()), timeless(whole.json()));
    assert_eq!(joined.json()["cases"].as_array().unwrap().len(), 3);
}

/// A part that did not end, and a file that was cut off.
#[test]
fn what_is_missing_is_listed() {
    let suite = Folder::with_goldens();
    let folders = in_parts(&suite, 4, &["verify"]);
    let run = merged(&suite, &folders[1..], &[]);
    run.prints(5, "missing: 1 of 4 cases … \n  plots/curve\n");

    let results = suite.files();
    let is_result = |name: &&String| {
        name.starts_with("part-2/") && name.ends_with(".json") && !name.ends_with("run.json")
    };
    let result = results.keys().find(is_result).unwrap();
    let bytes = &results[result];
    suite.write(result, &bytes[..bytes.len() / 2]);
    let run = merged(&suite, &folders, &["--json"]);
    assert_eq!(run.code, 5);
    let json = run.json();
    let cases = json["cases"].as_array().unwrap();
    let missing: Vec<&Value> = cases
        .iter()
        .filter(|case| case["verdict"] == "missing")
        .collect();
    assert_eq!(missing.len(), 1);
    let reason = missing[0]["reason"].as_str().unwrap();
    assert!(
        reason.contains("cut off") && reason.contains("part-2"),
        "{reason}"
    );
    // Where another folder has it, nothing is missing.
    suite.write("copy/results/keep", "");
    for (name, bytes) in &results {
        if let Some(name) = name.strip_prefix("part-2/") {
            suite.write(&format!("copy/{name}"), bytes);
        }
    }
    let folders: Vec<String> = folders.into_iter().chain(["copy".to_owned()]).collect();
    assert_eq!(merged(&suite, &folders, &[]).code, 0);
}

#[test]
fn results_of_different_runs_are_refused() {
    let suite = with_images();
    let volref = env!("CARGO_BIN_EXE_volref");
    let command = format!("{volref} render {{scene}} -o {{output}}");
    let validate = |seed: &'static str, folder: &'static str| {
        let part = [
            "--partition",
            "slice:1/2",
            "--explain",
            "0",
            "--results",
            folder,
        ];
        let run = ["validate", "--run", &command, "--seed", seed];
        assert_eq!(suite.volref(&[&run[..], &part].concat()).code, 0);
        folder.to_owned()
    };
    let folders = [validate("1", "one"), validate("2", "two")];
    let run = merged(&suite, &folders, &[]);
    run.expect(
        2,
        "different runs: one/results/ … two/results/ … remove the folders",
    );

    // The golden is another by now.
    suite.edit(
        "fixtures/scenes/plots/curve.toml",
        "width = 16",
        "width = 17",
    );
    merged(&suite, &folders[..1], &[])
        .expect(2, "another suite … golden of plots/curve … --suite DIR");
}

/// The results of tests stand on one page, with the causes that each found.
#[test]
fn named_runs_are_put_beside_each_other() {
    let suite = with_images();
    let judge = |more: &[&str]| {
        let common = ["validate", "--outputs=images", "--results=kept", "--json"];
        suite.volref(&[&common, more].concat())
    };
    let cpu = judge(&[
        "smoke/plain",
        "smoke/nearest",
        "--named=on the CPU",
        "--explain=5",
    ]);
    let gpu = judge(&["smoke/plain", "--named=on the GPU", "--resolution=3"]);
    assert_eq!((cpu.code, gpu.code), (1, 0), "{}", gpu.stdout);
    let joined = suite.volref(&["merge", "kept", "--report=page", "--json"]);
    assert_eq!(joined.code, 1, "{}", joined.stderr);
    let json = joined.json();
    let mut cases = json["cases"].as_array().unwrap().clone();
    let names: Vec<&str> = cases
        .iter()
        .map(|it| it["name"].as_str().unwrap())
        .collect();
    let both = ["smoke/plain (on the CPU)", "smoke/plain (on the GPU)"];
    assert_eq!(names.len(), 3);
    assert!(both.iter().all(|name| names.contains(name)), "{names:?}");
    assert_eq!(json["judged_with"]["settings"]["resolution"], "3");
    // The mistake was found before, and is not looked for again.
    let of = |cases: &[Value]| {
        cases
            .iter()
            .find(|it| it["name"] == "smoke/nearest")
            .cloned()
    };
    let known = of(cpu.json()["cases"].as_array().unwrap()).unwrap();
    assert!(
        !known["looks_like"].as_array().unwrap().is_empty(),
        "{known}"
    );
    assert_eq!(json["looks_like"][0]["mistake"], known["looks_like"][0]);
    cases.retain(|it| it["name"] == "smoke/nearest");
    assert_eq!(cases, [known]);
    let page = suite.text("page/index.html").replace("&#x2f;", "/");
    assert!(both.iter().all(|name| page.contains(name)));
    let alone = ["validate", "--outputs=images", "--named=alone"];
    suite.volref(&alone).expect(2, "--results");
}

#[test]
fn folders_without_anything_are_said_to_be_so() {
    let suite = Folder::with_goldens();
    merged(&suite, &["golden".to_owned()], &[]).expect(5, "golden has no results");
    merged(&suite, &["nowhere".to_owned()], &[]).expect(2, "nowhere is not a folder");
    merged(&suite, &["results/nowhere".to_owned()], &[]).expect(2, "nowhere is not a folder");
    suite.write("taken", "");
    let run = suite.volref("verify --results taken");
    run.expect(2, "cannot create the folder taken");
    let run = suite.volref("verify smoke --results kept");
    assert_eq!(run.code, 0);
    assert_eq!(merged(&suite, &["kept".to_owned()], &[]).code, 0);

    let files = suite.files();
    let path = files
        .keys()
        .find(|path| path.starts_with("kept/results/") && path.ends_with("/run.json"));
    let of_run = path.unwrap().trim_end_matches("/run.json").to_owned();

    // A run that cannot be read is not passed over, also beside another.
    let path = format!("{of_run}/run.json");
    let bytes = suite.read(&path);
    suite.write(&path, &bytes[..bytes.len() - 1]);
    let words = &["run.json: ", "remove the folder"];
    merged(&suite, &["kept".to_owned()], &[]).expect(5, words);
    assert_eq!(suite.volref("verify --results kept").code, 0);
    merged(&suite, &["kept".to_owned()], &[]).expect(5, words);
}

/// Two manifests whose names no text can hold.
#[cfg(target_os = "linux")]
#[test]
fn two_cases_of_one_name_are_refused() {
    use std::os::unix::ffi::OsStrExt;
    let suite = Folder::with_goldens();
    for name in [b"\xfe.toml", b"\xff.toml"] {
        let name = std::ffi::OsStr::from_bytes(name);
        std::fs::write(suite.path("fixtures/cases/smoke").join(name), MANIFEST).unwrap();
    }
    suite
        .volref("list")
        .expect(2, "two cases are called smoke/?");
}

/// The same request, and another image: which of two verdicts is right cannot be known.
#[test]
fn verdicts_that_contradict_each_other_are_refused() {
    let suite = with_images();
    let judge = |folder: &str| {
        let validate = [
            "validate",
            "smoke/plain",
            "--outputs",
            "images",
            "--explain",
            "0",
        ];
        suite
            .volref(&[&validate[..], &["--results", folder]].concat())
            .code
    };
    assert_eq!([judge("one"), judge("same")], [0, 0]);
    suite.write(
        "images/smoke/plain.exr",
        suite.read("images/smoke/nearest.exr"),
    );
    let other = [
        "render",
        "fixtures/scenes/smoke/shadow.toml",
        "-o",
        "images/smoke/plain.exr",
    ];
    assert_eq!(suite.volref(&other).code, 0);
    assert_eq!(judge("other"), 1);
    let join = |folders: [&str; 2]| merged(&suite, &folders.map(str::to_owned), &[]);
    assert_eq!(join(["one", "same"]).code, 0);
    for folders in [["one", "other"], ["other", "one"]] {
        join(folders).expect(2, "smoke/plain … pass in one … fail in other");
    }
}

/// Without its images a verdict holds, and says what it lacks.
#[test]
fn a_verdict_outlives_its_images() {
    let suite = with_images();
    let validate = [
        "validate",
        "--outputs",
        "images",
        "--explain",
        "0",
        "--results",
        "kept",
    ];
    let whole = suite.volref(&validate);
    for name in suite
        .files()
        .keys()
        .filter(|name| name.ends_with(".exr") && name.starts_with("kept/"))
    {
        suite.write(name, "");
    }
    let joined = merged(
        &suite,
        &["kept".to_owned()],
        &["--report", "report", "--json"],
    );
    assert_eq!(joined.code, whole.code);
    let json = joined.json();
    let failed = json["cases"]
        .as_array()
        .unwrap()
        .iter()
        .find(|case| case["verdict"] == "fail");
    let notes = failed.unwrap()["notes"].to_string();
    assert!(notes.contains("its image is missing"), "{notes}");
}

/// Each machine has images of its own.
#[test]
fn what_one_part_passes_over_another_may_have() {
    let suite = with_images();
    for case in ["smoke/plain", "smoke/nearest"] {
        let folder = case.replace('/', "-");
        suite.write(
            &format!("{folder}/{case}.exr"),
            suite.read(&format!("images/{case}.exr")),
        );
        let validate = [
            "validate",
            "--outputs",
            &folder,
            "--only-present",
            "--explain",
            "0",
        ];
        suite.volref(&[&validate[..], &["--results", &format!("{folder}-results")]].concat());
    }
    let folders = ["smoke-plain-results", "smoke-nearest-results"].map(str::to_owned);
    let joined = merged(&suite, &folders, &["--json"]);
    assert_eq!(joined.json()["cases"].as_array().unwrap().len(), 2);
    assert_eq!(joined.json()["summary"]["missing"], 0);
}
