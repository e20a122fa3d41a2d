//! `volref cost`.

use crate::folder::{Folder, assert_holds, assert_shown};
use serde_json::Value;

/// A cloud that is rendered in no time: a grid of nine nodes a side, unlit.
const CLOUD: &str = "\
film = { width = 8, height = 8 }
camera = { eye = [0.5, 0.5, -2], target = [0.5, 0.5, 0.5], vertical_fov = 25 }

[transfer_function]
reference_length = 0.1

[classified]

[classified.volume]
file = \"cloud.toml\"
";

/// Bare samples: a bump in the middle of a box.
const SAMPLES: &str = "\
file = \"cloud.raw\"
type = \"float32\"
endian = \"little\"
nodes = [9, 9, 9]
spacing = 0.125
";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("cloud.scene.toml", CLOUD);
    folder.write("cloud.toml", SAMPLES);
    let bump = |i: usize| 16.0 - (i as f32 - 4.0) * (i as f32 - 4.0);
    let value = |i: usize| bump(i % 9) * bump(i / 9 % 9) * bump(i / 81) / 6000.0;
    let bytes: Vec<u8> = (0..729).flat_map(|i| value(i).to_le_bytes()).collect();
    folder.write("cloud.raw", bytes);
    folder
}

/// Two runs differ in times alone, and without times in nothing.
#[test]
fn the_same_on_every_run() {
    let folder = folder();
    let arguments = ["cost", "cloud.scene.toml", "--runs", "0", "--json"];
    let (first, second) = (folder.volref(&arguments), folder.volref(&arguments));
    assert_eq!(first.code, 0, "{}", first.stderr);
    assert_eq!(first.stdout, second.stdout);
    let value: Value = serde_json::from_str(&first.stdout).unwrap();
    assert_eq!(value["schema"], "volref/cost/1");
    assert!(!first.stdout.contains("\"median\""));
    let timed = folder.volref("cost cloud.scene.toml --runs 2 --json");
    let mut value: Value = serde_json::from_str(&timed.stdout).unwrap();
    let mut untimed: Value = serde_json::from_str(&first.stdout).unwrap();
    for value in [&mut value, &mut untimed] {
        forget_times(value);
    }
    assert_eq!(value, untimed);
}

/// Takes everything out that is a time, or tells of the machine.
fn forget_times(value: &mut Value) {
    match value {
        Value::Object(map) => {
            for key in ["time", "machine"] {
                map.remove(key);
            }
            map.values_mut().for_each(forget_times);
        }
        Value::Array(items) => items.iter_mut().for_each(forget_times),
        _ => {}
    }
}

#[test]
fn tables_and_a_page() {
    let folder = folder();
    let run = folder.volref("cost cloud.scene.toml --runs 2 --report out/page");
    run.prints(0, "for an error of 0.1 %: ");
    let page = folder.text("out/page/index.html");
    assert!(page.contains("<svg"), "plots");
    let names: Vec<String> = folder.files().into_keys().collect();
    let tables = names.iter().filter(|name| name.ends_with(".csv"));
    assert_eq!(tables.count(), 2, "{names:?}");
    assert!(
        names.contains(&"out/page/cloud.scene.svg".to_owned()),
        "{names:?}"
    );
}

#[test]
fn a_scene_without_a_parameter() {
    let folder = folder();
    folder.write(
        "fog.toml",
        "[film]\nwidth = 4\nheight = 4\n[camera]\neye = [0, 0, -4]\ntarget = [0, 0, 0]\n\
         [radiative]\nscattering = \"none\"\nenvironment = 1\n\
         [[radiative.medium]]\nsphere = { centre = [0, 0, 0], radius = 1 }\nsigma_a = 1\n",
    );
    let run = folder.volref("cost fog.toml --runs 0 --report out");
    assert_shown!(run.shown(), @r"
    exit code 2
    --- stderr
      × fog.toml: this scene has no parameter to vary: nothing in it is sampled, every pixel is a closed form or an integral
    ");
    assert!(!folder.files().keys().any(|name| name.starts_with("out/")));
}

#[test]
fn a_budget_that_is_too_small() {
    let folder = folder();
    let run = folder.volref("cost cloud.scene.toml --budget 0.000001");
    run.prints(0, "the budget was used up");
}

#[test]
fn what_is_no_budget() {
    let folder = folder();
    for budget in ["0", "-1", "nan", "inf", "soon"] {
        let budget = format!("--budget={budget}");
        let run = folder.volref(&["cost", "cloud.scene.toml", &budget]);
        assert_eq!(run.code, 2, "{budget}");
        assert_holds(&run.stderr, &["a positive number of seconds"]);
    }
    let run = folder.volref("cost cloud.scene.toml --runs 1");
    assert_holds(&run.stderr, &["one run has no spread"]);
}
