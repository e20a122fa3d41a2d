//! `volref validate --known`: failures that are listed do not fail a run; those that are new, mended or worse do.

use crate::folder::{Folder, Run};
use crate::validate::scaled;

/// A renderer with three faults, and the file that lists them.
const KNOWN: &str = "\
# What our renderer gets wrong.

# Rounds its opacities.
[\"smoke/plain\"]
reason = \"half the light\" # by hand
link = \"https://example.org/1\"

[\"nearest\"]
verdict = \"error\"
reason = \"no image yet\"

[\"smoke/shadow\"]
reason = \"no shadow\"
bound = 1000
";

fn suite() -> Folder {
    let folder = Folder::with_goldens();
    let curve = folder.read("golden/plots/curve.exr");
    folder.write("out/plots/curve.exr", curve);
    folder.write("out/smoke/nearest.exr", "no image");
    for case in ["smoke/plain", "smoke/shadow"] {
        darken(&folder, case, 0.5);
    }
    folder
}

fn darken(folder: &Folder, case: &str, factor: f32) {
    let golden = folder.film(&format!("golden/{case}.exr"));
    folder.write_film(&format!("out/{case}.exr"), &scaled(&golden, factor));
}

fn validate(folder: &Folder, more: &str) -> Run {
    folder.volref(&*format!(
        "validate --outputs out --explain 0 --known known.toml {more}"
    ))
}

fn update(folder: &Folder) -> Run {
    validate(folder, "--known-update")
}

fn status(folder: &Folder, case: &str) -> String {
    let json = folder.json("r.json");
    let cases = json["cases"].as_array().unwrap();
    let found = cases.iter().find(|of| of["name"] == case).unwrap();
    found["known"]["status"].as_str().unwrap_or("").to_owned()
}

#[test]
fn three_known_faults_are_green_and_a_fourth_is_red() {
    let folder = suite();
    folder.write("known.toml", KNOWN);
    let run = validate(&folder, "--json=r.json --junit r.xml --report page");
    run.expect(0, "");
    for said in [
        "known         smoke/plain",
        "half the light (https://example.org/1)",
        "known failures: 3 known\n",
    ] {
        assert!(run.stdout.contains(said), "{said}: {}", run.stdout);
    }
    let json = folder.json("r.json");
    assert_eq!(json["summary"]["fail"], 2, "the verdicts stay");
    assert_eq!(
        (&json["summary"]["known"], &json["summary"]["new"]),
        (&3.into(), &0.into())
    );
    let plain = json["cases"].as_array().unwrap().iter();
    let plain = plain
        .clone()
        .find(|of| of["name"] == "smoke/plain")
        .unwrap();
    assert_eq!(plain["verdict"], "fail");
    assert_eq!(plain["known"]["line"], 4);
    assert_eq!(plain["known"]["link"], "https://example.org/1");
    let junit = folder.text("r.xml");
    assert!(
        junit.contains("skipped=\"3\" failures=\"0\" errors=\"0\""),
        "{junit}"
    );
    assert!(
        junit.contains("<skipped message=\"known: no shadow\"/>"),
        "{junit}"
    );
    assert!(folder.text("page/index.html").contains("known: no shadow"));

    darken(&folder, "plots/curve", 0.5);
    let run = validate(&folder, "--json=r.json");
    assert_eq!(run.code, 1);
    assert_eq!(status(&folder, "plots/curve"), "new");
    let run = validate(&folder, "--junit r.xml");
    assert!(
        run.stdout
            .contains("3 known, 1 new\nnew           plots/curve: fail"),
        "{}",
        run.stdout
    );
    assert!(
        folder
            .text("r.xml")
            .contains("skipped=\"3\" failures=\"1\"")
    );
    // Another part of the suite has nothing to do with it.
    validate(&folder, "smoke").expect(0, "");
}

#[test]
fn what_is_mended_worse_or_otherwise_is_red_with_the_line() {
    let folder = suite();
    folder.write("known.toml", KNOWN.replace("1000", "1.5"));
    let said = |folder: &Folder, words: &str| {
        let run = validate(folder, "--json=r.json --junit r.xml");
        assert_eq!(run.code, 1, "{}", run.stderr);
        let run = validate(folder, "");
        assert!(run.stdout.contains(words), "{words}: {}", run.stdout);
    };
    said(
        &folder,
        "known.toml:14: smoke/shadow is worse, beyond the margin: write bound = ",
    );
    assert_eq!(status(&folder, "smoke/shadow"), "worse");
    folder.write("known.toml", KNOWN);

    darken(&folder, "smoke/nearest", 0.5);
    said(
        &folder,
        "known.toml:9: smoke/nearest is \"fail\" now: write verdict = \"fail\"",
    );
    assert_eq!(status(&folder, "smoke/nearest"), "otherwise");
    folder.write("out/smoke/nearest.exr", "no image");

    darken(&folder, "smoke/plain", 1.0);
    said(
        &folder,
        "known.toml:4: smoke/plain passes: remove the entry [\"smoke/plain\"]",
    );
    assert_eq!(status(&folder, "smoke/plain"), "mended");
    assert!(
        folder
            .text("r.xml")
            .contains("<failure message=\"mended: known.toml:4")
    );
    darken(&folder, "smoke/plain", 0.5);

    // An image that is not there has not been judged.
    folder.remove("out/smoke/plain.exr");
    let run = validate(&folder, "--json=r.json");
    assert_eq!(run.code, 4);
    assert_eq!(status(&folder, "smoke/plain"), "");
    // A golden that nobody can trust is no known failure.
    folder.write("golden/smoke/shadow.exr", "another");
    assert_eq!(validate(&folder, "").code, 3);
}

/// The largest difference is held against the bound with the margin of the gate, 20 tolerances.
#[test]
fn a_difference_within_the_margin_of_its_bound_is_known() {
    let folder = suite();
    folder.write("known.toml", KNOWN);
    validate(&folder, "smoke/shadow --json=r.json");
    let worst = folder.json("r.json")["cases"][0]["metrics"]["worst_in_tolerances"].clone();
    let worst = worst.as_f64().unwrap();
    for (bound, code) in [(worst - 19.9, 0), (worst - 20.1, 1)] {
        folder.write("known.toml", KNOWN.replace("1000", &format!("{bound}")));
        assert_eq!(validate(&folder, "smoke/shadow").code, code, "{bound}");
    }
}

/// Without a search nothing is said of a cause; with one another cause is another failure.
#[test]
fn a_cause_counts_where_it_was_searched() {
    let folder = suite();
    let listed = |cause: &str| format!("[\"smoke/plain\"]\ncause = \"{cause}\"\nreason = \"r\"\n");
    let searched = "validate plain --outputs out --explain 10 --known known.toml --json=r.json";
    folder.write("known.toml", listed("bright-halved"));
    folder.volref(searched).expect(0, "");
    folder.write("known.toml", listed("brightened"));
    assert_eq!(folder.volref(searched).code, 1);
    let run = folder.volref(searched);
    assert!(
        run.stdout.contains(
            "known.toml:2: smoke/plain looks like \"bright-halved\" now: write cause = \"bright-halved\""
        ),
        "{}",
        run.stdout
    );
}

#[test]
fn an_update_writes_what_is_new_and_takes_out_what_is_mended() {
    let folder = suite();
    // A new file.
    let run = update(&folder);
    run.expect(0, "");
    assert!(
        run.stdout
            .contains("known.toml is rewritten; write the reasons of the 3 new entries"),
        "{}",
        run.stdout
    );
    let written = folder.text("known.toml");
    assert!(written.starts_with("# Known failures"), "{written}");
    let nearest = "[\"smoke/nearest\"]\nverdict = \"error\"\nreason = \"\"\n\n[\"smoke/plain\"]\nverdict = \"fail\"\nbound = ";
    assert!(written.contains(nearest), "{written}");
    // Whose reasons are yet to be written.
    validate(&folder, "").expect(2, "known.toml:4:2:  … has no reason … --known-update");
    folder.write("known.toml", written.replace("\"\"", "\"a reason\""));
    validate(&folder, "").expect(0, "");
    let again = update(&folder);
    again.expect(0, "");
    assert!(again.stdout.contains("is as it was"), "{}", again.stdout);

    // A file by hand: its first entry is mended, another fault is new.
    folder.write("known.toml", KNOWN);
    darken(&folder, "smoke/plain", 1.0);
    darken(&folder, "plots/curve", 0.5);
    update(&folder).expect(0, "");
    let written = folder.text("known.toml");
    let rest = KNOWN.split_once("[\"nearest\"]").unwrap().1;
    let begin =
        format!("# What our renderer gets wrong.\n\n[\"nearest\"]{rest}\n[\"plots/curve\"]\n");
    assert!(written.starts_with(&begin), "{written}");

    // A pattern of which one case is mended becomes entries of the others, in its place.
    folder.write("known.toml", "# Ours.\n[\"smoke\"] # all\nverdict = \"fail\" # so far\nreason = \"fog\"\n\n[\"plots/*\"]\nreason = \"p\"\n");
    darken(&folder, "smoke/nearest", 0.5);
    assert_eq!(validate(&folder, "").code, 1);
    update(&folder).expect(0, "");
    let written = folder.text("known.toml");
    assert_eq!(
        written,
        "# Ours.\n[\"smoke/nearest\"] # all\nverdict = \"fail\" # so far\nreason = \"fog\"\n\n\
         [\"smoke/shadow\"] # all\nverdict = \"fail\" # so far\nreason = \"fog\"\n\n[\"plots/*\"]\nreason = \"p\"\n"
    );
    validate(&folder, "").expect(0, "");
}

#[test]
fn nothing_is_written_in_ci() {
    let folder = suite();
    let arguments = "validate --outputs out --known known.toml --known-update";
    let mut command = folder.command(arguments);
    let run = Run::of(command.env("CI", "true").output().unwrap());
    run.expect(2, "--known-update … variable CI is set");
    assert!(!folder.path("known.toml").exists());
}

#[test]
fn bad_files_are_refused_with_their_line() {
    let folder = suite();
    validate(&folder, "").expect(
        2,
        "known.toml … cannot read the known failures … --known-update",
    );
    let reason = "\nreason = \"r\"\n";
    for (text, said) in [
        (
            "[\"smoke/plane\"]\n".to_owned() + reason,
            &["known.toml:1:2:", "no case matches", "smoke/plain"][..],
        ),
        (
            "\n[\"fog*\"]".to_owned() + reason,
            &["known.toml:2:2:", "no case matches"],
        ),
        (
            "[\"!smoke\"]".to_owned() + reason,
            &["known.toml:1:2:", "excludes"],
        ),
        (
            "[\"sm[oke\"]".to_owned() + reason,
            &["known.toml:1:2:", "is not a pattern"],
        ),
        (
            format!("[\"smoke\"]{reason}[\"smoke/plain\"]{reason}"),
            &[
                "known.toml:3:2:",
                "two entries name the case smoke/plain: lines 1 and 3",
            ],
        ),
        (
            format!("[smoke]{reason}[smoke]{reason}"),
            &["known.toml:3", "duplicate"],
        ),
        (
            "[smoke]\nreason = \" \"".to_owned(),
            &["known.toml:1:2:", "has no reason"],
        ),
        (
            "[smoke]\nverdict = \"fail\"".to_owned(),
            &["known.toml:1:2:", "has no reason"],
        ),
        (
            "[smoke]\nverdict = \"pass\"".to_owned() + reason,
            &["known.toml:2:", "verdict"],
        ),
        (
            "[smoke]\nbound = -1".to_owned() + reason,
            &["known.toml:2:", "bound"],
        ),
        (
            "[smoke]\nreasons = \"r\"".to_owned(),
            &["known.toml:2:", "did you mean `reason`"],
        ),
        ("smoke = 1".to_owned(), &["known.toml:1:", "is no table"]),
        ("[smoke".to_owned(), &["known.toml:1:"]),
    ] {
        folder.write("known.toml", &text);
        validate(&folder, "").expect(2, said);
    }
    let run = folder.volref("validate --outputs out --known-update");
    run.expect(2, "--known <FILE>");
}
