//! `volref units` and `volref merge`: what several processes compute, joined.

use crate::folder::{Folder, MANIFEST, Run, assert_holds};
use flate2::Compression;
use flate2::write::DeflateEncoder;
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::Write;
use volref::film::{Film, LayeredFilm};

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
        // Parts do not keep the pictures of a stale case.
        for page in pages {
            assert!(page.len() > 10_000, "{}", page.len());
        }
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
    run.prints(5, "missing: 1 of 4 cases … \n  plots/curve\n");

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
    run.expect(2, "2 different runs … seed differs … --run ID");
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
    assert_eq!(json["judged_with"]["settings"]["resolution"], "3 in part");
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
    merged(&suite, &["golden".to_owned()], &[]).expect(5, "neither results nor units");
    merged(&suite, &["nowhere".to_owned()], &[]).expect(2, "nowhere is not a folder");
    merged(&suite, &["results/nowhere".to_owned()], &[]).expect(2, "nowhere is not a folder");
    suite.write("taken", "");
    let run = suite.volref("verify --results taken");
    run.expect(2, "cannot create the folder taken");
    let run = suite.volref("verify smoke --results kept");
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
    let words = &["run: ", "remove the folder"];
    merged(&suite, &["kept".to_owned()], &[]).expect(5, words);
    assert_eq!(suite.volref("verify --results kept").code, 0);
    merged(&suite, &["kept".to_owned()], &[]).expect(5, words);
}

const SAMPLING: &str = "converged_samples = 64\nquick_samples = 4\nresolution = 0.99\n";

fn units(folder: &Folder) -> Vec<Value> {
    let run = folder.volref("units --json");
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
    let alone = one.volref("merge . --json");
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
    let accepted = one.volref("accept '*' --reason 'first goldens'");
    assert_holds(&accepted.stdout, &["rendered by an earlier run"]);
    assert_eq!(one.files(), whole.files());
}

/// A unit of other things than the suite's is refused by what it is of, and nothing is copied.
#[test]
fn units_of_something_else_are_refused() {
    let suite = Folder::with_room(SAMPLING);
    let other = |from: &str, to: &str| {
        let other = Folder::with_room(SAMPLING);
        other.edit("fixtures/scenes/fog/room.toml", from, to);
        assert_eq!(other.volref("units --compute").code, 0);
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
    let run = suite.volref("units --unit nothing");
    run.expect(2, "no unit \"nothing\"");
    suite
        .volref("units --partition slice:3/3")
        .expect(5, "none of the 2 units");
}

/// Head and contents of a file that one process leaves for another.
fn opened(file: &[u8]) -> (&[u8], &[u8]) {
    let mut lines = file.splitn(3, |byte| *byte == b'\n').skip(1);
    (lines.next().unwrap(), lines.next().unwrap())
}

/// Such a file, with the right hash.
fn sealed(head: &[u8], contents: &[u8]) -> Vec<u8> {
    let rest = [head, b"\n", contents].concat();
    let hash = blake3::hash(&rest).to_hex();
    [hash.as_bytes(), b"\n", &rest].concat()
}

/// Behind a right hash: other pixels, samples, variances or values than those of the unit, and more of them than
/// its file has bytes.
#[test]
fn units_that_are_not_what_they_say_are_computed_again() {
    let [computed, whole] = [(); 2].map(|()| Folder::with_room(SAMPLING));
    assert_eq!(computed.volref("units --compute").code, 0);
    whole.accept_all();
    let units = computed.files().into_iter();
    let units: Vec<(String, Vec<u8>)> = units.filter(|(name, _)| name.ends_with(".unit")).collect();
    let (name, file) = &units[0];
    let (head, exr) = opened(file);
    let right = Film::from_exr(exr).unwrap();
    let ([width, height], noise) = ([right.width(), right.height()], right.noise().unwrap());
    let (radiance, variance) = (right.radiance().to_vec(), noise.variance().to_vec());
    let samples = noise.samples();
    let film = |width: usize, height: usize| {
        let pixels = width * height;
        let repeated = |values: &[[f32; 3]]| values.iter().copied().cycle().take(pixels).collect();
        Film::with_noise(
            width,
            height,
            repeated(&radiance),
            repeated(&variance),
            samples,
        )
    };
    let with = |value: f32, of_variance: f32| {
        let (mut radiance, mut variance) = (radiance.clone(), variance.clone());
        (radiance[7][1], variance[7][1]) = (value, of_variance);
        Film::with_noise(width, height, radiance, variance, samples)
    };
    let opaque = radiance.iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect();
    let layers = [("variance", film(3, 2)), ("other", right.clone())];
    let layers = LayeredFilm {
        comment: String::new(),
        layers: layers.map(|(name, film)| (name.to_owned(), film)).to_vec(),
    };
    let of = |film: Film| sealed(head, &film.to_exr().unwrap());
    let text = std::str::from_utf8(head).unwrap();
    let head_with = |from: &str, to: &str| {
        assert_eq!(text.matches(from).count(), 1, "{from} in {text}");
        sealed(text.replace(from, to).as_bytes(), exr)
    };
    let doubled = |values: &[[f32; 3]]| values.iter().map(|of| of.map(|it| it + it)).collect();
    let black = Film::new(4096, 4096, vec![[0.0; 3]; 4096 * 4096]);
    let crafted = [
        ("wider", of(film(width + 1, height))),
        ("narrower", of(film(width - 1, height))),
        ("on its side", of(film(height / 2, width * 2))),
        ("too few rows", of(film(width, height - 1))),
        ("too many rows", of(film(width, height + 1))),
        ("one row", of(film(width, 1))),
        (
            "other samples",
            of(Film::with_noise(
                width,
                height,
                radiance.clone(),
                variance.clone(),
                samples + 1,
            )),
        ),
        (
            "no variance",
            of(Film::new(width, height, radiance.clone())),
        ),
        ("an opacity", of(Film::with_opacity(width, height, opaque))),
        (
            "variance of another size",
            sealed(head, &layers.to_exr().unwrap()),
        ),
        ("no number", of(with(f32::NAN, 0.0))),
        ("infinite", of(with(f32::INFINITY, 0.0))),
        ("variance no number", of(with(1.0, f32::NAN))),
        ("negative variance", of(with(1.0, -1.0))),
        ("no image", sealed(head, b"no image")),
        ("huge", of(black)),
        (
            "rows of the head",
            head_with("\"rows\":[0,16]", "\"rows\":[3,1]"),
        ),
        ("paths of the head", head_with("\"paths\":", "\"paths\":9")),
        (
            "samples of the head",
            head_with("\"samples\":", "\"samples\":1"),
        ),
        (
            "another case",
            head_with("\"case\":\"fog/room\"", "\"case\":\"../../room\""),
        ),
    ];
    // Nothing tells it from a unit but the pixels.
    let other_bits = of(Film::with_noise(
        width,
        height,
        doubled(&radiance),
        variance.clone(),
        samples,
    ));
    let merging = Folder::with_room(SAMPLING);
    for (what, crafted) in &crafted {
        let suite = Folder::with_room(SAMPLING);
        suite.write(&units[1].0, &units[1].1);
        suite.write(name, crafted);
        let listed = suite.command("units --json").output().unwrap();
        let noted = String::from_utf8_lossy(&listed.stderr).into_owned();
        assert!(noted.contains("counted as missing"), "{what}: {noted}");
        let listed = Run::of(listed).json();
        let kept = listed["units"].as_array().unwrap().iter();
        assert_eq!(
            kept.filter(|unit| unit["kept"] == true).count(),
            1,
            "{what}"
        );

        let folder = suite.path("").display().to_string();
        suite.remove(&units[1].0);
        let merged = merging.volref(&["merge", &folder]);
        let said = format!("{}{}", merged.stdout, merged.message());
        assert!([2, 5].contains(&merged.code), "{what}: {said}");
        let words = ["not used: ", "nothing was copied"];
        assert!(
            words.iter().any(|words| said.contains(words)),
            "{what}: {said}"
        );
        assert!(!merging.path(".volref").exists(), "{what}");

        let accept = ["accept", "*", "--reason", "first goldens"];
        let accepted = suite.command(&accept).output().unwrap();
        let noted = String::from_utf8_lossy(&accepted.stderr).into_owned();
        assert!(noted.contains("computed again"), "{what}: {noted}");
        let accepted = Run::of(accepted);
        assert_eq!(accepted.code, 0, "{what}: {}", accepted.stderr);
        assert!(
            !accepted.stdout.contains("earlier run"),
            "{what}: {}",
            accepted.stdout
        );
        assert_eq!(suite.files(), whole.files(), "{what}");
    }
    let suite = Folder::with_room(SAMPLING);
    suite.write(name, other_bits);
    let folder = suite.path("").display().to_string();
    assert_eq!(computed.volref(&["merge", &folder]).code, 1);
}

/// Folders within themselves: each turn would make the paths of all files anew.
#[cfg(unix)]
#[test]
fn rings_of_links_end() {
    let [suite, other] = [(); 2].map(|()| Folder::with_room(SAMPLING));
    assert_eq!(other.volref("units --compute").code, 0);
    let units = other.path(".volref/units");
    for name in ["one", "two", "three"] {
        std::os::unix::fs::symlink(&units, units.join(name)).unwrap();
    }
    let kept = other.path("").display().to_string();
    let run = suite.volref(&["merge", &kept, "--json"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_eq!(run.json()["units"]["copied"], 2);
}

/// 128 MiB of zeros, which take 128 kB.
#[test]
fn what_unpacks_to_too_much_is_not_unpacked() {
    let suite = Folder::with_goldens();
    assert_eq!(suite.volref("verify --results kept").code, 0);
    let files = suite.files();
    let (name, file) = files
        .iter()
        .find(|(name, _)| name.ends_with(".result"))
        .unwrap();
    let (head, contents) = opened(file);
    let mut zeros = DeflateEncoder::new(Vec::new(), Compression::best());
    for _ in 0..128 {
        zeros.write_all(&[0; 1 << 20]).unwrap();
    }
    let zeros = zeros.finish().unwrap();
    let mut large: Value = serde_json::from_slice(head).unwrap();
    large["unpacked"] = (128 << 20).into();
    let large = large.to_string();
    for (crafted, words) in [
        (
            sealed(large.as_bytes(), &zeros),
            "volref writes none like it",
        ),
        (sealed(head, &zeros), "another number of bytes than it says"),
        (sealed(large.as_bytes(), contents), "none like it"),
    ] {
        suite.write(name, crafted);
        let run = merged(&suite, &["kept".to_owned()], &[]);
        run.prints(5, &[words]);
    }
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

/// A file that was cut off is computed again; one with other bits, from the same things, is a machine
/// that computes wrongly.
#[test]
fn damaged_units_are_not_used() {
    let [suite, other] = [(); 2].map(|()| Folder::with_room(SAMPLING));
    assert_eq!(suite.volref("units --compute").code, 0);
    let files: BTreeMap<String, Vec<u8>> = suite.files();
    let is_unit = |name: &&String| name.ends_with(".unit");
    let names: Vec<&String> = files.keys().filter(is_unit).collect();
    let (name, bytes) = (names[0], &files[names[0]]);
    suite.write(name, &bytes[..bytes.len() - 1]);
    let run = suite.volref("merge .");
    assert_eq!(run.code, 5);
    assert!(
        run.stdout.contains("not used") && run.stdout.contains("cut off"),
        "{}",
        run.stdout
    );
    // Also where nothing else is known of its case; with another file of its name, nothing is missing.
    let alone = name.replacen(".volref", "alone", 1);
    suite.write(&alone, &bytes[..bytes.len() - 1]);
    assert_eq!(suite.volref("merge alone").code, 5);
    let run = suite.volref("units --compute");
    assert!(run.stdout.contains("1 computed now"), "{}", run.stdout);
    assert_eq!(&suite.read(name), bytes);
    let run = suite.volref("merge alone .");
    assert_eq!(run.code, 0, "{}", run.stdout);
    suite.remove(&alone);

    // The head of one and the rows of another, behind a right hash.
    let (head, _) = opened(bytes);
    let rows = other.path("rows.exr").display().to_string();
    let samples = serde_json::from_slice::<Value>(head).unwrap()["samples"].to_string();
    let render = ["--spp", &samples, "--seed", "99", "-o", &rows];
    let render = [&["render", "fixtures/scenes/fog/room.toml"], &render[..]].concat();
    assert_eq!(suite.volref(&render).code, 0);
    other.write(name, sealed(head, &other.read("rows.exr")));
    let kept = other.path("").display().to_string();
    suite
        .volref(&["merge", &kept])
        .expect(1, "other bits … broken");
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
    let notes = failed.unwrap()["notes"].to_string();
    assert!(notes.contains("its images are missing"), "{notes}");
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
