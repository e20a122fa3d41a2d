//! Scenes with mistakes: what, where, and how to mend it.

use crate::folder::{Folder, assert_shown};

/// The scene of [`Folder::with_scenes`] after one edit, and what is said about it.
fn after(old: &str, new: &str) -> String {
    let folder = Folder::with_scenes();
    folder.edit("scene.toml", old, new);
    let before = folder.files();
    let run = folder.volref(&["render", "scene.toml", "-o", "image.exr"]);
    assert_eq!(run.code, 2, "{new:?}: {}{}", run.stdout, run.stderr);
    assert_eq!(run.stdout, "");
    assert_eq!(folder.files(), before, "{new:?}: nothing is written");
    format!("{}\n", run.message())
}

/// What a user sees.
#[test]
fn an_error_as_it_is_drawn() {
    let folder = Folder::with_scenes();
    folder.edit("scene.toml", "width = 12", "widht = 12");
    assert_shown!(folder.volref(&["plan", "scene.toml"]).shown(), @"");
}

#[test]
fn unknown_keys() {
    let mut said = String::new();
    for (old, new) in [
        ("height = 10", "hieght = 10"),
        ("[transfer_function]", "[transferfunction]"),
        ("[classified]", "[classified]\ninterpolaton = \"nearest\""),
        ("[classified]", "[classified.shading]\n[classified]"),
        ("[classified]", "[camera]\nfov = 45\n[classified]"),
        ("[classified]", "[[panel]]\n[panel.film]\nwidht = 3\n[classified]"),
    ] {
        said.push_str(&after(old, new));
    }
    assert_shown!(said, @"");
}

#[test]
fn wrong_types() {
    let mut said = String::new();
    for (old, new) in [
        ("width = 12", "width = \"12\""),
        ("width = 12", "width = 12.0"),
        ("width = 12", "width = [12]"),
        ("[film]\nwidth = 12\nheight = 10", "film = 12"),
        ("[film]\nwidth = 12\nheight = 10", "[[film]]\nwidth = 12"),
        ("\"0.2 voxels\"", "true"),
        ("\"0.2 voxels\"", "\"0.2 pixels\""),
        ("[classified]", "[classified]\ninterpolation = 1"),
        ("[classified]", "[classified]\ninterpolation = \"cubic\""),
        ("[classified]", "[classified]\nbackground = 0"),
        ("[classified]", "[classified]\nbackground = [0, 0]"),
        ("[classified]", "[classified]\nbackground = [0, 0, \"0\"]"),
        ("[classified]", "[camera]\nvertical_fov = \"45\"\n[classified]"),
        ("\"cloud.obj\"", "1"),
        ("[film]", "panel = 1\n[film]"),
        ("[film]", "panel = []\n[film]"),
        ("[film]", "panel = [1]\n[film]"),
        ("[film]", "panel = [{ panel = [] }]\n[film]"),
    ] {
        said.push_str(&after(old, new));
    }
    assert_shown!(said, @"");
}

#[test]
fn out_of_range() {
    let mut said = String::new();
    for (old, new) in [
        ("width = 12", "width = 0"),
        ("width = 12", "width = -1"),
        ("width = 12", "width = 16385"),
        ("width = 12", "width = 99999999999999999999"),
        ("\"0.2 voxels\"", "0"),
        ("\"0.2 voxels\"", "\"-1 voxels\""),
        ("\"0.2 voxels\"", "inf"),
        ("[classified]", "[classified]\nstep = 0"),
        ("[classified]", "[classified]\nstep = -0.5"),
        ("[classified]", "[classified]\nstep = nan"),
        ("[classified]", "[classified]\nstep = 1e-300"),
        ("[classified]", "[classified]\nstep = \"1e-12 voxels\""),
        ("[classified]", "[classified]\nbackground = [0, -1, 0]"),
        ("[classified]", "[classified]\nbackground = [0, inf, 0]"),
        ("[classified]", "[classified]\n[classified.phong]\nambient = -0.1"),
        ("[classified]", "[classified]\n[classified.phong]\nshininess = 0"),
        ("[classified]", "[camera]\nvertical_fov = 0\n[classified]"),
        ("[classified]", "[camera]\nvertical_fov = 180\n[classified]"),
        ("reference_length = \"0.2 voxels\"", "floor = 1"),
        ("reference_length = \"0.2 voxels\"", "floor = nan"),
        ("resolution = 8", "resolution = 1"),
        ("resolution = 8", "resolution = 3"),
        ("resolution = 8", "resolution = 4097"),
        ("padding = 1", "padding = -1"),
    ] {
        said.push_str(&after(old, new));
    }
    assert_shown!(said, @"");
}

#[test]
fn missing_and_contradictory() {
    let mut said = String::new();
    for (old, new) in [
        ("file = \"cloud.obj\"\n", ""),
        ("[classified.volume]\nfile = \"cloud.obj\"\nresolution = 8\npadding = 1\n", ""),
        ("[classified]", "[classified]\n[classified.shadow]\nstep = 1"),
        ("[classified]", "[curve]\n[classified]"),
        (
            "[classified]\n\n[classified.volume]\nfile = \"cloud.obj\"\nresolution = 8\npadding = 1\n",
            "",
        ),
        ("cloud.obj", "cloud.bin"),
        ("[classified]", "[camera]\neye = [1, 2, 3]\ntarget = [1, 2, 3]\n[classified]"),
        (
            "[classified]",
            "[camera]\neye = [0, 0, 0]\ntarget = [0, 1, 0]\nup = [0, 2, 0]\n[classified]",
        ),
        ("[classified]", "[camera]\nup = [0, 0, 0]\n[classified]"),
        ("[classified]", "[[panel]]\n[[panel]]\nfilm.height = 4\n[classified]"),
    ] {
        said.push_str(&after(old, new));
    }
    assert_shown!(said, @"");
}

#[test]
fn a_plot_of_the_curve_has_no_volume() {
    let folder = Folder::with_scenes();
    let mut said = String::new();
    for more in ["[camera]\n", "[transfer_function]\ncolormap = \"heat\"\n"] {
        folder.write("broken.toml", crate::folder::CURVE.to_owned() + more);
        said.push_str(&(folder.volref(&["plan", "broken.toml"]).message() + "\n"));
    }
    let run = folder.volref(&["render", "curve.toml", "-o", "image.exr", "--step", "1"]);
    said.push_str(&run.message());
    assert_shown!(said, @"");
}

#[test]
fn not_toml() {
    let mut said = String::new();
    for (old, new) in [
        ("width = 12", "width = "),
        ("width = 12", "width = 12\nwidth = 13"),
        ("width = 12", "width 12"),
        ("[film]", "[film"),
        ("\"cloud.obj\"", "\"cloud.obj"),
    ] {
        said.push_str(&after(old, new));
    }
    assert_shown!(said, @"");
}

#[test]
fn not_text() {
    let folder = Folder::new();
    folder.write("scene.toml", b"title = \"caf\xe9\"\n");
    let run = folder.volref(&["plan", "scene.toml"]);
    run.expect(2, &["scene.toml", "not UTF-8"]);
    folder.write("empty.toml", "");
    let run = folder.volref(&["plan", "empty.toml"]);
    run.expect(2, &["empty.toml", "no model: give [classified] or [curve]"]);
}

/// A byte order mark and Windows line ends are no mistakes, and places stay right.
#[test]
fn text_from_windows() {
    let folder = Folder::with_scenes();
    let windows = |text: String| format!("\u{feff}{}", text.replace('\n', "\r\n"));
    folder.write("windows.toml", windows(folder.text("scene.toml")));
    assert_eq!(folder.volref(&["plan", "windows.toml"]).code, 0);
    folder.edit("windows.toml", "width = 12", "width = 0");
    folder.volref(&["plan", "windows.toml"]).expect(2, &["windows.toml:2:9: `width` must lie"]);
}

/// Columns count characters, as editors do.
#[test]
fn places_after_letters_of_several_bytes() {
    let folder = Folder::with_scenes();
    let text = "film = { \"héllo, wörld\" = 1 }\n".to_owned() + &folder.text("curve.toml")[29..];
    folder.write("scene.toml", text);
    folder.volref(&["plan", "scene.toml"]).expect(2, &["scene.toml:1:10: unknown key"]);
    folder.write("scene.toml", "# é\n[curve]\ndensities = { ä = 1, densities = 2 }\n");
    folder.volref(&["plan", "scene.toml"]).expect(2, &["scene.toml:3:13: `densities` takes"]);
}

#[test]
fn no_such_scene() {
    let folder = Folder::with_scenes();
    folder.write("folder/scene.toml", "");
    for command in ["plan", "render"] {
        let output: &[&str] = if command == "render" { &["-o", "image.exr"] } else { &[] };
        let run = |scene| folder.volref(&[&[command, scene], output].concat());
        run("none.toml").expect(2, &["none.toml: cannot read the scene", "give the path"]);
        run("folder").expect(2, &["folder: this is a folder, not a scene file"]);
        run("cloud.obj/x").expect(2, &["cloud.obj/x: cannot read the scene"]);
        run("cloud.obj").expect(2, &["cloud.obj:1:3", "not valid TOML"]);
    }
}

#[test]
fn steps_on_the_command_line() {
    let folder = Folder::with_scenes();
    let mut said = String::new();
    for step in [
        &["--step", "0"][..],
        &["--step=0"],
        &["--step", "-1"],
        &["--step=-1"],
        &["--step", "-0.5 voxels"],
        &["--step", "nan"],
        &["--step", "inf"],
        &["--step", "half"],
        &["--step", ""],
        &["--step", "1e-300"],
        &["--step", "1e-12voxels"],
    ] {
        let run = folder.volref(&[&["render", "scene.toml", "-o", "image.exr"], step].concat());
        assert_eq!(run.code, 2, "{step:?}");
        said.push_str(&(run.message() + "\n"));
    }
    assert!(!folder.path("image.exr").exists());
    assert_shown!(said, @"");
}
