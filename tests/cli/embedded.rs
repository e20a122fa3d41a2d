//! The suite within the program: in a folder without one, every command finds it.

use crate::folder::{Folder, Run, assert_holds};

/// The core set is that of the suite, in every folder.
#[test]
fn the_core_set_is_listed() {
    let folder = Folder::new();
    let overview = folder.volref("list");
    let core = "The core set, 25 cases that a renderer is asked first, as the filter core:";
    overview.prints(0, &["\nsampled ", "\nhard ", core]);
    assert!(
        overview
            .stdout
            .lines()
            .all(|line| line.chars().count() <= 100)
    );
    let listed = folder.volref("list --json").json();
    let cases = listed["cases"].as_array().unwrap();
    let core: Vec<&str> = cases
        .iter()
        .filter(|case| case["core"] == true)
        .map(|case| case["name"].as_str().unwrap())
        .collect();
    assert_eq!(core.len(), 25);
    for name in core {
        let is_shown = overview.stdout.split_whitespace().any(|word| word == name);
        assert!(is_shown, "{name}");
    }
    let families = listed["families"].as_array().unwrap();
    assert_eq!(families[0]["name"], "sampled");
    assert_eq!(families[families.len() - 1]["name"], "hard");
    let selected = folder.volref("list core --json").json();
    assert_eq!(selected["cases"].as_array().unwrap().len(), 25);
}

#[test]
fn an_empty_folder_is_enough() {
    let folder = Folder::new();
    let run = folder.volref("list figures");
    run.prints(0, &["figures/figure-1", "figures/figure-5"]);
    // Lines of progress are left out of `Run`.
    let said = folder.command("list figures").output().unwrap().stderr;
    let said = String::from_utf8(said).unwrap();
    assert!(said.contains("volref: the suite of volref "), "{said}");
    folder
        .volref("verify figure-2")
        .prints(0, &["1 case: 1 passed"]);
    // A case stands for its scene.
    folder
        .volref("render figure-2 -o out/figures/figure-2.exr")
        .expect(2, "its folder does not exist");
    folder
        .volref("render figures/figure-2 -o figure-2.exr")
        .expect(0, "");
    folder.volref("plan figure-2").expect(0, "");
    let run = folder.volref("validate figure-2 --outputs .");
    run.prints(0, &["pass", "figures/figure-2"]);
    let run = folder.volref("export figure-2 --to bundle -o bundle");
    run.prints(0, &["figure-2.json"]);
    let files = folder.files();
    let unexpected = |name: &&String| *name != "figure-2.exr" && !name.starts_with("bundle/");
    assert_eq!(files.keys().find(unexpected), None);
    let run = folder.volref("render figure-9 -o x.exr");
    run.expect(2, "no case matches \"figure-9\" … did you mean");
    // Another number is meant, not misspelt.
    folder.write("frames/figure-20001.exr", folder.read("figure-2.exr"));
    let run = folder.volref("validate figures --outputs frames");
    let said = format!("{}{}", run.stdout, run.stderr);
    assert_holds(&said, &["figure-20001.exr does not match any case"]);
    assert!(!said.contains("did you mean"), "{said}");
    let run = folder.volref("render figure-9.toml -o x.exr");
    run.expect(2, "figure-9.toml … cannot read");
}

#[test]
fn it_is_kept_and_never_changed() {
    let folder = Folder::new();
    let cached = [("VOLREF_CACHE", "cache")];
    let arguments = ["verify", "figure-2"];
    folder.run_with(&cached, &arguments).expect(0, "");
    let files = folder.files();
    let golden = files
        .keys()
        .find(|name| name.ends_with("golden/figures/figure-2.exr"));
    let golden = golden.expect("it is unpacked").clone();
    folder.write(&golden, "damaged");
    folder.run_with(&cached, &arguments).expect(0, "");
    assert!(folder.read(&golden) == files[&golden]);

    let run = folder.volref("accept figure-2 --reason none");
    run.expect(2, "cannot be changed … volref suite --extract DIR");
    let run = folder.volref("suite --extract copy");
    run.prints(0, &["written into copy", "--suite copy"]);
    folder.volref("verify figure-2 --suite copy").expect(0, "");
    folder
        .volref("suite --extract copy")
        .expect(2, "exists already");
    // The sensitivities of the suite are sealed, too.
    let file = "golden/sensitivities/fog/absorption.exr";
    let mut damaged = folder.read(&format!("copy/{file}"));
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    folder.write(&format!("copy/{file}"), damaged);
    let run = folder.volref("verify fog/absorption --suite copy");
    run.prints(3, &[file]);
    let shown = folder.volref("suite --json").json();
    assert!(shown["files"].as_u64().unwrap() > 1000);
}

/// Without a folder for caches it is unpacked among temporary files; without any, the message says what to do.
#[cfg(unix)]
#[test]
fn without_a_place_to_keep_it() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("temporary")).unwrap();
    folder.write("file", "");
    let verify = ["verify", "figure-2"];
    let with_temporary = |place| {
        let variables = [("VOLREF_CACHE", "file/cache"), ("TMPDIR", place)];
        folder.run_with(&variables, &verify)
    };
    with_temporary("temporary").expect(0, "");
    assert!(folder.path("temporary/volref/suite").is_dir());
    let words = "cannot unpack the suite … VOLREF_CACHE=DIR … --suite DIR";
    with_temporary("file").expect(2, words);
    // Whoever names a suite needs none.
    let suite = Folder::with_suite();
    let run = suite.run_with(&[("TMPDIR", "nowhere")], &["list", "smoke"]);
    run.prints(0, &["smoke/plain"]);
    // The user's own folder for caches.
    let mut command = folder.command(&verify[..]);
    command.env_remove("VOLREF_CACHE");
    command.env("XDG_CACHE_HOME", folder.path("xdg"));
    Run::of(command.output().unwrap()).expect(0, "");
    assert!(folder.path("xdg/volref/suite").is_dir());
}
