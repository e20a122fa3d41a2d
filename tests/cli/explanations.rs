//! What explains an image, of conventions, mistakes and profiles: the plainest.

use crate::folder::{Folder, MANIFEST, Run, copy};
use std::path::Path;
use volref::film::{Bits, Film};
use volref::suite::Suite;

/// Width and height of panels where all cases are rendered.
const PIXELS: usize = 8;

/// A scene of a ramp in a box, with opacities over a length of 1 at its values 0, 8 and 16.
fn ramp(camera: &str, [low, middle, high]: [f64; 3], step: &str, volume: &str) -> String {
    format!(
        r#"
[film]
width = 24
height = 24

[camera]
{camera}

[transfer_function]
reference_length = 1
point = [
    {{ value = 0, colour = [0.1, 0.3, 0.8], opacity = {low} }},
    {{ value = 8, colour = [0.9, 0.8, 0.3], opacity = {middle} }},
    {{ value = 16, colour = [0.8, 0.1, 0.1], opacity = {high} }},
]

[classified]
step = {step}

[classified.volume]
field = "ramp"
value = 0
nodes = [5, 5, 5]
{volume}
"#
    )
}

/// A ramp that is seen from its side.
fn from_the_side(opacities: [f64; 3], step: &str) -> String {
    let camera = "eye = [-3, -1.7, 1.2]\ntarget = [0, 0, 0]\nup = [0, 0, 1]\nvertical_fov = 40";
    let volume = "slope = [2, 1, 1]\nspacing = [0.5, 0.5, 0.5]\norigin = [-1, -1, -1]";
    ramp(camera, opacities, step, volume)
}

/// A ramp across the view, which is along its box of 1.3 steps.
fn facing() -> String {
    let camera =
        "eye = [0.3, -0.2, -40]\ntarget = [0.3, -0.2, 0]\nup = [0, 1, 0]\nvertical_fov = 3";
    let volume = "slope = [2, 2, 0]\nspacing = [0.5, 0.5, 0.325]\norigin = [-1, -1, -0.65]";
    ramp(camera, [0.05, 0.3, 0.8], "1", volume)
}

/// A suite of one case, `own/case`, with its golden.
fn with_case(scene: &str, class: &str) -> Folder {
    let folder = Folder::new();
    folder.write("fixtures/scenes/own/case.toml", scene);
    let manifest = MANIFEST.replace("deterministic", class);
    folder.write("fixtures/cases/own/case.toml", manifest);
    folder.accept_all();
    folder
}

/// The image of `scene`.
fn rendered(folder: &Folder, scene: &str, options: &str) -> Film {
    folder.write("scene.toml", scene);
    let run = folder.volref(&*format!("render scene.toml -o image.npy {options}"));
    run.expect(0, "");
    Film::from_npy(&folder.read("image.npy")).unwrap()
}

fn validated(folder: &Folder, options: &str) -> (Run, serde_json::Value) {
    let run = folder.volref(&*format!(
        "validate --outputs out --accept-conventions --json=r.json {options}"
    ));
    let case = folder.json("r.json")["cases"][0].clone();
    (run, case)
}

/// A ray of 1.3 steps that is fitted to two, each as opaque as a whole one, is as opaque as without a correction for the
/// step where the reference length is 2/1.3 steps: two conventions, or one mistake.
#[test]
fn one_mistake_goes_before_several_conventions() {
    let scene = facing().replace(
        "reference_length = 1",
        "reference_length = 1.5384615384615385",
    );
    let folder = with_case(&scene, "deterministic");
    let image = rendered(&folder, &facing(), "");
    folder.write_film("out/own/case.exr", &image);
    let profile = "name = 'mine'\n[conventions]\nfitted_steps = 'up'\nstep_opacity = 'nominal'\n";
    folder.write("mine.toml", profile);
    folder
        .volref("validate --outputs out --as mine.toml")
        .expect(0, "");
    let (run, case) = validated(&folder, "--explain 60");
    run.prints(1, "opacity-uncorrected");
    assert_eq!(case["verdict"], "fail", "{}", run.stdout);
    assert_eq!(case["looks_like"][0], "opacity-uncorrected");
    assert_eq!(case["search_ended"], true);
}

/// In thin haze all that is left of colours multiplied by opacity twice is faint, and of few codes.
#[test]
fn colours_multiplied_by_opacity_twice_in_thin_haze_are_no_convention() {
    let thin = from_the_side([0.002, 0.1, 0.33], "0.05");
    let haze = thin.replace("[classified]", "[classified]\ncompositing = \"continuous\"");
    let folder = with_case(&haze, "limit");
    let linear = "8-linear".parse::<Bits>().unwrap().of_png(0.0);
    for (suffix, step) in [("", 0.05), ("@0.5", 0.025), ("@0.25", 0.0125)] {
        let image = rendered(&folder, &haze, &format!("--step {step}"));
        let twice = (0..24 * 24).map(|index| {
            let [r, g, b, opacity] = image.pixel(index);
            [r, g, b, 1.0].map(|value| value * opacity)
        });
        let twice = linear.rounded(&Film::with_opacity(24, 24, twice.collect()));
        folder.write(&format!("out/own/case{suffix}.npy"), twice.to_npy());
    }
    let (run, case) = validated(
        &folder,
        "--alpha premultiplied --bits 8-linear --explain 60",
    );
    run.prints(1, "premultiplied-twice");
    assert_eq!(case["verdict"], "fail", "{}", run.stdout);
    assert_eq!(case["looks_like"][0], "premultiplied-twice");
}

/// The opaque ramp, `step` long, with volumes that fill half a voxel beyond their outermost nodes.
fn opaque_beyond_nodes(step: &str) -> [String; 2] {
    let scene = from_the_side([0.5, 0.5, 0.9], &format!("{step:?}"));
    let beyond = format!("{scene}\n[classified.conventions]\nbox = 'voxels'\n");
    [scene, beyond]
}

/// An exact integral has no step that a renderer may take half of: images with other steps than those asked for are that.
#[test]
fn no_step_is_claimed_of_an_exact_integral() {
    let [scene, beyond] = opaque_beyond_nodes("0.8");
    let exact = scene.replace("[classified]", "[classified]\ncompositing = \"continuous\"");
    let folder = with_case(&exact, "limit");
    for (suffix, step) in [("", 0.4), ("@0.5", 0.2), ("@0.25", 0.1)] {
        let image = rendered(&folder, &beyond, &format!("--step {step}"));
        folder.write_film(&format!("out/own/case{suffix}.exr"), &image);
    }
    let (run, case) = validated(&folder, "--explain 1");
    run.prints(1, "");
    assert_eq!(case["verdict"], "fail", "{}", run.stdout);
}

/// Between the images of the scene's step and of half of it there is no difference that the gate tells: beyond both of them is
/// no reason to claim the half. Where there is one, it is claimed.
#[test]
fn a_step_is_claimed_where_it_shows() {
    let claimed = |step: f64, times: f32| {
        let [scene, beyond] = opaque_beyond_nodes(&step.to_string());
        let folder = with_case(&scene, "deterministic");
        let half = rendered(&folder, &beyond, &format!("--step {}", step / 2.0));
        let whole = rendered(&folder, &beyond, "");
        let pixels = whole.radiance().iter().zip(half.radiance());
        let pixels =
            pixels.map(|(whole, half)| [0, 1, 2].map(|c| whole[c] + times * (half[c] - whole[c])));
        let film = Film::new(24, 24, pixels.collect());
        folder.write_film("out/own/case.exr", &film);
        let (run, case) = validated(&folder, "--explain 1");
        (
            run.code,
            case["reason"].to_string().contains("takes steps of"),
        )
    };
    assert_eq!(claimed(0.27, 2.0), (1, false));
    assert_eq!(claimed(0.8, 1.0), (0, true));
}

/// A black image under a profile by which nothing of a volume is seen: of all cases of volumes, in a few pixels, it passes
/// none.
#[test]
fn a_profile_that_leaves_nothing_passes_no_case() {
    let folder = Folder::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let suite = Suite::open(root).unwrap();
    for name in ["volumes", "meshes"] {
        copy(
            &root.join("fixtures").join(name),
            &folder.path("fixtures").join(name),
        );
    }
    for case in suite.cases() {
        let scene = std::fs::read_to_string(root.join(&case.scene)).unwrap();
        if !scene.contains("[classified]") {
            continue;
        }
        let small = |line: &str| match line.split_once(" = ") {
            Some((key @ ("width" | "height"), _)) => format!("{key} = {PIXELS}\n"),
            _ => format!("{line}\n"),
        };
        let scene: String = scene.lines().map(small).collect();
        let panels = scene.matches("[[panel]]").count().max(1);
        folder.write(&format!("fixtures/scenes/{}.toml", case.name), scene);
        let path = format!("fixtures/cases/{}.toml", case.name);
        let manifest = std::fs::read_to_string(root.join(&path)).unwrap();
        let class = manifest.lines().find(|line| line.starts_with("class = "));
        let stated = "class = \"deterministic\"";
        folder.write(&path, MANIFEST.replace(stated, class.unwrap_or(stated)));
        let width = PIXELS * panels;
        let black = Film::new(width, PIXELS, vec![[0.0; 3]; width * PIXELS]);
        folder.write_film(&format!("out/{}.exr", case.name), &black);
    }
    folder.accept_all();
    folder.write(
        "near.toml",
        "name = 'near'\n[conventions]\nnear_plane = 1.0\n",
    );
    folder.volref("validate --outputs out --as near.toml --explain 0 --json=r.json");
    let results = folder.json("r.json");
    let cases = results["cases"].as_array().unwrap();
    let of = |key: &str, words: &str| {
        let is =
            |case: &&serde_json::Value| case[key].as_str().is_some_and(|it| it.contains(words));
        cases.iter().filter(is).count()
    };
    assert_eq!(of("verdict", "pass"), 0, "{results}");
    assert!(
        2 * of("reason", "leaves nothing of this scene to see") > cases.len(),
        "{results}"
    );
}
