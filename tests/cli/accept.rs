//! `volref accept`

use crate::folder::{Folder, assert_shown};

#[test]
fn new_goldens() {
    let suite = Folder::with_suite();
    let run = suite.volref("accept smoke/plain plots --reason 'first goldens'");
    assert_shown!(run.shown(), @r"
    exit code 0
    --- stdout
    new        plots/curve: its first golden
    new        smoke/plain: its first golden

    Now look at the images in golden.
    ");
    let files: Vec<_> = suite
        .files()
        .into_keys()
        .filter(|name| name.starts_with("golden"))
        .collect();
    assert_eq!(
        files,
        [
            "golden/.gitignore",
            "golden/plots/curve.exr",
            "golden/plots/curve.png",
            "golden/plots/curve.toml",
            "golden/smoke/plain.exr",
            "golden/smoke/plain.png",
            "golden/smoke/plain.toml",
        ]
    );
    assert_eq!(suite.volref("verify smoke/plain plots").code, 0);
}

#[test]
fn unchanged_goldens_keep_their_files_and_reasons() {
    let suite = Folder::with_goldens();
    let before = suite.files();
    let run = suite.volref("accept smoke/plain --reason again");
    assert_shown!(run.shown(), @r"
    exit code 0
    --- stdout
    unchanged  smoke/plain: kept, with its old reason
    ");
    assert_eq!(suite.files(), before);
}

#[test]
fn another_scene_with_the_same_picture_is_recorded() {
    let suite = Folder::with_goldens();
    // The default, written down.
    suite.edit(
        "fixtures/scenes/plots/curve.toml",
        "[curve]",
        "[curve]\ndensities = 1.20",
    );
    assert_eq!(suite.volref("verify plots").code, 0);
    let reasons = |key: &str| -> Option<String> {
        let record: toml::Table = suite.text("golden/smoke/plain.toml").parse().unwrap();
        Some(record.get(key)?.as_str().unwrap().to_owned())
    };
    let of_the_picture = reasons("reason").unwrap();
    assert_eq!(reasons("record_reason"), None);
    // Another text for the same picture: a row of voxels as a length.
    suite.edit("fixtures/scenes/smoke/plain.toml", "0.2 voxels", "0.04");
    let run = suite.volref("verify smoke/plain");
    assert_eq!(run.code, 3, "{}", run.stdout);
    let run = suite.volref("accept plain --reason 'world units read better'");
    assert_shown!(run.shown(), @r"
    exit code 0
    --- stdout
    recorded   smoke/plain: same image; its record (scene, plan, truth, how it is judged, quick rendering or sensitivities) changed
    ");
    assert_eq!(reasons("reason").unwrap(), of_the_picture);
    assert_eq!(reasons("record_reason").unwrap(), "world units read better");
    assert_eq!(suite.volref("verify").code, 0);
}

#[test]
fn replaced_goldens_remember_what_they_replaced() {
    let suite = Folder::with_goldens();
    let field = |name: &str| -> String {
        let provenance: toml::Table = suite.text("golden/smoke/plain.toml").parse().unwrap();
        provenance[name].as_str().unwrap().to_owned()
    };
    let before = field("pixels");
    suite.edit("fixtures/volumes/cloud.obj", "0.5 0.5 2", "0.5 0.5 3");
    let run = suite.volref("accept smoke --reason '  a denser middle ' --json");
    assert_shown!(run.shown(), @r#"
    exit code 0
    --- stdout
    {
      "cases": [
        {
          "change": "replaced",
          "name": "smoke/nearest",
          "reason": "4 of 120 pixels differ in colour and 4 in opacity; the largest difference of a channel is 5.625e-1"
        },
        {
          "change": "replaced",
          "name": "smoke/plain",
          "reason": "16 of 120 pixels differ in colour and 16 in opacity; the largest difference of a channel is 1.742e-1"
        },
        {
          "change": "replaced",
          "name": "smoke/shadow",
          "reason": "30 of 120 pixels differ in colour and 16 in opacity; the largest difference of a channel is 1.464e-1"
        }
      ],
      "schema": "volref/accept/1"
    }
    "#);
    assert_eq!(field("replaces"), before);
    assert_ne!(field("pixels"), before);
    let record: toml::Table = suite.text("golden/smoke/plain.toml").parse().unwrap();
    assert_eq!(record["changed_pixels"].as_integer(), Some(16));
    assert_eq!(field("reason"), "a denser middle");
    assert_eq!(suite.volref("verify").code, 0);
}

/// Refusals leave every file as it was.
#[test]
fn refusals() {
    let suite = Folder::with_goldens();
    suite.edit("fixtures/volumes/cloud.obj", "0.5 0.5 2", "0.5 0.5 3");
    let before = suite.files();

    let mut in_ci = suite.command("accept '*' --reason 'a robot says so'");
    let run = crate::folder::Run::of(in_ci.env("CI", "true").output().unwrap());
    run.expect(2, "CI");

    for blank in ["", " \t\n"] {
        let run = suite.volref(&["accept", "*", "--reason", blank]);
        run.expect(2, "reason");
    }
    suite.volref("accept '*'").expect(2, "--reason <TEXT>");
    let run = suite.volref("accept smoke smoke/plane --reason r");
    run.expect(5, "no case matches \"smoke/plane\" … smoke/plain");
    assert_eq!(suite.files(), before);
}

#[test]
fn an_empty_ci_variable_is_no_ci() {
    let suite = Folder::with_suite();
    let mut command = suite.command("accept curve --reason first");
    assert!(command.env("CI", "").output().unwrap().status.success());
}

#[test]
fn one_broken_case_spoils_them_all() {
    let suite = Folder::with_goldens();
    suite.edit("fixtures/volumes/cloud.obj", "0.5 0.5 2", "0.5 0.5 3");
    suite.edit(
        "fixtures/scenes/smoke/shadow.toml",
        "width = 12",
        "width = \"12\"",
    );
    let before = suite.files();
    let run = suite.volref("accept smoke --reason denser");
    run.expect(2, "smoke/shadow … fixtures/scenes/smoke/shadow.toml:2:9 … whole number … nothing was accepted");
    assert_eq!(suite.files(), before);
}

#[test]
fn a_golden_that_cannot_be_read_is_made_new() {
    let suite = Folder::with_goldens();
    suite.write("golden/smoke/plain.toml", "garbage");
    suite.remove("golden/plots/curve.png");
    let run = suite.volref("accept plain curve --reason mended");
    assert_shown!(run.shown(), @r"
    exit code 0
    --- stdout
    new        plots/curve: the old golden was damaged
    new        smoke/plain: the old golden was damaged

    Now look at the images in golden.
    ");
    assert_eq!(suite.volref("verify").code, 0);
}

/// A path below a regular file is unwritable for everybody, root included.
#[test]
fn an_unwritable_folder_of_goldens() {
    let suite = Folder::with_suite();
    suite.write("golden", "a file where the folder should be");
    let before = suite.files();
    let run = suite.volref("accept curve --reason first");
    run.expect(
        2,
        "golden … move the file that stands in the place of a directory",
    );
    assert_eq!(suite.files(), before);
}

/// A disk that fills up while the goldens are written: here, a limit on the size of files. The
/// store's own tests let every single operation fail; this one goes through the real ones.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_the_old_goldens() {
    let suite = Folder::with_goldens();
    // An image of more than a block (512 bytes, or 1024), whatever its compression.
    suite.edit(
        "fixtures/scenes/smoke/plain.toml",
        "width = 12",
        "width = 48",
    );
    let before = suite.files();
    let script = "ulimit -f 2; trap '' XFSZ; exec \"$@\"";
    let volref = env!("CARGO_BIN_EXE_volref");
    let limited = [
        "-c", script, "sh", volref, "accept", "smoke", "--reason", "wider",
    ];
    let mut command = std::process::Command::new("sh");
    let command = command
        .args(limited)
        .current_dir(suite.path(""))
        .env_remove("CI");
    let run = crate::folder::Run::of(command.output().unwrap());
    run.expect(2, "cannot write … too large … untouched … free some space");
    assert_eq!(suite.files(), before);
    suite.edit(
        "fixtures/scenes/smoke/plain.toml",
        "width = 48",
        "width = 12",
    );
    assert_eq!(suite.volref("verify").code, 0);
}
