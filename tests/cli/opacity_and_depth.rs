//! Opacity and depth of other renderers' images.

use crate::folder::{Folder, ROOM, Run};
use volref::film::Film;

const CASE: &str = "smoke/plain";
const SCENE: &str = "fixtures/scenes/smoke/plain.toml";

/// The folder of a suite whose case asks for opacity and for a depth.
fn asking(depth: &str) -> Folder {
    let folder = Folder::with_suite();
    // Opaque enough for half of the light to be lost.
    folder.edit(SCENE, "0.2 voxels", "0.01 voxels");
    let manifest = "fixtures/cases/smoke/plain.toml";
    let text = String::from_utf8(folder.read(manifest)).unwrap();
    folder.write(
        manifest,
        format!("opacity = true\ndepth = \"{depth}\"\n{text}"),
    );
    folder.accept_all();
    folder
}

fn rendered(folder: &Folder, more: &[&str]) -> Film {
    let command = [&["render", SCENE, "-o", "right.exr"], more].concat();
    folder.volref(&command).expect(0, "");
    folder.film("right.exr")
}

/// Fails unless the command ended with `code` and prints all the `parts`.
fn prints(run: &Run, code: i32, parts: &[&str]) {
    assert_eq!(run.code, code, "{}\n{}", run.message(), run.stdout);
    let printed: Vec<&str> = run.stdout.split_whitespace().collect();
    let printed = printed.join(" ");
    for part in parts {
        assert!(printed.contains(part), "{part:?} is not in: {printed}");
    }
}

fn validate(folder: &Folder, film: &Film, more: &[&str]) -> Run {
    folder.write_film("out/smoke/plain.exr", film);
    folder.volref(&[&["validate", CASE, "--outputs", "out"], more].concat())
}

#[test]
fn opacity_that_is_wrong_is_named() {
    let folder = asking("mean");
    let right = rendered(&folder, &[]);
    prints(
        &validate(&folder, &right, &[]),
        0,
        &["the case asks for mean depth as well, and the image has none"],
    );
    for name in [
        "opaque-background",
        "opacity-not-written",
        "transmittance-for-opacity",
        "opacity-blended-by-itself",
    ] {
        let wrong = right.clone().map_opacity(|opacity| match name {
            "opaque-background" => 1.0,
            "opacity-not-written" => 0.0,
            "transmittance-for-opacity" => 1.0 - opacity,
            _ => opacity * opacity,
        });
        let run = validate(&folder, &wrong, &[]);
        let looks_like = format!("looks like {name} (1 of 1 case)");
        prints(&run, 1, &["the colours agree; the opacity of", &looks_like]);
    }
    let run = validate(
        &folder,
        &right.clone().map_opacity(|opacity| 0.8 * opacity),
        &[],
    );
    prints(
        &run,
        1,
        &["the colours are right: the difference is in opacity alone"],
    );
    assert!(!run.stdout.contains("looks like"), "{}", run.stdout);
    prints(
        &validate(&folder, &right.without_opacity(), &[]),
        0,
        &["the image has no fourth channel"],
    );
}

/// A case that does not ask takes a channel of one value for one that nobody wrote.
#[test]
fn a_channel_of_one_value_counts_only_where_it_is_asked_for() {
    let folder = Folder::with_goldens();
    let right = rendered(&folder, &[]);
    for value in [0.0, 1.0] {
        let written = right.clone().map_opacity(|_| value);
        validate(&folder, &written, &[]).expect(0, "");
    }
    let halved = right.map_opacity(|opacity| 0.5 * opacity);
    prints(
        &validate(&folder, &halved, &["--explain", "0"]),
        1,
        &["the colours agree"],
    );
}

#[test]
fn colours_without_their_background_are_declared() {
    let folder = Folder::with_goldens();
    let text = String::from_utf8(folder.read(SCENE)).unwrap();
    let bright = text.replace(
        "[classified]\n",
        "[classified]\nbackground = [0.25, 0.5, 0.75]\n",
    );
    assert_ne!(bright, text);
    folder.write(SCENE, bright);
    folder
        .volref(&["accept", CASE, "--reason", "A background"])
        .expect(0, "");
    let right = rendered(&folder, &[]);
    let opacity = right.opacity().unwrap().to_vec();
    let pixels = |straight: bool| {
        let alone = right.radiance().iter().zip(&opacity).map(|(pixel, &a)| {
            let scale = if straight && a > 0.0 { a } else { 1.0 };
            let [r, g, b] =
                [0, 1, 2].map(|c| (pixel[c] - (1.0 - a) * [0.25, 0.5, 0.75][c]) / scale);
            [r, g, b, a]
        });
        Film::with_opacity(right.width(), right.height(), alone.collect())
    };
    for (name, film) in [("premultiplied", pixels(false)), ("straight", pixels(true))] {
        validate(&folder, &film, &["--alpha", name]).expect(0, "");
        let profile = format!("name = \"mine\"\nalpha = \"{name}\"\n");
        folder.write("mine.toml", profile);
        validate(&folder, &film, &["--as", "mine.toml"]).expect(0, "");
        let said = format!("the image agrees where that is declared with --alpha {name}");
        // A declaration explains the image: nothing else is named.
        let run = validate(&folder, &film, &[]);
        prints(&run, 1, &[&said]);
        assert!(!run.stdout.contains("looks like"), "{}", run.stdout);
        // Every value rounded to a code, as display buffers hold them.
        let code = |value: f32| (255.0 * value).round() / 255.0;
        let codes: Vec<[f32; 4]> = (0..film.radiance().len())
            .map(|index| film.pixel(index).map(code))
            .collect();
        let codes = Film::with_opacity(film.width(), film.height(), codes);
        validate(&folder, &codes, &["--alpha", name, "--bits", "8-linear"]).expect(0, "");
    }
    // What is no number in the fourth channel alone has no cause in noise.
    let nan = right
        .radiance()
        .iter()
        .map(|&[r, g, b]| [r, g, b, f32::NAN]);
    let nan = Film::with_opacity(right.width(), right.height(), nan.collect());
    let run = validate(&folder, &nan, &[]);
    assert_eq!(run.code, 1);
    assert!(!run.stdout.contains("at this noise"), "{}", run.stdout);
    let without = right.clone().without_opacity();
    let run = validate(&folder, &without, &["--alpha", "straight"]);
    prints(
        &run,
        4,
        &["the image has no opacity, and --alpha straight is declared"],
    );
    validate(&folder, &right, &["--alpha", "masked"]).expect(2, "premultiplied or straight");
}

#[test]
fn depth_is_judged_where_it_is_asked_for() {
    let folder = asking("half-along-view");
    let right = rendered(&folder, &["--depth=half-along-view"]);
    validate(&folder, &right, &[]).expect(0, "");
    let plain = rendered(&folder, &["--depth=half-along-view", "--reference"]);
    validate(&folder, &plain, &[]).expect(0, "");
    let other = rendered(&folder, &["--depth"]);
    let said = "it is the mean depth, but the case asks for the half-along-view one";
    prints(
        &validate(&folder, &other, &[]),
        1,
        &["the image agrees; the depth of", said],
    );
    let depth = right.depth().unwrap().iter().map(|t| 1.2 * t).collect();
    let run = validate(&folder, &right.clone().with_depth(depth), &[]);
    let said = [
        "is off by more than half a step and 0.1 %",
        "write distances from the eye",
    ];
    prints(&run, 1, &said);
    // Beside an array.
    folder
        .volref(&[
            "render",
            SCENE,
            "-o",
            "out/smoke/plain.npy",
            "--depth=half-along-view",
        ])
        .expect(0, "");
    folder.remove("out/smoke/plain.exr");
    let run = folder.volref(&["validate", CASE, "--outputs", "out", "--json"]);
    assert_eq!(run.json()["cases"][0]["metrics"]["outlier_depths"], 0.0);
    run.expect(0, "");
}

#[test]
fn depth_that_cannot_be_had_is_refused() {
    let folder = asking("mean");
    let render = |more: &[&str]| folder.volref(&[&["render", SCENE], more].concat());
    render(&["-o", "a.png", "--depth"]).expect(2, "a .png holds no distances … channel Z");
    render(&["-o", "a.exr", "--depth=deep"]).expect(2, "a depth is one of mean, half");
    folder.write("room.toml", ROOM.replace("= 256", "= 8"));
    folder
        .volref("render room.toml -o a.exr --depth --spp 2")
        .expect(2, "depth is that of a classified volume");
    folder.edit(
        SCENE,
        "[classified]\n",
        "[classified]\nmode = \"maximum\"\n",
    );
    render(&["-o", "a.exr", "--depth"]).expect(2, "a projection has no depth");
    let manifest = "fixtures/cases/smoke/plain.toml";
    let text = String::from_utf8(folder.read(manifest)).unwrap();
    folder.write(
        manifest,
        text.replace("depth = \"mean\"", "depth = \"means\""),
    );
    folder.volref("list").expect(2, "depth … mean-along-view");
}
