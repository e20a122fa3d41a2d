//! Bundles, and the renderer in `scripts/peers` that knows nothing else of a scene; the other
//! scripts there, and the tables of what other renderers came to.
//!
//! The student's renderer needs `python3` with NumPy. Where there is none, its tests say so and
//! test nothing.

use crate::folder::{root, tables_in};
use crate::needs::{NUMPY, is_there};
use glam::{DMat3, DVec3};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;
use volref::compare::{Conditions, Gate, Judgement, Picture, judge};
use volref::exchange::{Export, Format, Refusal, export};
use volref::film::Film;
use volref::math::{exp, ln_1p};
use volref::render::{Sampling, plans, render};
use volref::scene::{Model, Scene};

fn figure_file(name: &str) -> PathBuf {
    root().join(format!("fixtures/scenes/figures/{name}.toml"))
}

/// A figure of the suite, with `from` in its text replaced by `to`.
fn figure_with(name: &str, edits: &[(&str, &str)]) -> Scene {
    let mut text = std::fs::read_to_string(figure_file(name)).unwrap();
    for (from, to) in edits {
        assert!(text.contains(from), "{name} has no {from:?}");
        text = text.replace(from, to);
    }
    Scene::parse(&text, &figure_file(name)).unwrap()
}

fn figure(name: &str) -> Scene {
    figure_with(name, &[])
}

/// A figure in a sixteenth of its pixels.
fn small(name: &str) -> Scene {
    let edits = [
        ("width = 256", "width = 64"),
        ("height = 256", "height = 64"),
    ];
    figure_with(name, &edits)
}

fn description(export: &Export) -> Value {
    serde_json::from_slice(contents(export, &export.main)).unwrap()
}

fn json_text(export: &Export) -> &str {
    std::str::from_utf8(contents(export, &export.main)).unwrap()
}

fn contents<'e>(export: &'e Export, name: &str) -> &'e [u8] {
    let found = export.files.iter().find(|(file, _)| file == name);
    &found.unwrap_or_else(|| panic!("no {name}")).1
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    let (values, rest) = bytes.as_chunks();
    assert!(rest.is_empty());
    values
        .iter()
        .map(|&value| f32::from_le_bytes(value))
        .collect()
}

fn vector(value: &Value) -> [f64; 3] {
    std::array::from_fn(|axis| value[axis].as_f64().unwrap())
}

fn film(scene: &Scene) -> Film {
    let rendering = render(&plans(scene), Sampling::default(), &|| {});
    rendering.unwrap().film
}

fn deterministic(reference: &Film, test: &Film) -> Judgement {
    let [reference, test] = [reference, test].map(|film| Picture::Radiance(film.clone()));
    judge(
        Gate::Deterministic,
        &reference,
        &test,
        &Conditions::default(),
    )
    .unwrap()
}

fn bundle(scene: &Scene, name: &str) -> Result<Export, Refusal> {
    export(scene, Format::Bundle, name, None)
}

/// The bundle as its reader sees it: a volume with everything on.
#[test]
fn a_volume_in_words_and_numbers() {
    let shadow = "[classified.shadow]\nreference_step = \"0.05 voxels\"\n\n[classified.phong]";
    let scene = figure_with("figure-3", &[("[classified.phong]", shadow)]);
    let export = bundle(&scene, "lit").unwrap();
    insta::assert_snapshot!("bundle_of_a_volume", json_text(&export));
}

#[test]
fn a_plot_in_words_and_numbers() {
    let export = bundle(&figure("figure-2"), "plot").unwrap();
    insta::assert_snapshot!("bundle_of_a_plot", json_text(&export));
}

#[test]
fn the_numbers_of_a_bundle_are_those_of_the_scene() {
    let scene = figure("figure-5");
    let export = bundle(&scene, "five").unwrap();
    let bundle = description(&export);
    assert_eq!(bundle["image"]["width"], 512);
    for (index, panel) in scene.panels.iter().enumerate() {
        let Model::Classified(scene) = &panel.model else {
            panic!("figure 5 is a volume");
        };
        let panel = &bundle["panels"][index];
        assert_eq!(panel["first_column"], 256 * index);
        // Both panels show one grid: it is written once.
        let file = panel["grid"]["file"].as_str().unwrap();
        assert_eq!(file, "five.grid-1.raw");
        assert_eq!(floats(contents(&export, file)), scene.grid.values());
        let lattice = scene.grid.lattice();
        assert_eq!(
            vector(&panel["grid"]["first_node"]),
            lattice.first().to_array()
        );
        assert_eq!(
            vector(&panel["grid"]["spacing"]),
            lattice.spacing().to_array()
        );
        assert_eq!(
            vector(&panel["grid"]["box_max"]),
            lattice.bounds().max.to_array()
        );
        assert_eq!(panel["sampling"]["step"], scene.step);
        assert_eq!(vector(&panel["light"]["position"]), scene.light.to_array());
        let shadow = scene.shadow.map(|shadow| shadow.reference_step);
        assert_eq!(panel["shadow"]["reference_step"].as_f64(), shadow);
    }
    assert_eq!(export.files.len(), 2);
}

/// The formula of the rays, followed to the letter, gives the camera's rays.
#[test]
fn rays_follow_from_the_bundle() {
    let scene = figure_with("figure-3", &[("up = [0, 1, 0]", "up = [0.3, 1, 0]")]);
    let Model::Classified(volume) = &scene.panels[0].model else {
        panic!("figure 3 is a volume");
    };
    let bundle = description(&bundle(&scene, "three").unwrap());
    let ray = &bundle["panels"][0]["ray"];
    let (width, height) = (256.0, 256.0);
    let [forward, right, up] =
        ["forward", "half_right", "half_up"].map(|key| glam::DVec3::from(vector(&ray[key])));
    for [x, y] in [[0, 0], [255, 0], [17, 201]] {
        let across = (2.0 * x as f64 + 1.0 - width) / height;
        let down = (2.0 * y as f64 + 1.0 - height) / height;
        let direction = (forward + right * across - up * down).normalize();
        let expected = volume.camera.ray([x, y], [256, 256]);
        assert_eq!(vector(&ray["eye"]), expected.origin.to_array());
        // Components of at most 1, after a dozen roundings.
        let off = (direction - *expected.direction).abs().max_element();
        assert!(off <= 12.0 * f64::EPSILON, "{off:e}");
    }
}

#[test]
fn other_conventions_are_refused_by_name() {
    let conventions = "[classified.conventions]\nlast_step = \"whole\"\n[classified.phong]";
    let scene = figure_with("figure-1", &[("[classified.phong]", conventions)]);
    let refusal = bundle(&scene, "whole").unwrap_err();
    insta::assert_snapshot!(refusal, @"bundle cannot represent classified.conventions: a bundle describes volref's conventions only; leave the table out");
}

/// Everything that a radiative scene can hold, once.
const EVERYTHING: &str = r#"
title = "Everything"
film = { width = 4, height = 3 }
camera = { eye = [0, 1, -6], target = [0, 1, 0] }
sampling = { samples = 24, seed = 7 }
[radiative]
scattering = "single"
environment = [0.25, 0.5, 1]
surface = [
    { sphere = { centre = [0, 1, 0], radius = 0.5 }, scale = [1, 2, 1], diffuse = { reflectance = [0.5, 0.25, 0.125] } },
    { rectangle = { corner = [-5, 0, -5], edge_u = [0, 0, 10], edge_v = [10, 0, 0] }, mirror = { reflectance = 0.75 } },
    { box = { min = [2, 0, 0], max = [3, 1, 1] }, glass = { index = 1.5 } },
    { mesh = { file = "../../meshes/gem.obj" }, translate = [-2, 1, 0], diffuse = { reflectance = 0.5 } },
    { sphere = { centre = [0, 4, 0], radius = 0.25 }, emitter = { radiance = 8, sides = "both" } },
    { mesh = { file = "../../meshes/gem.obj" }, emitter = { radiance = [1, 2, 3] } },
]
medium = [
    { sphere = { centre = [0, 1, 0], radius = 1 }, sigma_t = 2, albedo = 0.5, g = 0.25 },
    { grid = { file = "../../volumes/hard/ramp.nrrd" }, scale = [-2, 1, 1], sigma_s = 1, interpolation = "nearest", emission = 0.5, draine = {} },
    { mesh = { file = "../../meshes/gem.obj" }, sigma_a = 1, sigma_s = 0.5, droplets = { diameter = 12 }, exponential = { base = [0, 1, 0], scale_height = 2 } },
    { box = { min = [0, 0, 0], max = [1, 1, 1] }, sigma_a = 1, noise = { octaves = 2, offset = [1, 2, 3], threshold = 0.5 } },
    { box = { min = [0, 0, 0], max = [1, 1, 1] }, sigma_a = 1, linear = { gradient = [0, -0.5, 0] } },
    { box = { min = [0, 0, 0], max = [1, 1, 1] }, sigma_a = 1, blob = { centre = [0.5, 0.5, 0.5], width = 0.25 } },
]
light = [
    { point = { position = [0, 3, 0], intensity = 4 } },
    { spot = { position = [0, 3, -1], target = [0, 0, -1], intensity = 6, inner_angle = 30, outer_angle = 45 } },
    { directional = { direction = [0, -2, 0], irradiance = 0.5 } },
]
"#;

/// A bundle of surfaces, media and lights as its reader sees it.
#[test]
fn surfaces_media_and_lights_in_words_and_numbers() {
    let path = root().join("fixtures/scenes/fog/everything.toml");
    let scene = Scene::parse(EVERYTHING, &path).unwrap();
    let export = bundle(&scene, "all").unwrap();
    insta::assert_snapshot!("bundle_of_surfaces_media_and_lights", json_text(&export));
    // One mesh in three places is two files, and the grid one.
    let names: Vec<&str> = export.files.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names.len(), 4, "{names:?}");
}

/// Every radiative scene of the suite is said: what it names stands among the files and the formulas.
#[test]
fn every_radiative_scene_has_a_bundle() {
    let mut said = 0;
    for path in tables_in("scenes") {
        let scene = Scene::load(&path).unwrap();
        let Model::Radiative(radiative) = &scene.panels[0].model else {
            continue;
        };
        said += 1;
        let export = bundle(&scene, "scene").unwrap();
        let description = description(&export);
        let panel = &description["panels"][0];
        assert_eq!(panel["shows"], "radiance");
        let list = |key: &str| panel[key].as_array().unwrap();
        assert_eq!(list("surfaces").len(), radiative.objects.len());
        assert_eq!(list("media").len(), radiative.media.len());
        let parts = ["surfaces", "area_lights", "lights", "media"];
        for part in parts.into_iter().flat_map(list) {
            for kind in [
                &part["kind"],
                &part["material"],
                &part["phase"]["kind"],
                &part["density"]["kind"],
            ] {
                let name = kind.as_str();
                assert!(
                    name.is_none_or(|name| !panel["formulas"][name].is_null()),
                    "{kind}"
                );
            }
            let shape = &part["shape"];
            let count = |key: &str| shape[key].as_u64().unwrap() as usize;
            if shape["kind"] == "mesh" {
                let [vertices, triangles] = ["vertices", "triangles"]
                    .map(|key| contents(&export, shape[key].as_str().unwrap()));
                assert_eq!(vertices.len(), 24 * count("vertex_count"));
                assert_eq!(triangles.len(), 12 * count("triangle_count"));
            }
            let density = &part["density"];
            if let Some(file) = density["file"].as_str() {
                let nodes = density["nodes"].as_array().unwrap().iter();
                let count: u64 = nodes.map(|nodes| nodes.as_u64().unwrap()).product();
                assert_eq!(contents(&export, file).len() as u64, 4 * count);
            }
        }
    }
    assert!(said > 100, "{said}");
}

/// The bundle restates the gate in numbers; here the gate is held to them.
#[test]
fn images_are_judged_as_the_bundle_says() {
    let judged = &description(&bundle(&small("figure-3"), "three").unwrap())["judged"];
    let number = |key: &str| judged[key].as_f64().unwrap();
    let value = 0.5;
    let tolerance = number("absolute") + number("relative") * value;
    let count = 10_000;
    let judge = |offset: &dyn Fn(usize) -> f64| {
        let film = |offset: &dyn Fn(usize) -> f64| {
            let pixels = (0..count).map(|i| [(value + offset(i)) as f32; 3]);
            Film::new(100, 100, pixels.collect())
        };
        deterministic(&film(&|_| 0.0), &film(offset)).passed
    };
    // Offsets of both signs keep the mean.
    let sign = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -1.0 };
    assert!(judge(&|i| 0.99 * tolerance * sign(i)));
    assert!(!judge(&|i| 1.01 * tolerance * sign(i)));
    let outliers = (number("outlier_share") * count as f64) as usize;
    let some = |share: usize, size: f64| {
        move |i: usize| {
            if i < share {
                size * tolerance * sign(i)
            } else {
                0.0
            }
        }
    };
    assert!(judge(&some(outliers, 2.0)));
    assert!(!judge(&some(outliers + 1, 2.0)));
    assert!(judge(&some(outliers, 0.99 * number("hard_cap"))));
    assert!(!judge(&some(outliers, 1.01 * number("hard_cap"))));
    let bias = number("bias_share") * tolerance;
    assert!(judge(&|_| 0.99 * bias));
    assert!(!judge(&|_| 1.01 * bias));
}

// --- The student's renderer ---------------------------------------------------------------------

/// True if there is something to run scripts with; else `what` is not tried.
fn python(what: &str) -> bool {
    is_there(NUMPY, &format!("tests/cli/peers.rs: {what}"))
}

/// Writes the bundle of `scene` into `folder` and has the student render it to `output`.
fn student(scene: &Scene, folder: &Path, output: &str, options: &[&str]) -> Vec<u8> {
    let export = bundle(scene, "scene").unwrap();
    for (file, bytes) in &export.files {
        std::fs::write(folder.join(file), bytes).unwrap();
    }
    let run = Command::new("python3")
        .arg(root().join("scripts/peers/student.py"))
        .args([&export.main, output])
        .args(options)
        .current_dir(folder)
        .output()
        .unwrap();
    let complaint = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{complaint}");
    std::fs::read(folder.join(output)).unwrap()
}

fn student_film(scene: &Scene, options: &[&str]) -> Film {
    let folder = tempfile::tempdir().unwrap();
    Film::from_exr(&student(scene, folder.path(), "image.exr", options)).unwrap()
}

/// Somebody who has only the bundles renders what the goldens show.
#[test]
fn the_student_passes_figures_1_to_4() {
    if !python("the_student_passes_figures_1_to_4") {
        return;
    }
    for name in ["figure-1", "figure-2", "figure-3", "figure-4"] {
        let golden = root().join(format!("golden/figures/{name}.exr"));
        let golden = Film::from_exr(&std::fs::read(golden).unwrap()).unwrap();
        let judgement = deterministic(&golden, &student_film(&figure(name), &[]));
        assert!(judgement.passed, "{name}: {}", judgement.reason);
    }
}

/// Shadow rays take the student long: figure 5 is rendered small, without the shadow and with.
#[test]
fn the_student_passes_figure_5_and_fails_without_its_shadow() {
    if !python("the_student_passes_figure_5_and_fails_without_its_shadow") {
        return;
    }
    let scene = small("figure-5");
    let right = film(&scene);
    let judgement = deterministic(&right, &student_film(&scene, &[]));
    assert!(judgement.passed, "{}", judgement.reason);
    let wrong = student_film(&scene, &["--mistake", "no-shadow"]);
    assert!(!deterministic(&right, &wrong).passed);
}

/// Two constant volumes that overlap, by the numbers of their bundle alone, in closed form.
#[test]
fn several_volumes_follow_from_their_bundle() {
    let scene = Scene::load(&root().join("fixtures/scenes/scenes/two-fogs.toml")).unwrap();
    let description = description(&bundle(&scene, "fogs").unwrap());
    let panel = &description["panels"][0];
    assert_eq!(panel["shows"], "volumes");
    let ray = &panel["ray"];
    let [eye, forward, right, up] =
        ["eye", "forward", "half_right", "half_up"].map(|key| DVec3::from(vector(&ray[key])));
    let background = DVec3::from(vector(&panel["background"]));
    let side = 96;
    let mut pixels = Vec::new();
    for at in 0..side * side {
        let place = |at: usize| (2 * at + 1) as f64 / side as f64 - 1.0;
        let direction = forward + right * place(at % side) - up * place(at / side);
        let direction = direction / direction.length();
        // Where the ray is in each, with extinction and colour.
        let inside = panel["volumes"]
            .as_array()
            .unwrap()
            .iter()
            .filter_map(|volume| {
                let grid = &volume["grid"];
                let row = |row: usize| DVec3::from(vector(&grid["matrix"][row]));
                let linear = DMat3::from_cols(row(0), row(1), row(2)).transpose();
                let offset = [0, 1, 2].map(|row| grid["matrix"][row][3].as_f64().unwrap());
                let inverse = linear.inverse();
                let (origin, direction) =
                    (inverse * (eye - DVec3::from(offset)), inverse * direction);
                let [low, high] = ["box_min", "box_max"].map(|key| DVec3::from(vector(&grid[key])));
                let (a, b) = ((low - origin) / direction, (high - origin) / direction);
                let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
                let look = &volume["transfer_function"];
                let point = &look["points"][0];
                let opacity = point["opacity"].as_f64().unwrap();
                let extinction = -ln_1p(-opacity) / look["reference_length"].as_f64().unwrap();
                let colour = DVec3::from(vector(&point["colour"]));
                (near < far).then_some((near, far, extinction, colour))
            });
        let inside: Vec<_> = inside.collect();
        let mut ends: Vec<f64> = inside
            .iter()
            .flat_map(|&(near, far, ..)| [near, far])
            .collect();
        ends.sort_by(f64::total_cmp);
        let (mut seen, mut passed) = (DVec3::ZERO, 1.0);
        for piece in ends.windows(2) {
            let middle = 0.5 * (piece[0] + piece[1]);
            let there = inside
                .iter()
                .filter(|(near, far, ..)| *near < middle && middle < *far);
            let (extinction, glow) = there.fold((0.0, DVec3::ZERO), |(sum, glow), (_, _, s, c)| {
                (sum + s, glow + *c * *s)
            });
            if extinction > 0.0 {
                let through = exp(-extinction * (piece[1] - piece[0]));
                seen += glow / extinction * (1.0 - through) * passed;
                passed *= through;
            }
        }
        pixels.push((seen + background * passed).to_array());
    }
    let film = film(&scene);
    for (pixel, expected) in film.radiance().iter().zip(&pixels) {
        for (value, expected) in pixel.iter().zip(expected) {
            // 32 bits, of numbers up to 1.
            let off = (f64::from(*value) - expected).abs();
            assert!(off <= f64::from(f32::EPSILON), "{value} is not {expected}");
        }
    }
}

/// A volume that a map shears: the matrix of the bundle, and what its formula says, are enough.
#[test]
fn the_student_places_a_volume() {
    let placed = "file = \"../../volumes/smoke.obj\"\n\
                  transform = [[1, 0.5, 0, 0.1], [0, 0.6, -0.3, 0], [0.2, 0, 1.3, 0]]";
    let edits = [
        ("width = 256", "width = 64"),
        ("height = 256", "height = 64"),
        ("file = \"../../volumes/smoke.obj\"", placed),
    ];
    let scene = figure_with("figure-3", &edits);
    let bundle = description(&bundle(&scene, "placed").unwrap());
    let grid = &bundle["panels"][0]["grid"];
    let rows = [
        [1.0, 0.5, 0.0, 0.1],
        [0.0, 0.6, -0.3, 0.0],
        [0.2, 0.0, 1.3, 0.0],
    ];
    assert_eq!(grid["matrix"], serde_json::json!(rows));
    assert!(grid["placement"].as_str().unwrap().contains("M*q + o"));
    if !python("the_student_places_a_volume") {
        return;
    }
    let judgement = deterministic(&film(&scene), &student_film(&scene, &[]));
    assert!(judgement.passed, "{}", judgement.reason);
}

/// Volumes by tables, placed, clipped and several together, and parallel rays: colours and opacity.
#[test]
fn the_student_renders_scenes_without_surfaces() {
    if !python("the_student_renders_scenes_without_surfaces") {
        return;
    }
    for name in [
        "scenes/turned",
        "scenes/uneven",
        "scenes/sheared",
        "scenes/mirrored",
        "scenes/oblique",
        "scenes/shadowed",
        "scenes/opacity-over-grey",
        "scenes/clipped-apart",
        "scenes/clipped-head",
        "scenes/rings-in-waves",
        "scenes/three-in-shadow",
        "scenes/two-fogs",
        "reported/borders",
        "reported/two-fields",
        "sampled/parallel-z-up",
        "sampled/thick-slices",
    ] {
        let path = root().join(format!("fixtures/scenes/{name}.toml"));
        let mut scene = Scene::load(&path).unwrap();
        for panel in &mut scene.panels {
            (panel.width, panel.height) = (32, 32);
        }
        let (right, test) = (film(&scene), student_film(&scene, &[]));
        let judgement = deterministic(&right, &test);
        assert!(judgement.passed, "{name}: {}", judgement.reason);
        let opacities = right.opacity().unwrap().iter().zip(test.opacity().unwrap());
        let worst = opacities.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(worst < 1e-5, "{name}: {worst}");
    }
}

/// Projections and isosurfaces, from the words and numbers of a bundle alone; what is exact is sampled finely there.
#[test]
fn the_student_projects() {
    let field = |name: &str| {
        let path = root().join(format!("fixtures/scenes/scenes/{name}.toml"));
        let mut scene = Scene::load(&path).unwrap();
        for panel in &mut scene.panels {
            (panel.width, panel.height) = (28, 28);
        }
        scene
    };
    let is_run = python("the_student_projects");
    for name in [
        "maximum",
        "mean",
        "attenuated",
        "isosurfaces",
        "sum-exact",
        "isosurface-exact",
    ] {
        let scene = field(name);
        let mode = description(&bundle(&scene, "field").unwrap())["panels"][0]["mode"].clone();
        assert_eq!(mode["exact"], name.ends_with("exact"), "{name}");
        assert!(mode["pixel"].is_string(), "{mode}");
        if is_run {
            let judgement = deterministic(&film(&scene), &student_film(&scene, &[]));
            assert!(judgement.passed, "{name}: {}", judgement.reason);
        }
    }
    if is_run {
        let (scene, mistake) = (field("maximum"), ["--mistake", "from-zero"]);
        assert!(!deterministic(&film(&scene), &student_film(&scene, &mistake)).passed);
    }
}

// --- The student's path tracer --------------------------------------------------------------------

/// Verdicts of `validate` on the student's path tracer, with their numbers.
fn validated_paths(cases: &[&str], command: &str, folder: &Path) -> (i32, Value) {
    let program = root().join("scripts/peers/student_paths.py");
    let json = folder.join("results.json");
    let run = Command::new(env!("CARGO_BIN_EXE_volref"))
        .arg("validate")
        .args(cases)
        .args(["--run", &format!("python3 {} {command}", program.display())])
        .args(["--explain=0", &format!("--json={}", json.display())])
        .current_dir(root())
        .output()
        .unwrap();
    let results = std::fs::read_to_string(&json).unwrap();
    (
        run.status.code().unwrap(),
        serde_json::from_str(&results).unwrap(),
    )
}

/// Media among lights follow from the numbers and words of a bundle alone, with the noise that is stated; and with a
/// mistake they do not.
#[test]
fn the_students_paths_pass_and_mistakes_do_not() {
    if !python("the_students_paths_pass_and_mistakes_do_not") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let cases = ["known-answers/lit-ball", "known-answers/absorbing-grid"];
    let command = "{export:bundle} {output} --spp 128 --seed {seed}";
    let (code, results) = validated_paths(&cases, command, folder.path());
    assert_eq!(code, 0, "{results:#}");
    let mistake = format!("{command} --mistake no-absorption");
    let (code, results) = validated_paths(&cases[..1], &mistake, folder.path());
    assert_eq!(code, 1, "{results:#}");
    // A gem of triangles is nothing that it knows, and a classified volume neither.
    let unknown = ["known-answers/furnace-mesh", "figures/figure-1"];
    let (code, results) = validated_paths(&unknown, command, folder.path());
    assert_eq!(code, 4, "{results:#}");
    let results = results.to_string();
    for reason in [
        "refused: media[0]: a mesh",
        "refused: a panel that shows volume",
    ] {
        assert!(results.contains(reason), "{results}");
    }
}

// --- Scripts of other renderers -----------------------------------------------------------------

/// Runs a script of `scripts/peers` in `folder`, with what stands for a program of the renderer.
fn script(name: &str, arguments: &[&str], folder: &Path, program: Option<&Path>) -> (bool, String) {
    let mut run = Command::new("python3");
    run.arg(root().join("scripts/peers").join(name));
    run.args(arguments).current_dir(folder);
    run.env("PYTHONPATH", root().join("python"));
    match program {
        Some(program) => run.env("PBRT", program),
        None => run.env("PBRT", folder.join("none")),
    };
    let output = run.output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.success(), said)
}

/// A program with the flags of pbrt: green is the seed's, of a white scene 0.5.
#[cfg(unix)]
fn stand_in(folder: &Path, spread: &str) -> PathBuf {
    use std::os::unix::fs::PermissionsExt;
    let program = folder.join("pbrt-of-the-test");
    let text = format!(
        r#"#!/usr/bin/env python3
import struct, sys
arguments = sys.argv[1:]
value = lambda flag: arguments[arguments.index(flag) + 1]
assert "--disable-wavelength-jitter" in arguments and "--quiet" in arguments
white = "[ 1 1 1 ]" in open(arguments[-1]).read() and arguments[-1].endswith("white.pbrt")
width, height, green = 1, 1, 0.5
if not white:
    width, height = 4, 3
    channel = 1 + ["red", "green", "blue"].index(arguments[-1].split(".")[-2])
    green = 0.5 * (channel + {spread} * (int(value("--seed")) % 1000) / 1000)
with open(value("--outfile"), "wb") as file:
    file.write(f"PF\n{{width}} {{height}}\n-1.0\n".encode())
    file.write(struct.pack("<3f", 0.9, green, 0.1) * (width * height))
"#
    );
    std::fs::write(&program, text).unwrap();
    let mode = std::fs::Permissions::from_mode(0o755);
    std::fs::set_permissions(&program, mode).unwrap();
    program
}

/// Pictures of three channels are put together, divided by white; noise is that of the replicates,
/// and none is stated where they agree.
#[cfg(unix)]
#[test]
fn the_script_for_pbrt_divides_by_white_and_states_noise() {
    if !python("the_script_for_pbrt_divides_by_white_and_states_noise") {
        return;
    }
    let scene = "[film]\nwidth = 4\nheight = 3\n[camera]\neye = [0, 0, -1]\n\
                 target = [0, 0, 0]\n[radiative]\nenvironment = [1, 2, 3]\n";
    let scene = Scene::parse(scene, Path::new("scene.toml")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let export = export(&scene, Format::Pbrt, "scene", None).unwrap();
    for (file, bytes) in &export.files {
        std::fs::write(folder.path().join(file), bytes).unwrap();
    }
    let render = |spread: &str| {
        let program = stand_in(folder.path(), spread);
        let arguments = [&export.main, "image.exr", "--spp", "32", "--seed", "3"];
        let (done, said) = script("run_pbrt.py", &arguments, folder.path(), Some(&program));
        assert!(done, "{said}");
        Film::from_exr(&std::fs::read(folder.path().join("image.exr")).unwrap()).unwrap()
    };
    let exact = render("0");
    assert!(
        exact
            .radiance()
            .iter()
            .all(|pixel| *pixel == [1.0, 2.0, 3.0])
    );
    assert!(exact.noise().is_none());
    let noisy = render("1");
    let noise = noisy.noise().expect("replicates differ");
    assert_eq!(noise.samples(), 32);
    // Sixteen numbers spread over an interval of 1: a variance of 1/12 over 16, three times more
    // or less.
    let expected = 1.0 / 12.0 / 16.0;
    let variance = f64::from(noise.variance()[0][0]);
    assert!(
        (expected / 3.0..3.0 * expected).contains(&variance),
        "{variance}"
    );
    assert!(noisy.radiance()[0][0] > 1.0 && noisy.radiance()[0][2] > 3.0);
}

/// Without pbrt, or without one of its files, the script says what to do.
#[cfg(unix)]
#[test]
fn the_script_for_pbrt_says_what_it_lacks() {
    if !python("the_script_for_pbrt_says_what_it_lacks") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.red.pbrt"), "").unwrap();
    std::fs::write(folder.path().join("b.pbrt"), "").unwrap();
    let (done, said) = script("run_pbrt.py", &["a.red.pbrt", "a.exr"], folder.path(), None);
    assert!(!done && said.contains("a.green.pbrt"), "{said}");
    let (done, said) = script("run_pbrt.py", &["b.pbrt", "b.exr"], folder.path(), None);
    assert!(
        !done && said.contains("which is no program; how pbrt is built is in"),
        "{said}"
    );
}
