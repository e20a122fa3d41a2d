//! Outputs that cannot be written.

use crate::folder::Folder;

/// Every command that writes a file, and that file's option.
#[test]
fn every_output_is_refused_in_words_and_leaves_nothing() {
    let folder = Folder::with_goldens();
    for name in ["cloud.obj", "scene.toml"] {
        let scenes = Folder::with_scenes();
        folder.write(name, scenes.read(name));
    }
    assert_eq!(
        folder
            .volref(&["render", "scene.toml", "-o", "image.exr"])
            .code,
        0
    );
    folder.write("plain", "a file");
    let before = folder.files();
    let commands: &[(&[&str], &str, &str)] = &[
        (&["render", "scene.toml"], "--output=", "exr"),
        (&["render", "scene.toml"], "--output=", "png"),
        (&["compare", "image.exr", "image.exr"], "--heatmap=", "png"),
        (&["verify", "curve"], "--json=", "json"),
        (&["verify", "curve"], "--junit=", "xml"),
        (&["list"], "--json=", "json"),
        (&["plan", "scene.toml"], "--json=", "json"),
        (&["compare", "image.exr", "image.exr"], "--json=", "json"),
    ];
    for (command, option, extension) in commands {
        for (place, parts) in [
            ("nowhere/out", &["nowhere"][..]),
            // A path below a regular file is unwritable for everybody, root included.
            ("plain/out", &["plain"]),
        ] {
            let path = format!("{place}.{extension}");
            let run = folder.volref(&[*command, &[&format!("{option}{path}")]].concat());
            run.expect(2, &[&format!("cannot write {path}: "), "help: "]);
            run.expect(2, parts);
            assert_eq!(folder.files(), before, "{command:?} {option}{path}");
        }
        let path = format!("{option}fixtures/{}.{extension}", "x".repeat(300));
        let run = folder.volref(&[*command, &[&path]].concat());
        run.expect(2, &["cannot write fixtures/xxx"]);
        assert_eq!(folder.files(), before, "{command:?}");
    }
}

#[test]
fn a_folder_in_the_place_of_the_output() {
    let folder = Folder::with_scenes();
    folder.write("image.exr/inside", "kept");
    let before = folder.files();
    let run = folder.volref(&["render", "scene.toml", "-o", "image.exr"]);
    run.expect(2, &["cannot write image.exr: it is a folder"]);
    let run = folder.volref(&["plan", "scene.toml", "--json=image.exr"]);
    run.expect(2, &["cannot write image.exr"]);
    assert_eq!(folder.files(), before);
}

#[test]
fn extensions_that_stand_for_no_image() {
    let folder = Folder::with_scenes();
    for output in ["image.jpg", "image", "image.exr.gz", ".exr", "exr"] {
        let run = folder.volref(&["render", "scene.toml", "-o", output]);
        run.expect(2, &[output, ".exr", ".png"]);
        assert!(!folder.path(output).exists());
    }
    folder.volref(&["render", "scene.toml", "-o", "image.exr"]);
    let run = folder.volref(&["compare", "image.exr", "image.exr", "--heatmap", "map.exr"]);
    run.expect(2, &["--heatmap", "map.exr", ".png"]);
    assert!(!folder.path("map.exr").exists());
}

#[test]
fn exposures_that_are_no_number() {
    let folder = Folder::with_scenes();
    for exposure in ["nan", "inf", "-inf"] {
        let option = format!("--exposure={exposure}");
        let run = folder.volref(&["render", "scene.toml", "-o", "image.png", &option]);
        run.expect(2, &["exposure", "from -64 to 64"]);
    }
    assert!(!folder.path("image.png").exists());
}

#[test]
fn json_has_one_form() {
    let folder = Folder::with_goldens();
    for command in ["verify", "selftest", "list"] {
        folder
            .volref(&[command, "--json", "results.json"])
            .expect(5, &["no case matches", "--json=results.json"]);
    }
    folder
        .volref(&["verify", "results.xml"])
        .expect(5, &["no case matches", "--junit results.xml"]);
}

#[test]
fn failures_are_json_where_json_is_asked_for() {
    let folder = Folder::with_goldens();
    for (arguments, exit_code, said) in [
        (&["plan", "absent.toml", "--json"][..], 2, "absent.toml"),
        (&["verify", "absent", "--json"], 5, "no case matches"),
        (&["render", "--json"], 2, "required arguments"),
    ] {
        let run = folder.volref(arguments);
        assert_eq!(run.code, exit_code);
        let error = run.json();
        assert_eq!(error["schema"], "volref/error/1");
        assert_eq!(error["exit_code"], exit_code);
        assert!(error["error"].as_str().unwrap().contains(said), "{error}");
        assert!(run.stderr.contains(said), "{}", run.stderr);
    }
    let written = folder.volref(&["plan", "absent.toml", "--json=plan.json"]);
    assert_eq!(written.stdout, "");
    assert!(!folder.path("plan.json").exists());
}
