//! `volref plan`

use crate::folder::{Folder, Run, root, tables_in};
use std::path::{Path, PathBuf};

/// Plans kept as text, one for each kind of estimator.
const WHOLE_PLANS: [&str; 5] = [
    "figures/figure-5",
    "fog/rate-0.1",
    "known-answers/emitting-slab",
    "limit/plume",
    "smoke/cornell",
];

/// The plan of every scene of the suite as `volref plan` prints it from the root of the repository: a hash a scene,
/// and the text of [five](WHOLE_PLANS). After an intended change, compare the printed plans of two builds, then
/// take the hashes over with `INSTA_UPDATE=always cargo test --test cli plans_of_the_suite`.
#[test]
fn plans_of_the_suite() {
    let plan = |scene: &Path| {
        let name = scene.strip_prefix(root()).unwrap().to_str().unwrap();
        let folder = Folder::new();
        let mut command = folder.command(&["plan", name]);
        let run = Run::of(command.current_dir(root()).output().unwrap());
        run.expect(0, "");
        run.stdout
    };
    let scenes = tables_in("scenes");
    assert!(scenes.len() >= 100);
    let plans: Vec<String> = std::thread::scope(|threads| {
        let plans_of = |scenes: &[PathBuf]| scenes.iter().map(|scene| plan(scene)).collect();
        let running: Vec<_> = (scenes.chunks(scenes.len().div_ceil(2)))
            .map(|half| threads.spawn(move || -> Vec<String> { plans_of(half) }))
            .collect();
        (running.into_iter())
            .flat_map(|half| half.join().unwrap())
            .collect()
    });
    let mut hashes = String::new();
    let mut whole = 0;
    for (scene, plan) in scenes.iter().zip(&plans) {
        let name = scene.strip_prefix(root().join("fixtures/scenes")).unwrap();
        let name = name.with_extension("").to_str().unwrap().to_owned();
        let hash = blake3::hash(plan.as_bytes()).to_hex();
        hashes += &format!("{} {name}\n", &hash[..16]);
        if WHOLE_PLANS.contains(&name.as_str()) {
            whole += 1;
            insta::assert_snapshot!(name.replace('/', "_"), plan);
        }
    }
    assert_eq!(whole, WHOLE_PLANS.len());
    insta::assert_snapshot!("hashes_of_plans", hashes);
}

/// Everything that stands in the text stands in the JSON.
#[test]
fn json() {
    let folder = Folder::with_scenes();
    let run = folder.volref("plan curve.toml --json");
    assert_eq!(run.code, 0);
    insta::assert_snapshot!(run.stdout);
}

#[test]
fn json_of_a_volume() {
    let folder = Folder::with_scenes();
    let json = folder.volref("plan scene.toml --json --counters").json();
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
    let counters = panel["counters"].as_object().unwrap();
    assert!(counters["density_lookups"].as_u64().unwrap() > 0);
    assert_eq!(counters["shadow_rays"], 0);
    assert_eq!(counters["gradient_lookups"], 0);
}

#[test]
fn counters() {
    let folder = Folder::with_scenes();
    let run = folder.volref("plan scene.toml --counters");
    let work = &run.stdout[run.stdout.find("\nwork (").unwrap()..];
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
    insta::assert_snapshot!(folder.volref("plan flat.toml --counters").shown());
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
    let run = folder.volref("plan idle.toml");
    run.expect(0, "");
    let section = run
        .stdout
        .split("\n\n")
        .find(|part| part.starts_with("warnings"));
    insta::assert_snapshot!(section.unwrap());
    let json = folder.volref("plan idle.toml --json").json();
    let warnings = json["panels"][0]["warnings"].as_array().unwrap();
    assert_eq!(warnings.len(), 4);
    assert_eq!(warnings[0]["field"], "radiative.scattering");
    assert_eq!(warnings[0]["line"], 9);
    let made = folder.volref("render idle.toml -o idle.exr");
    let notes: Vec<_> = made
        .stdout
        .lines()
        .filter(|line| line.starts_with("note: "))
        .collect();
    assert_eq!(notes.len(), 4);
    assert!(
        notes[0].contains("scattering has no effect: no medium scatters"),
        "{}",
        notes[0]
    );
    let json = folder.volref("render idle.toml -o idle.exr --json").json();
    assert_eq!(json["warnings"].as_array().unwrap(), warnings);
    // Left out, all is as before, and there is no warning.
    let quiet = scene
        .replace("scattering = \"multiple\"\nmax_bounces = 5\n", "")
        .replace("g = 0.5\n", "");
    let quiet = quiet.split("[[radiative.medium]]\nsphere = { centre = [0, 0, 0], radius = 2 }");
    folder.write("quiet.toml", quiet.clone().next().unwrap());
    let run = folder.volref("plan quiet.toml");
    run.expect(0, "");
    assert!(!run.stdout.contains("warnings"), "{}", run.stdout);
}

/// Values that nothing shows, and clips that cut nothing, are said before and after rendering.
#[test]
fn what_is_not_seen() {
    let folder = Folder::with_scenes();
    let grid = "[film]\nwidth = 4\nheight = 4\n[classified]\n{keys}\n[classified.volume]\nfield = \"ramp\"\n\
                nodes = [3, 3, 3]\nslope = [0, 0, 1]\nvalue = 1\n";
    for (keys, warning, note) in [
        (
            "mode = \"isosurface\"\nisosurface = [{ value = 7, colour = 1 }, { value = 2, colour = 1 }]",
            "no ray meets the surface of the value 7: the values of the volume go from 1 to 3",
            "",
        ),
        (
            "mode = \"isosurface\"\nisosurface = [{ value = 7, colour = 1 }]",
            "no ray meets the surface of the value 7: the values of the volume go from 1 to 3",
            "the image is black: no isosurface with an opacity parts the values of the volume, from 1 to 3",
        ),
        (
            "mode = \"isosurface\"\nisosurface = [{ value = 2, colour = 1 }]\nstep = 9",
            "",
            "the image is black",
        ),
        (
            "mode = \"mean\"\nwindow = { low = 3, high = 4 }",
            "all is black: the window begins at 3, and the values of the volume go from 1 to 3",
            "the image is black",
        ),
        (
            "mode = \"maximum\"\nwindow = { low = -1, high = 0 }",
            "all is white: the window ends at 0, and the values of the volume go from 1 to 3",
            "",
        ),
        ("mode = \"sum\"\nwindow = { low = 3, high = 8 }", "", ""),
        ("mode = \"maximum\"\nwindow = { low = 2, high = 8 }", "", ""),
    ] {
        folder.write("values.toml", grid.replace("{keys}", keys));
        let run = folder.volref("plan values.toml");
        run.expect(0, "");
        assert_eq!(
            run.stdout.contains("warnings"),
            !warning.is_empty(),
            "{keys}"
        );
        assert!(run.stdout.contains(warning), "{keys}: {}", run.stdout);
        let run = folder.volref("render values.toml -o values.exr");
        run.expect(0, "");
        assert!(run.stdout.contains(warning), "{keys}: {}", run.stdout);
        assert_eq!(
            run.stdout.contains("image is black"),
            !note.is_empty(),
            "{keys}"
        );
        assert!(run.stdout.contains(note), "{keys}: {}", run.stdout);
    }
}

/// A scene of some bytes may hold a volume of gigabytes.
#[test]
fn memory_of_volumes() {
    let folder = Folder::with_scenes();
    folder.edit("scene.toml", "resolution = 8", "resolution = 64");
    let run = folder.volref("plan scene.toml --json").json();
    let nodes = run["panels"][0]["volume"]["nodes"]
        .as_array()
        .unwrap()
        .iter();
    let nodes: u64 = nodes.map(|nodes| nodes.as_u64().unwrap()).product();
    assert_eq!(run["volume_bytes"], 4 * nodes);
    // One volume of two panels.
    let text = folder.text("scene.toml");
    folder.write("scene.toml", format!("{text}[[panel]]\n[[panel]]\n"));
    let run = folder.volref("plan scene.toml --json").json();
    assert_eq!(run["volume_bytes"], 4 * nodes);
    let text = folder.volref("plan scene.toml").stdout;
    assert!(text.contains("\nvolumes    "), "{text}");
    assert_eq!(
        folder.volref("plan curve.toml --json").json()["volume_bytes"],
        0
    );
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
