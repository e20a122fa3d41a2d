//! Files that people have: goldens of any suite, links, folders and exports that no command may take for its own.

use crate::folder::{Folder, Run, scene};
use std::fs;
use std::os::unix::fs::symlink;

/// Goldens are known by their provenance, in whatever folder they are.
#[test]
fn goldens_of_no_suite_stay() {
    let folder = Folder::with_goldens();
    for name in ["plain.exr", "plain.png", "plain.toml"] {
        let golden = folder.read(&format!("golden/smoke/{name}"));
        folder.write(&format!("baseline/smoke/{name}"), golden);
    }
    let sensitivity = "baseline/sensitivities/smoke/plain.exr";
    folder.write(sensitivity, "a sensitivity");
    symlink("baseline/smoke/plain.exr", folder.path("link.exr")).unwrap();
    let run = ["--run", "cp golden/smoke/plain.exr {output}", "smoke/plain"];
    let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n";
    let provenance = folder.text("baseline/smoke/plain.toml");
    for provenance in [&provenance, pointer] {
        folder.write("baseline/smoke/plain.toml", provenance);
        let before = folder.files();
        for outputs in ["baseline", "baseline/smoke"] {
            for option in ["--keep", "--report", "--ctest"] {
                let words = [&["validate", option, outputs][..], &run].concat();
                folder
                    .volref(&words)
                    .expect(2, "holds goldens, such as baseline/smoke/plain.toml");
            }
        }
        for file in ["link.exr", "baseline/smoke/plain.exr", sensitivity] {
            let words = ["render", "fixtures/scenes/smoke/plain.toml", "-o", file];
            folder.volref(&words).expect(2, "is a golden");
        }
        assert!(folder.files() == before);
    }
}

/// A link that a renderer leaves is replaced by the file that it leads to, or goes where there is none.
#[test]
fn no_link_stays_among_the_kept_images() {
    let folder = Folder::with_goldens();
    for (target, code) in [("golden/smoke/plain.exr", 0), ("nowhere", 4)] {
        let target = folder.path(target);
        let command = format!("ln -s '{}' {{output}}", target.display());
        let words = [
            "validate",
            "smoke/plain",
            "--keep",
            "kept",
            "--run",
            &command,
        ];
        let run = folder.volref(&words);
        assert_eq!(run.code, code, "{}{}", run.stdout, run.stderr);
        let image = folder.path("kept/smoke/plain.exr");
        assert!(!image.is_symlink());
        assert_eq!(image.exists(), code == 0);
    }
}

/// Version control is not told to ignore a folder that was there before.
#[test]
fn a_folder_of_the_users_is_not_hidden() {
    let folder = Folder::with_goldens();
    folder.write("mine/notes.txt", "mine");
    for (results, is_ours) in [("mine", false), ("new", true)] {
        for part in ["slice:1/2", "slice:2/2"] {
            let words = ["verify", "smoke", "--partition", part, "--results", results];
            folder.volref(&words).expect(0, "");
        }
        assert!(folder.path(results).join("results").is_dir());
        assert_eq!(folder.path(results).join(".gitignore").exists(), is_ours);
    }
}

#[test]
fn two_exports_of_one_name_are_refused() {
    let folder = Folder::with_suite();
    let small = scene("").replace("../../", "../fixtures/");
    folder.write("a/plain.toml", &small);
    folder.write("b/plain.toml", small.replace("width = 12", "width = 13"));
    let export = |scene: &str| folder.volref(&["export", scene, "--to", "bundle", "-o", "out"]);
    export("a/plain.toml").expect(0, "");
    let first = folder.files();
    export("b/plain.toml").expect(2, "out/plain.json is there already … another folder");
    assert!(folder.files() == first);
    // The same once more; and a scene that was edited since.
    export("a/plain.toml").expect(0, "");
    folder.edit("a/plain.toml", "width = 12", "width = 14");
    let later = fs::File::open(folder.path("a/plain.toml")).unwrap();
    let now = std::time::SystemTime::now();
    later
        .set_modified(now + std::time::Duration::from_secs(9))
        .unwrap();
    export("a/plain.toml").expect(0, "");
    assert!(folder.files() != first);
}

/// A link within the cache leads to a folder of the user's, which is not filled.
#[test]
fn links_within_the_cache_are_not_followed() {
    let folder = Folder::new();
    for name in ["mine", "cache", "temporary"] {
        fs::create_dir(folder.path(name)).unwrap();
    }
    symlink("../mine", folder.path("cache/suite")).unwrap();
    let variables = [("VOLREF_CACHE", "cache"), ("TMPDIR", "temporary")];
    folder
        .run_with(&variables, &["list", "figures"])
        .expect(0, "");
    assert_eq!(fs::read_dir(folder.path("mine")).unwrap().count(), 0);
}

/// Where a file system ignores capitals, these are one file.
#[test]
fn names_that_differ_in_capitals_alone_are_refused() {
    let suite = Folder::with_suite();
    let manifest = suite.read("fixtures/cases/smoke/plain.toml");
    let file = "fixtures/cases/smoke/Plain.toml";
    suite.write(file, &manifest);
    let other = "fixtures/cases/smoke/plain.toml";
    let words = [file, other, "differ in capitals alone", "rename one"];
    suite.volref("list").expect(2, &words);
}

/// A message names the file that was asked for, not the one beside it.
#[test]
fn a_full_disk_is_said_of_the_output() {
    let folder = Folder::with_suite();
    let scene = "fixtures/scenes/smoke/plain.toml";
    folder.edit(scene, "width = 12", "width = 48");
    let script = "ulimit -f 1; trap '' XFSZ; exec \"$@\"";
    for words in [
        ["render", scene, "-o", "image.exr", "--threads", "1"],
        ["export", scene, "--to", "bundle", "-o", "out"],
    ] {
        let mut command = std::process::Command::new("sh");
        let command = command.args(["-c", script, "sh", env!("CARGO_BIN_EXE_volref")]);
        let run = Run::of(
            command
                .args(words)
                .current_dir(folder.path(""))
                .output()
                .unwrap(),
        );
        assert_eq!(run.code, 2, "{}", run.stderr);
        assert!(run.stderr.contains("cannot write"), "{}", run.stderr);
        assert!(!run.stderr.contains(".partial"), "{}", run.stderr);
    }
}
