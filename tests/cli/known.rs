//! `volref validate --known`: failures that are listed do not fail a run; those that are new, mended or worse do.

use crate::folder::{Folder, Run, assert_holds};
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
share = 1
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
    let link = "half the light (https://example.org/1)";
    let counts = "known failures: 3 known\n";
    run.prints(0, &["known         smoke/plain", link, counts]);
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
    let counts = "skipped=\"3\" failures=\"0\" errors=\"0\"";
    let skipped = "<skipped message=\"known: no shadow\"/>";
    assert_holds(&folder.text("r.xml"), &[counts, skipped]);
    assert!(folder.text("page/index.html").contains("known: no shadow"));

    darken(&folder, "plots/curve", 0.5);
    let run = validate(&folder, "--json=r.json");
    assert_eq!(run.code, 1);
    assert_eq!(status(&folder, "plots/curve"), "new");
    let run = validate(&folder, "--junit r.xml");
    let told = "3 known, 1 new\nnew           known.toml:16: plots/curve is \"fail\": mend the renderer, or write [\"plots/curve\"] and below it verdict = \"fail\", bound = 45.5, share = 1";
    run.prints(1, &[told]);
    assert_holds(&folder.text("r.xml"), &["skipped=\"3\" failures=\"1\""]);
    // Another part of the suite has nothing to do with it.
    validate(&folder, "smoke").expect(0, "");
}

#[test]
fn what_is_mended_worse_or_otherwise_is_red_with_the_line() {
    let folder = suite();
    folder.write("known.toml", KNOWN.replace("1000", "1.5"));
    let said = |folder: &Folder, words: &str| {
        validate(folder, "").prints(1, &[words]);
        validate(folder, "--json=r.json --junit r.xml");
    };
    said(
        &folder,
        "known.toml:12: smoke/shadow is worse, beyond the margin: mend the renderer, or write bound = ",
    );
    assert_eq!(status(&folder, "smoke/shadow"), "worse");
    folder.write("known.toml", KNOWN);

    darken(&folder, "smoke/nearest", 0.5);
    said(
        &folder,
        "known.toml:8: smoke/nearest is \"fail\" now: mend the renderer, or write verdict = \"fail\"",
    );
    assert_eq!(status(&folder, "smoke/nearest"), "otherwise");
    folder.write("out/smoke/nearest.exr", "no image");

    darken(&folder, "smoke/plain", 1.0);
    said(
        &folder,
        "known.toml:4: smoke/plain passes: remove the entry [\"smoke/plain\"]",
    );
    assert_eq!(status(&folder, "smoke/plain"), "mended");
    let told = "<failure message=\"mended: known.toml:4";
    assert_holds(&folder.text("r.xml"), &[told]);
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
    folder.write("known.toml", listed("step-doubled"));
    let told = "known.toml:1: smoke/plain looks like \"bright-halved\" now: mend the renderer, or write cause = \"bright-halved\"";
    folder.volref(searched).prints(1, &[told]);
}

#[test]
fn an_update_writes_what_is_new_and_takes_out_what_is_mended() {
    let folder = suite();
    // A new file.
    let told = "known.toml is written; 3 new entries need a reason";
    update(&folder).prints(0, &[told]);
    let written = folder.text("known.toml");
    let nearest = "[\"smoke/nearest\"]\nverdict = \"error\"\nreason = \"\"\n\n[\"smoke/plain\"]\nverdict = \"fail\"\nbound = ";
    assert!(written.contains(nearest), "{written}");
    // Whose reasons are yet to be written.
    validate(&folder, "").expect(2, "known.toml:1:2:  … has no reason … --known-update");
    folder.write("known.toml", written.replace("\"\"", "\"a reason\""));
    validate(&folder, "").expect(0, "");
    update(&folder).prints(0, "is as it was");

    // A file by hand: its first entry is mended, another fault is new.
    folder.write("known.toml", KNOWN);
    darken(&folder, "smoke/plain", 1.0);
    darken(&folder, "plots/curve", 0.5);
    update(&folder).expect(0, "");
    let written = folder.text("known.toml");
    let rest = KNOWN.split_once("[\"nearest\"]").unwrap().1;
    let begin = format!(
        "# What our renderer gets wrong.\n\n# Rounds its opacities.\n\n[\"nearest\"]{rest}\n[\"plots/curve\"]\n"
    );
    assert!(written.starts_with(&begin), "{written}");

    // A pattern of which one case is mended leaves it out; one that fails otherwise gets an entry of its own.
    folder.write("known.toml", "# Ours.\n[\"smoke\"] # all\nverdict = \"fail\" # so far\nreason = \"fog\"\n\n[\"plots/*\"]\nreason = \"p\"\n");
    darken(&folder, "smoke/nearest", 0.5);
    folder.remove("out/smoke/shadow.exr");
    assert_eq!(validate(&folder, "").code, 1);
    validate(&folder, "--only-present --known-update").expect(0, "");
    let written = folder.text("known.toml");
    let listed = |name: &str, sizes: &str| {
        format!("[\"{name}\"] # all\nverdict = \"fail\" # so far\nreason = \"fog\"\n{sizes}\n")
    };
    let begin =
        "# Ours.\n".to_owned() + &listed("smoke !smoke/plain", "bound = 45.5\nshare = 0.167\n");
    assert!(written.starts_with(&begin), "{written}");
    validate(&folder, "smoke/nearest smoke/plain plots").expect(0, "");
}

/// Another fault below a high bound shows in how much of the image differs; and an image that cannot be compared gets
/// its sizes once it can be.
#[test]
fn the_share_of_the_image_is_bounded_too() {
    let folder = suite();
    let reason = "reason = \"no shadow\"\n";
    folder.write("known.toml", format!("[\"smoke/shadow\"]\n{reason}"));
    let validate = |more: &str| validate(&folder, &format!("smoke/shadow {more}"));
    folder.write_film(
        "out/smoke/shadow.exr",
        &volref::film::Film::new(1, 1, vec![[0.0; 3]]),
    );
    validate("--known-update").expect(0, "");
    assert!(!folder.text("known.toml").contains("share"));
    darken(&folder, "smoke/shadow", 0.5);
    let told = "known.toml:1: smoke/shadow fails without a bound in the entry: write bound = 27.9, share = 0.134";
    validate("").prints(0, &[told]);
    validate("--known-update").expect(0, "");
    let written = folder.text("known.toml");
    assert!(
        written.contains("bound = 27.9\nshare = 0.134\n"),
        "{written}"
    );
    validate("").expect(0, "");

    // A tenth brighter all over: no pixel is worse than the worst was.
    folder.write("known.toml", written.replace("27.9", "1000"));
    let mut film = folder.film("out/smoke/shadow.exr").radiance().to_vec();
    film.iter_mut()
        .for_each(|pixel| *pixel = pixel.map(|value| value + 0.1));
    folder.write_film(
        "out/smoke/shadow.exr",
        &volref::film::Film::new(12, 10, film),
    );
    let told = "known.toml:1: smoke/shadow is worse, beyond the margin: mend the renderer, or write share = 1";
    validate("").prints(1, &[told]);
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
            &["known.toml:1:2:", "names no case that fails"],
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
            "[smoke]\ncause = \"step-doubles\"".to_owned() + reason,
            &["known.toml:2:", "did you mean \"step-doubled\"?"],
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
