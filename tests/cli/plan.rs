//! `volref plan`

use crate::folder::{Folder, assert_shown};
use std::path::Path;

/// The plans of the figures, as anybody can ask for them from the root of the repository.
#[test]
fn figures() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let plan = |figure: &str| {
        let scene = format!("fixtures/scenes/figures/{figure}.toml");
        let folder = Folder::new();
        let mut command = folder.command(&["plan", &scene]);
        crate::folder::Run::of(command.current_dir(root).output().unwrap()).shown()
    };
    insta::assert_snapshot!(plan("figure-1"), @"");
    insta::assert_snapshot!(plan("figure-2"), @"");
    insta::assert_snapshot!(plan("figure-3"), @"");
    insta::assert_snapshot!(plan("figure-4"), @"");
    insta::assert_snapshot!(plan("figure-5"), @"");
}

#[test]
fn json() {
    let folder = Folder::with_scenes();
    let run = folder.volref(&["plan", "curve.toml", "--json"]);
    assert_eq!(run.code, 0);
    assert_shown!(run.stdout, @"");
}

#[test]
fn json_of_a_volume() {
    let folder = Folder::with_scenes();
    let json = folder.volref(&["plan", "scene.toml", "--json", "--counters"]).json();
    assert_eq!(json["schema"], "volref/plan/1");
    let panel = &json["panels"][0];
    let effects = panel["effects"].as_array().unwrap();
    assert_eq!(effects.len(), 11);
    let shadow = effects.iter().find(|effect| effect["effect"] == "medium-shadow").unwrap();
    assert_eq!(shadow["state"], "omitted");
    assert_eq!(shadow["field"], "classified.shadow");
    let counters = panel["counters"].as_object().unwrap();
    assert!(counters["density_lookups"].as_u64().unwrap() > 0);
    assert_eq!(counters["shadow_rays"], 0);
    assert_eq!(counters["gradient_lookups"], 0);
}

#[test]
fn counters() {
    let folder = Folder::with_scenes();
    let run = folder.volref(&["plan", "scene.toml", "--counters"]);
    let work = &run.stdout[run.stdout.find("\nwork\n").unwrap()..];
    insta::assert_snapshot!(work, @"");
}

/// A grid of one density: shading and heterogeneity are provably null, and can be forced.
#[test]
fn force_on_a_constant_grid() {
    let folder = Folder::with_scenes();
    folder.write("flat.bin", crate::bad_files::grid([3, 3, 3], [1.0; 3], &[0.5; 27]));
    folder.write(
        "flat.toml",
        "[film]\nwidth = 6\nheight = 6\n[classified]\n[classified.phong]\n\
         [classified.volume]\nfile = \"flat.bin\"\n",
    );
    insta::assert_snapshot!(folder.volref(&["plan", "flat.toml", "--counters"]).shown(), @"");
    let forced = ["plan", "flat.toml", "--counters", "--force", "heterogeneity", "--force",
        "gradient-shading"];
    insta::assert_snapshot!(folder.volref(&forced).shown(), @"");
}

/// What is not there cannot be forced: that would be another picture.
#[test]
fn force_of_what_is_omitted_or_absent() {
    let folder = Folder::with_scenes();
    for (scene, effect, reason) in [
        ("scene.toml", "medium-shadow", "the scene has no [classified.shadow]"),
        ("scene.toml", "gradient-shading", "the scene has no [classified.phong]"),
        ("scene.toml", "surfaces", "the classified model has no surfaces"),
        ("curve.toml", "emission", "a plot of the transfer function has no light"),
    ] {
        let run = folder.volref(&["plan", scene, "--force", effect]);
        run.expect(2, &[effect, "would change the picture", reason]);
        assert_eq!(run.stdout, "");
    }
}
