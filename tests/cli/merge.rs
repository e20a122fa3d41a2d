//! `volref units` and `volref merge`: what several processes compute, joined.

use crate::folder::{Folder, Run};
use serde_json::Value;
use std::collections::BTreeMap;

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

/// JSON without the times, which no two runs share.
fn timeless(mut value: Value) -> Value {
    for case in value["cases"].as_array_mut().unwrap() {
        case["seconds"] = 0.into();
    }
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

    let run = suite.volref(&["selftest", "--results", "one"]);
    assert!([0, 6].contains(&run.code), "{}", run.stderr);
    let page = suite.volref(&["merge", "one", "--report", "page"]);
    assert_eq!(page.code, 5);
    assert!(
        page.stderr.contains("results of verify or validate"),
        "{}",
        page.stderr
    );
}

#[test]
fn parts_verified_apart_are_the_whole() {
    let suite = Folder::with_goldens();
    suite.edit(
        "fixtures/scenes/smoke/shadow.toml",
        "resolution = 8",
        "resolution = 9",
    );
    let whole = suite.volref(&["verify", "--json", "--report", "whole"]);
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

/// With the search for mistakes, over all cases together.
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
    let joined = merged(&suite, &folders, &["--json", "--explain", "0"]);
    assert_eq!(timeless(joined.json()), timeless(whole.json()));
    assert_eq!(joined.json()["cases"].as_array().unwrap().len(), 3);
}

/// A part that did not end, and a file that was cut off.
#[test]
fn what_is_missing_is_listed() {
    let suite = Folder::with_goldens();
    let folders = in_parts(&suite, 4, &["verify"]);
    let run = merged(&suite, &folders[1..], &[]);
    assert_eq!(run.code, 5, "{}", run.stdout);
    assert!(
        run.stdout.contains("missing: 1 of 4 cases"),
        "{}",
        run.stdout
    );
    assert!(run.stdout.contains("\n  plots/curve\n"), "{}", run.stdout);

    let results = suite.files();
    let is_result = |name: &&String| name.starts_with("part-2/") && name.ends_with(".result");
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
    assert!(reason.contains("cut off or changed"), "{reason}");
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
fn results_of_different_runs_are_refused_by_what_differs() {
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
    run.expect(2, &["2 different runs", "seed differs", "--run ID"]);
    let (one, _) = run
        .stderr
        .split_once("one/results/")
        .unwrap()
        .1
        .split_at(12);
    assert_eq!(merged(&suite, &folders, &["--run", one]).code, 5);

    // The golden is another by now.
    suite.edit(
        "fixtures/scenes/plots/curve.toml",
        "width = 16",
        "width = 17",
    );
    merged(&suite, &folders[..1], &[]).expect(
        2,
        &["another suite", "golden of plots/curve", "--suite DIR"],
    );
}

#[test]
fn folders_without_anything_are_said_to_be_so() {
    let suite = Folder::with_goldens();
    merged(&suite, &["golden".to_owned()], &[]).expect(5, &["neither results nor units"]);
    merged(&suite, &["nowhere".to_owned()], &[]).expect(2, &["nowhere is no folder"]);
    merged(&suite, &["results/nowhere".to_owned()], &[]).expect(2, &["nowhere is no folder"]);
    suite.write("taken", "");
    let run = suite.volref(&["verify", "--results", "taken"]);
    run.expect(2, &["cannot create the folder taken"]);
    let run = suite.volref(&["verify", "smoke", "--results", "kept"]);
    assert_eq!(run.code, 0);
    assert_eq!(merged(&suite, &["kept".to_owned()], &[]).code, 0);

    // What a part says when it ends is the folder of its run.
    let files = suite.files();
    let path = files
        .keys()
        .find(|path| path.starts_with("kept/results/") && path.ends_with("/run"));
    let of_run = path.unwrap().trim_end_matches("/run").to_owned();
    assert_eq!(merged(&suite, std::slice::from_ref(&of_run), &[]).code, 0);
    assert_eq!(merged(&suite, &["kept/results".to_owned()], &[]).code, 0);

    // A run that cannot be read is not passed over, also beside another.
    let path = format!("{of_run}/run");
    let bytes = suite.read(&path);
    suite.write(&path, &bytes[..bytes.len() - 1]);
    let words = &["run: ", "remove its folder"];
    merged(&suite, &["kept".to_owned()], &[]).expect(5, words);
    assert_eq!(suite.volref(&["verify", "--results", "kept"]).code, 0);
    merged(&suite, &["kept".to_owned()], &[]).expect(5, words);
}

const SAMPLING: &str = "converged_samples = 64\nquick_samples = 4\nresolution = 0.99\n";

fn units(folder: &Folder) -> Vec<Value> {
    let run = folder.volref(&["units", "--json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    run.json()["units"].as_array().unwrap().clone()
}

/// Units of two machines, each in its own copy of the suite, make the golden of one process.
#[test]
fn units_of_two_machines_are_the_golden_of_one_process() {
    let [one, two, whole] = [(); 3].map(|()| Folder::with_room(SAMPLING));
    whole.accept_all();
    let ids: Vec<String> = units(&one)
        .iter()
        .map(|unit| unit["id"].as_str().unwrap().to_owned())
        .collect();
    assert_eq!(ids.len(), 2);
    for (folder, id) in [&one, &two].into_iter().zip(&ids) {
        let run = folder.volref(&["units", "--compute", "--unit", &id[..16]]);
        assert_eq!(run.code, 0, "{}", run.stderr);
        assert_eq!(
            units(folder)
                .iter()
                .filter(|unit| unit["kept"] == true)
                .count(),
            1
        );
    }
    let kept = two.path("").display().to_string();
    let alone = one.volref(&["merge", ".", "--json"]);
    assert_eq!(alone.code, 5);
    let missing = &alone.json()["units"]["cases"][0]["missing"];
    assert_eq!(
        (missing[0]["id"].as_str(), missing[1].as_str()),
        (Some(&ids[1][..]), None)
    );

    // Two at once.
    let codes = std::thread::scope(|scope| {
        let merge = || one.volref(&["merge", ".", &kept]).code;
        [scope.spawn(merge), scope.spawn(merge)].map(|thread| thread.join().unwrap())
    });
    assert_eq!(codes, [0, 0]);
    assert_eq!(
        merged(&one, &[".".to_owned()], &["--json"]).json()["units"]["copied"],
        0
    );
    let accepted = one.volref(&["accept", "*", "--reason", "first goldens"]);
    assert!(
        accepted.stdout.contains("rendered by an earlier run"),
        "{}",
        accepted.stderr
    );
    assert_eq!(one.files(), whole.files());
}

/// A unit of other things than the suite's is refused by what it is of, and nothing is copied.
#[test]
fn units_of_something_else_are_refused() {
    let suite = Folder::with_room(SAMPLING);
    let other = |from: &str, to: &str| {
        let other = Folder::with_room(SAMPLING);
        other.edit("fixtures/scenes/fog/room.toml", from, to);
        assert_eq!(other.volref(&["units", "--compute"]).code, 0);
        other
    };
    let scene = other("width = 16", "width = 17");
    let text = suite.text("fixtures/scenes/fog/room.toml");
    let seed = text
        .lines()
        .find(|line| line.starts_with("seed"))
        .unwrap_or("samples");
    let seed = other(
        seed,
        &format!("seed = 7\n{}", if seed == "samples" { seed } else { "" }),
    );
    for (other, what) in [(scene, "another scene"), (seed, "of seed 7")] {
        let kept = other.path("").display().to_string();
        let run = suite.volref(&["merge", &kept]);
        run.expect(2, &[what, "nothing was copied"]);
        assert!(!suite.path(".volref").exists());
    }
    let run = suite.volref(&["units", "--unit", "nothing"]);
    run.expect(2, &["no unit \"nothing\""]);
    suite
        .volref(&["units", "--partition", "slice:3/3"])
        .expect(5, &["none of the 2 units"]);
}

/// A file that was cut off is computed again; one with other bits, from the same things, is a machine
/// that computes wrongly.
#[test]
fn damaged_units_are_not_used() {
    let [suite, other] = [(); 2].map(|()| Folder::with_room(SAMPLING));
    assert_eq!(suite.volref(&["units", "--compute"]).code, 0);
    let files: BTreeMap<String, Vec<u8>> = suite.files();
    let is_unit = |name: &&String| name.ends_with(".unit");
    let names: Vec<&String> = files.keys().filter(is_unit).collect();
    let (name, bytes) = (names[0], &files[names[0]]);
    suite.write(name, &bytes[..bytes.len() - 1]);
    let run = suite.volref(&["merge", "."]);
    assert_eq!(run.code, 5);
    assert!(
        run.stdout.contains("not used") && run.stdout.contains("cut off"),
        "{}",
        run.stdout
    );
    // Also where nothing else is known of its case; with another file of its name, nothing is missing.
    let alone = name.replacen(".volref", "alone", 1);
    suite.write(&alone, &bytes[..bytes.len() - 1]);
    assert_eq!(suite.volref(&["merge", "alone"]).code, 5);
    let run = suite.volref(&["units", "--compute"]);
    assert!(run.stdout.contains("1 computed now"), "{}", run.stdout);
    assert_eq!(&suite.read(name), bytes);
    let run = suite.volref(&["merge", "alone", "."]);
    assert_eq!(run.code, 0, "{}", run.stdout);
    suite.remove(&alone);

    // The head of one and the rows of another, behind a right hash.
    let lines: Vec<&[u8]> = bytes.splitn(3, |byte| *byte == b'\n').collect();
    let rows = other.path("rows.exr").display().to_string();
    let render = [
        "render",
        "fixtures/scenes/fog/room.toml",
        "--spp",
        "2",
        "-o",
        &rows,
    ];
    assert_eq!(suite.volref(&render).code, 0);
    let rest = [lines[1], b"\n", &other.read("rows.exr")].concat();
    let hash = blake3::hash(&rest).to_hex();
    other.write(name, [hash.as_bytes(), b"\n", &rest].concat());
    let kept = other.path("").display().to_string();
    suite
        .volref(&["merge", &kept])
        .expect(1, &["other bits", "broken"]);
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
    let join =
        |folders: [&str; 2]| merged(&suite, &folders.map(str::to_owned), &["--explain", "0"]);
    assert_eq!(join(["one", "same"]).code, 0);
    for folders in [["one", "other"], ["other", "one"]] {
        join(folders).expect(2, &["smoke/plain", "pass in one", "fail in other"]);
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
        .filter(|name| name.ends_with(".images"))
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
    let note = failed.unwrap()["notes"][0].as_str().unwrap();
    assert!(note.contains("its images are missing"), "{note}");
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
    let joined = merged(&suite, &folders, &["--json", "--explain", "0"]);
    assert_eq!(joined.json()["cases"].as_array().unwrap().len(), 2);
    assert_eq!(joined.json()["summary"]["missing"], 0);
}
