//! `volref plan`

use crate::folder::{Folder, Run};
use std::path::{Path, PathBuf};

/// The plan of every scene of the suite, as anybody can ask for it from the root of the repository:
/// a file for each family. After a change on purpose, read the difference and take it over with
/// `INSTA_UPDATE=always cargo test --test cli plans_of_the_suite`.
#[test]
fn plans_of_the_suite() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let entries = |folder: &Path| {
        let entries = std::fs::read_dir(folder).unwrap();
        let mut paths: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        paths
    };
    let plan = |scene: &Path| {
        let scene = scene
            .strip_prefix(root)
            .unwrap()
            .to_str()
            .unwrap()
            .to_owned();
        let folder = Folder::new();
        let mut command = folder.command(&["plan", &scene]);
        let run = Run::of(command.current_dir(root).output().unwrap());
        run.expect(0, &[]);
        format!("$ volref plan {scene}\n{}", run.stdout)
    };
    let families = entries(&root.join("fixtures/scenes"));
    assert!(families.len() >= 5);
    for family in families {
        let mut scenes = entries(&family);
        scenes.retain(|scene| {
            scene
                .extension()
                .is_some_and(|extension| extension == "toml")
        });
        let plans: Vec<String> = std::thread::scope(|threads| {
            let half = scenes.len().div_ceil(2);
            let halves = scenes.chunks(half.max(1));
            let run = |scenes: &[PathBuf]| scenes.iter().map(|scene| plan(scene)).collect();
            let running: Vec<_> = halves
                .map(|scenes| threads.spawn(move || -> Vec<String> { run(scenes) }))
                .collect();
            running
                .into_iter()
                .flat_map(|half| half.join().unwrap())
                .collect()
        });
        let name = family.file_name().unwrap().to_str().unwrap();
        insta::assert_snapshot!(format!("suite_{name}"), plans.concat());
    }
}

/// Everything that stands in the text stands in the JSON.
#[test]
fn json() {
    let folder = Folder::with_scenes();
    let run = folder.volref(&["plan", "curve.toml", "--json"]);
    assert_eq!(run.code, 0);
    insta::assert_snapshot!(run.stdout);
}

#[test]
fn json_of_a_volume() {
    let folder = Folder::with_scenes();
    let json = folder
        .volref(&["plan", "scene.toml", "--json", "--counters"])
        .json();
    assert_eq!(json["schema"], "volref/plan/1");
    let panel = &json["panels"][0];
    let effects = panel["effects"].as_array().unwrap();
    assert_eq!(effects.len(), 11);
    let shadow = effects
        .iter()
        .find(|effect| effect["effect"] == "medium-shadow")
        .unwrap();
    assert_eq!(shadow["state"], "omitted");
    assert_eq!(shadow["field"], "classified.shadow");
    assert_eq!(shadow["line"], serde_json::Value::Null);
    let volume = effects
        .iter()
        .find(|effect| effect["effect"] == "heterogeneity")
        .unwrap();
    assert_eq!(volume["line"], 10);
    assert_eq!(panel["estimator"]["method"], "ray-casting");
    assert_eq!(panel["estimator"]["field"], "classified.step");
    assert_eq!(panel["rays"], 120);
    assert_eq!(panel["expected"]["shadow_rays"]["bound"], "exactly");
    assert_eq!(panel["expected"]["shadow_rays"]["count"], 0);
    assert_eq!(panel["expected"]["density_lookups"]["bound"], "at-most");
    assert!(
        panel["expected"]["density_lookups"]["count"]
            .as_f64()
            .unwrap()
            >= 520.0
    );
    let counters = panel["counters"].as_object().unwrap();
    assert!(counters["density_lookups"].as_u64().unwrap() > 0);
    assert_eq!(counters["shadow_rays"], 0);
    assert_eq!(counters["gradient_lookups"], 0);
}

/// Counts stand beside what was predicted.
#[test]
fn counters() {
    let folder = Folder::with_scenes();
    let run = folder.volref(&["plan", "scene.toml", "--counters"]);
    let work = &run.stdout[run.stdout.find("\nwork per ray").unwrap()..];
    insta::assert_snapshot!(work);
}

/// A grid of one density: shading and heterogeneity are provably null, and can be forced.
#[test]
fn force_on_a_constant_grid() {
    let folder = Folder::with_scenes();
    folder.write(
        "flat.bin",
        crate::bad_files::grid([3, 3, 3], [1.0; 3], &[0.5; 27]),
    );
    folder.write(
        "flat.toml",
        "[film]\nwidth = 6\nheight = 6\n[classified]\n[classified.phong]\n\
         [classified.volume]\nfile = \"flat.bin\"\n",
    );
    insta::assert_snapshot!(folder.volref(&["plan", "flat.toml", "--counters"]).shown());
    let alone = ["--force", "heterogeneity", "--force", "gradient-shading"];
    let forced = |how: &[&str]| {
        let command = [&["plan", "flat.toml", "--counters"], how].concat();
        folder.volref(&command).shown()
    };
    insta::assert_snapshot!(forced(&alone));
    assert_eq!(forced(&["--force", "all"]), forced(&alone));
}

/// A request that cannot matter is a warning, by `plan` and when the image is made.
#[test]
fn warnings() {
    let folder = Folder::new();
    let scene = "\
[film]
width = 4
height = 4
[camera]
eye = [0, 0, -3]
target = [0, 0, 0]
[radiative]
environment = 1
scattering = \"multiple\"
max_bounces = 5
[[radiative.medium]]
sphere = { centre = [0, 0, 0], radius = 1 }
sigma_t = 1
albedo = 0
g = 0.5
[[radiative.medium]]
sphere = { centre = [0, 0, 0], radius = 2 }
[[radiative.light]]
point = { position = [3, 3, 3], intensity = 1 }
";
    folder.write("idle.toml", scene);
    let run = folder.volref(&["plan", "idle.toml"]);
    run.expect(0, &[]);
    let section = run
        .stdout
        .split("\n\n")
        .find(|part| part.starts_with("warnings"));
    insta::assert_snapshot!(section.unwrap());
    let json = folder.volref(&["plan", "idle.toml", "--json"]).json();
    let warnings = json["panels"][0]["warnings"].as_array().unwrap();
    assert_eq!(warnings.len(), 5);
    assert_eq!(warnings[0]["field"], "radiative.scattering");
    assert_eq!(warnings[0]["line"], 9);
    let made = folder.volref(&["render", "idle.toml", "-o", "idle.exr"]);
    let notes: Vec<_> = made
        .stdout
        .lines()
        .filter(|line| line.starts_with("note: "))
        .collect();
    assert_eq!(notes.len(), 5);
    assert!(
        notes[0].contains("scattering has no effect: sigma_s is 0"),
        "{}",
        notes[0]
    );
    let json = folder
        .volref(&["render", "idle.toml", "-o", "idle.exr", "--json"])
        .json();
    assert_eq!(json["warnings"].as_array().unwrap(), warnings);
    // Left out, all is as before, and there is no warning.
    let quiet = scene
        .replace("scattering = \"multiple\"\nmax_bounces = 5\n", "")
        .replace("g = 0.5\n", "");
    let quiet = quiet.split("[[radiative.medium]]\nsphere = { centre = [0, 0, 0], radius = 2 }");
    folder.write("quiet.toml", quiet.clone().next().unwrap());
    let run = folder.volref(&["plan", "quiet.toml"]);
    run.expect(0, &[]);
    assert!(!run.stdout.contains("warnings"), "{}", run.stdout);
}

/// What is not there cannot be forced: that would be another picture.
#[test]
fn force_of_what_is_omitted_or_absent() {
    let folder = Folder::with_scenes();
    for (scene, effect, reason) in [
        (
            "scene.toml",
            "medium-shadow",
            "the scene has no [classified.shadow]",
        ),
        (
            "scene.toml",
            "gradient-shading",
            "the scene has no [classified.phong]",
        ),
        (
            "scene.toml",
            "surfaces",
            "the classified model has no surfaces",
        ),
        (
            "curve.toml",
            "emission",
            "a plot of the transfer function has no light",
        ),
    ] {
        let run = folder.volref(&["plan", scene, "--force", effect]);
        run.expect(2, &[effect, "would change the picture", reason]);
        assert_eq!(run.stdout, "");
    }
}

/// Of work under conventions as much is counted as is done, and no count is predicted that is not so.
#[test]
fn counters_under_conventions() {
    let folder = Folder::with_scenes();
    let shading = "[classified.phong]\n[classified.conventions]\nlast_step = \"whole\"\n";
    let scene = crate::folder::scene(shading).replace("../../volumes/", "");
    folder.write("other.toml", scene);
    let json = folder.volref(&["plan", "other.toml", "--counters", "--json"]);
    let panel = &json.json()["panels"][0];
    let kernel =
        "ray caster: trilinear, front to back, Phong, no shadow, every sample, other conventions";
    assert_eq!(panel["kernel"], kernel);
    let counters = panel["counters"].as_object().unwrap();
    for (event, count) in counters {
        let expected = &panel["expected"][event];
        let known = expected["bound"] == "exactly";
        assert!(
            !known || expected["count"] == *count,
            "{event}: {expected}, {count}"
        );
    }
    for event in ["density_lookups", "gradient_lookups", "gradients_computed"] {
        assert!(counters[event].as_u64().unwrap() > 0, "{event}");
    }
    assert_eq!(panel["expected"]["density_lookups"]["bound"], "unknown");
    let run = folder.volref(&["plan", "other.toml", "--counters"]);
    run.expect(0, &[]);
    let line = run
        .stdout
        .lines()
        .find(|line| line.contains("density lookups"));
    assert!(line.unwrap().contains("unknown"), "{line:?}");
}
