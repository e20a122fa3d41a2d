//! Scenes of surfaces, media and lights: what is read, and what is refused.

use glam::DVec3;
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;
use volref::geometry::{Boundary, Direction, Emitter, Luminous, Ray, Shape, Solid, Surface};
use volref::optics::{Asymmetry, Draine, Droplets, Light, Material, Phase, Sides};
use volref::scene::format::json_schema;
use volref::scene::{Model, Radiative, SCENE, Scattering, Scene, SceneError};

/// Something of everything.
const BASE: &str = "\
[camera]
eye = [0, 0, -5]
target = [0, 0, 0]

[radiative]

[[radiative.surface]]
sphere = { centre = [0, 0, 0], radius = 1 }
diffuse = { reflectance = 0.5 }

[[radiative.medium]]
box = { min = [-1, -1, -1], max = [1, 1, 1] }
sigma_a = 0.5
sigma_s = [1, 2, 3]

[[radiative.light]]
point = { position = [0, 3, 0], intensity = 10 }
";

/// A mesh with a hole: a cube's corner.
const OPEN: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n";
/// A mesh with a face without area.
const THIN: &str = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 4\nf 1 2 3\n";

/// Reads a scene as if it were a file in `fixtures/scenes/smoke/`.
fn parse(text: &str) -> Result<Scene, Box<SceneError>> {
    Scene::parse(text, Path::new("fixtures/scenes/smoke/scene.toml"))
}

fn radiative(scene: &Scene, panel: usize) -> &Radiative {
    match &scene.panels[panel].model {
        Model::Radiative(radiative) => radiative,
        other => panic!("{other:?}"),
    }
}

/// [`BASE`] after edits.
fn edited(edits: &[(&str, &str)]) -> String {
    let mut text = BASE.to_owned();
    for (old, new) in edits {
        assert!(text.contains(old), "{old:?}");
        text = text.replacen(old, new, 1);
    }
    text
}

fn as_json(text: &str) -> Value {
    serde_json::to_value(text.parse::<toml::Table>().unwrap()).unwrap()
}

fn schema_accepts(text: &str) -> bool {
    jsonschema::is_valid(&json_schema("scene", &SCENE), &as_json(text))
}

/// What is said about `text`, one line: place, message, help.
fn said_about(text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("open.obj"), OPEN).unwrap();
    std::fs::write(folder.path().join("thin.obj"), THIN).unwrap();
    std::fs::write(folder.path().join("points.obj"), "v 0 0 0\n").unwrap();
    std::fs::create_dir(folder.path().join("folder.obj")).unwrap();
    let error = match Scene::parse(text, &folder.path().join("scene.toml")) {
        Err(error) => error,
        Ok(_) => panic!("accepted:\n{text}"),
    };
    let place = match error.position() {
        Some((line, column)) => format!("{line}:{column}"),
        None => "-".to_owned(),
    };
    let inside = format!("{}{}", folder.path().display(), std::path::MAIN_SEPARATOR);
    let mut said = format!("{place}: {}", error.message());
    // What a key means is held by the schema.
    match error.help_text() {
        Some(doc) if doc.starts_with('`') && doc.contains("`: ") => {}
        help => said += &format!(" help: {}", help.unwrap_or("none")),
    }
    said.replace(&inside, "") + "\n"
}

/// What is said about [`BASE`] after each of the edits.
fn said(edits: &[(&str, &str)]) -> String {
    let lines = edits.iter().map(|&edit| said_about(&edited(&[edit])));
    lines.collect()
}

const POINT: &str = "point = { position = [0, 3, 0], intensity = 10 }";
const SPHERE: &str = "sphere = { centre = [0, 0, 0], radius = 1 }";
const DIFFUSE: &str = "diffuse = { reflectance = 0.5 }";
const BOX: &str = "box = { min = [-1, -1, -1], max = [1, 1, 1] }";
const COEFFICIENTS: &str = "sigma_a = 0.5\nsigma_s = [1, 2, 3]";

#[test]
fn the_room_with_smoke() {
    let scene = Scene::load("fixtures/scenes/smoke/cornell.toml".as_ref()).unwrap();
    let room = radiative(&scene, 0);
    assert_eq!(room.scattering, Scattering::Multiple(None));
    assert_eq!((room.samples, room.seed), (64, 0));
    assert_eq!((room.objects.len(), room.area_lights.len()), (5, 1));
    assert!(matches!(room.objects[0].shape, Shape::Rectangle(_)));
    assert_eq!(
        room.objects[2].material,
        Material::Diffuse(DVec3::splat(0.73))
    );
    let light = &room.area_lights[0];
    assert!(matches!(light.shape, Luminous::Rectangle(_)));
    assert_eq!(
        (light.radiance, light.sides),
        (DVec3::splat(7.0), Sides::Both)
    );
    for (body, albedo) in room.media.iter().zip([0.0, 1.0]) {
        assert!(matches!(body.boundary, Some(Boundary::PlacedBox(_))));
        assert_eq!(body.medium.coefficients.albedo(), DVec3::splat(albedo));
        assert_eq!(body.medium.coefficients.sigma_t(), DVec3::splat(0.01));
    }
}

#[test]
fn what_is_left_out_has_defaults() {
    let scene = parse(BASE).unwrap();
    let read = radiative(&scene, 0);
    assert_eq!(read.scattering, Scattering::Multiple(None));
    assert_eq!((read.samples, read.seed), (64, 0));
    assert_eq!(read.environment, DVec3::ZERO);
    assert!(scene.panels[0].inputs.is_empty());
    let medium = &read.media[0].medium;
    assert_eq!(medium.emission, DVec3::ZERO);
    assert_eq!(medium.phase, Phase::ISOTROPIC);
    assert!(matches!(read.media[0].boundary, Some(Boundary::Box(_))));
    assert!(matches!(read.objects[0].shape, Shape::Sphere(_)));
    // Black, but legal.
    let dark = "[camera]\neye = [0, 0, -1]\ntarget = [0, 0, 0]\n[radiative]\n";
    assert!(radiative(&parse(dark).unwrap(), 0).lights.is_empty());
}

/// One number is a colour, and the canonical text does not tell how it was written.
#[test]
fn grey_is_one_number() {
    let [short, long] = ["environment = 2", "environment = [2.0, 2, 2e0]"]
        .map(|line| parse(&edited(&[("[radiative]", &format!("[radiative]\n{line}"))])).unwrap());
    assert_eq!(radiative(&short, 0).environment, DVec3::splat(2.0));
    assert_eq!(short.canonical_text(), long.canonical_text());
    assert!(
        short
            .canonical_text()
            .contains("radiative.environment = [2, 2, 2]\n")
    );
}

#[test]
fn the_canonical_text_names_every_entry_of_a_list() {
    let text = parse(BASE).unwrap().canonical_text();
    for line in [
        "sampling.samples = 64",
        "radiative.surface[0].sphere.radius = 1",
        "radiative.surface[0].diffuse.reflectance = [0.5, 0.5, 0.5]",
        "radiative.medium[0].sigma_s = [1, 2, 3]",
        "radiative.light[0].point.position = [0, 3, 0]",
    ] {
        assert!(text.lines().any(|l| l == line), "{line}\n{text}");
    }
}

#[test]
fn extinction_and_albedo_are_another_way_to_say_it() {
    let text = edited(&[(COEFFICIENTS, "sigma_t = 3\nalbedo = [0, 0.1, 1]")]);
    let scene = parse(&text).unwrap();
    let coefficients = radiative(&scene, 0).media[0].medium.coefficients;
    assert_eq!(coefficients.sigma_t(), DVec3::splat(3.0));
    assert_eq!(coefficients.sigma_s(), DVec3::new(0.0, 3.0 * 0.1, 3.0));
    assert_eq!(coefficients.sigma_a().z, 0.0);
}

#[test]
fn lights_of_every_kind() {
    let more = format!(
        "{BASE}
[[radiative.light]]
spot = {{ position = [0, 5, 0], target = [0, 0, 0], intensity = [1, 2, 3], inner_angle = 20, outer_angle = 30 }}
[[radiative.light]]
directional = {{ direction = [0, -2, 0], irradiance = 3 }}
"
    );
    let scene = parse(&more).unwrap();
    let [
        Light::Point(point),
        Light::Spot(spot),
        Light::Directional(sun),
    ] = radiative(&scene, 0).lights[..]
    else {
        panic!("{:?}", radiative(&scene, 0).lights)
    };
    assert_eq!(point.intensity, DVec3::splat(10.0));
    assert_eq!(spot.axis(), Direction::NEG_Y);
    assert_eq!(spot.outer(), 30.0_f64.to_radians());
    assert_eq!(sun.direction, Direction::NEG_Y);
    assert!(schema_accepts(&more));
}

/// Scaled, then turned, then moved; what is not moved keeps its exact coordinates.
#[test]
fn shapes_are_scaled_turned_and_moved_in_this_order() {
    let moves =
        "scale = [2, 1, 1]\nrotate = { axis = [0, 0, 1], angle = 90 }\ntranslate = [0, 0, 7]";
    let placed = |shape: &str, moves: &str| {
        let text = edited(&[(SPHERE, &format!("{shape}\n{moves}"))]);
        radiative(&parse(&text).unwrap(), 0).objects[0]
            .shape
            .clone()
    };
    let cuboid = "box = { min = [0, 0, 0], max = [1, 1, 1] }";
    let rectangle = "rectangle = { corner = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 1, 0] }";
    let mesh = "mesh = { file = \"../../meshes/gem.obj\" }";
    assert!(matches!(placed(SPHERE, moves), Shape::PlacedSphere(_)));
    assert!(matches!(placed(mesh, moves), Shape::PlacedMesh(_)));
    for shape in [placed(cuboid, moves), placed(rectangle, moves)] {
        let bounds = shape.bounds();
        assert_eq!(bounds.min, DVec3::new(-1.0, 0.0, 7.0), "{shape:?}");
        assert_eq!(bounds.max.truncate(), DVec3::new(0.0, 2.0, 8.0).truncate());
    }
    let nothing =
        "scale = [1, 1, 1]\nrotate = { axis = [0, 0, 1], angle = 0 }\ntranslate = [0, 0, 0]";
    for moves in ["", nothing] {
        assert!(matches!(placed(SPHERE, moves), Shape::Sphere(_)));
        assert!(matches!(placed(cuboid, moves), Shape::Box(_)));
        assert!(matches!(placed(mesh, moves), Shape::Mesh(_)));
        assert!(matches!(placed(rectangle, moves), Shape::Rectangle(_)));
    }
}

#[test]
fn surfaces_that_send_out_light() {
    let luminous = |shape: &str| {
        let text = edited(&[(SPHERE, shape), (DIFFUSE, "emitter = { radiance = 4 }")]);
        assert!(schema_accepts(&text), "{shape}");
        let scene = parse(&text).unwrap();
        let light = radiative(&scene, 0).area_lights[0].clone();
        assert_eq!(
            (light.radiance, light.sides),
            (DVec3::splat(4.0), Sides::Front)
        );
        light.shape
    };
    let Luminous::Sphere(sphere) = luminous(&format!(
        "{SPHERE}\nscale = [-2, 2, 2]\ntranslate = [1, 0, 0]"
    )) else {
        panic!("a sphere")
    };
    assert_eq!((sphere.centre(), sphere.radius()), (DVec3::X, 2.0));
    let cuboid = luminous("box = { min = [0, 0, 0], max = [1, 2, 3] }\nscale = [-1, 1, 1]");
    assert!(matches!(cuboid, Luminous::Mesh(_)));
    assert_eq!(cuboid.area(), 22.0);
    assert_eq!(cuboid.bounds().min, DVec3::new(-1.0, 0.0, 0.0));
    // Outside is in front, mirrored or not.
    let ray = Ray::new(DVec3::new(-0.4, 0.7, -2.0), DVec3::Z).unwrap();
    let hit = cuboid.hit(&ray, f64::INFINITY).unwrap();
    assert_eq!((hit.t, hit.point.normal), (2.0, Direction::NEG_Z));
    let gem = luminous("mesh = { file = \"../../meshes/gem.obj\" }\ntranslate = [0, 1, 0]");
    assert!(matches!(gem, Luminous::Mesh(_)));
}

/// A mirrored shape keeps its normals outward, and the stretches inside it.
#[test]
fn mirrored_shapes_are_not_inside_out() {
    let mirrored = |shape: &str| {
        let moved = format!("{shape}\nscale = [-1, 2, 1]\ntranslate = [0.25, 0, 0]");
        let text = edited(&[(BOX, &moved), (SPHERE, &moved)]);
        let scene = parse(&text).unwrap();
        let read = radiative(&scene, 0);
        (
            read.objects[0].shape.clone(),
            read.media[0].boundary.clone().unwrap(),
        )
    };
    for shape in [SPHERE, BOX, "mesh = { file = \"../../meshes/ball.obj\" }"] {
        let (surface, boundary) = mirrored(shape);
        for towards in [DVec3::X, DVec3::NEG_Y, DVec3::new(1.0, 2.0, -2.0)] {
            let centre = DVec3::new(0.26, 0.01, 0.02);
            let outside = Ray::new(centre - towards * 5.0, towards).unwrap();
            let hit = surface.hit(&outside, f64::INFINITY).unwrap();
            assert_eq!(hit.side, volref::geometry::Side::Front, "{shape}");
            assert!(hit.point.normal.dot(towards) < 0.0, "{shape}");
            let spans = boundary.spans(&outside);
            assert_eq!(spans.len(), 1, "{shape}");
            // To a few roundings of a distance near 10.
            assert!((spans[0].near - hit.t).abs() < 1e-13, "{shape}");
            let inside = Ray::new(centre, towards).unwrap();
            assert_eq!(boundary.spans(&inside)[0].near, 0.0, "{shape}");
            let hit = surface.hit(&inside, f64::INFINITY).unwrap();
            assert_eq!(hit.side, volref::geometry::Side::Back, "{shape}");
            assert!(hit.point.normal.dot(towards) > 0.0, "{shape}");
        }
    }
}

/// A file is read once for all panels and instances, and noted once with its hash.
#[test]
fn meshes_are_shared() {
    let mesh = "mesh = { file = \"../../meshes/gem.obj\" }";
    let text = edited(&[
        (SPHERE, mesh),
        (BOX, mesh),
        (
            "[[radiative.light]]",
            &format!(
                "[[radiative.surface]]\n{mesh}\nmirror = {{ reflectance = 1 }}\n[[radiative.light]]"
            ),
        ),
        (POINT, POINT),
    ])
    .replace("[radiative]\n", "[radiative]\nscattering = \"single\"\n")
        + "[[panel]]\n[[panel]]\n[panel.radiative]\nlight = []\n";
    let scene = parse(&text).unwrap();
    let meshes: Vec<_> = (0..2)
        .flat_map(|panel| radiative(&scene, panel).objects.clone())
        .map(|object| match object.shape {
            Shape::Mesh(mesh) => mesh,
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(meshes.len(), 4);
    assert!(meshes.iter().all(|mesh| Arc::ptr_eq(mesh, &meshes[0])));
    let bytes = std::fs::read("fixtures/meshes/gem.obj").unwrap();
    for panel in &scene.panels {
        let [input] = &panel.inputs[..] else {
            panic!("{:?}", panel.inputs)
        };
        assert_eq!(input.name, "../../meshes/gem.obj");
        assert_eq!(input.hash, blake3::hash(&bytes).to_hex().to_string());
    }
}

/// A panel puts single keys in their places, and lists as a whole.
#[test]
fn panels_override_keys_and_whole_lists() {
    let text = format!(
        "{BASE}
[[panel]]
[panel.radiative]
scattering = \"single\"

[[panel]]
sampling.samples = 7
[[panel.radiative.medium]]
sigma_a = 2
[[panel.radiative.medium]]
sphere = {{ centre = [0, 0, 0], radius = 3 }}
"
    );
    assert!(schema_accepts(&text));
    let scene = parse(&text).unwrap();
    let (first, second) = (radiative(&scene, 0), radiative(&scene, 1));
    assert_eq!(first.scattering, Scattering::Single);
    assert_eq!((first.media.len(), first.samples), (1, 64));
    assert_eq!(second.scattering, Scattering::Multiple(None));
    assert_eq!((second.media.len(), second.samples), (2, 7));
    assert!(second.media[0].boundary.is_none());
    assert_eq!(second.objects.len(), 1);
    // An entry of a panel's list is complete: it takes nothing from the scene's.
    let broken = text.replace("sigma_a = 2", "albedo = 1");
    assert!(!schema_accepts(&broken) && parse(&broken).is_err());
}

#[test]
fn bounces() {
    let read = |lines: &str| {
        let text = edited(&[("[radiative]", &format!("[radiative]\n{lines}"))]);
        radiative(&parse(&text).unwrap(), 0).scattering
    };
    assert_eq!(read("scattering = \"none\""), Scattering::None);
    assert_eq!(read("scattering = \"single\""), Scattering::Single);
    assert_eq!(read("max_bounces = 16"), Scattering::Multiple(Some(16)));
    insta::assert_snapshot!(said(&[
        ("[radiative]", "[radiative]\nmax_bounces = 1"),
        ("[radiative]", "[radiative]\nmax_bounces = 67108864"),
        ("[radiative]", "[radiative]\nscattering = \"single\"\nmax_bounces = 2"),
        ("[radiative]", "[radiative]\nscattering = \"twice\""),
    ]), @r#"
    6:15: `max_bounces` must lie in [2, 67108863], got 1
    6:15: `max_bounces` must lie in [2, 67108863], got 67108864
    7:15: `max_bounces` has no effect with single scattering help: remove it, or set `scattering = "multiple"`
    6:14: `scattering` must be one of "none", "single", "multiple", but is "twice"
    "#);
}

#[test]
fn coefficients() {
    insta::assert_snapshot!(said(&[
        ("sigma_a = 0.5", "sigma_a = -0.5"),
        ("sigma_a = 0.5", "sigma_a = [0, inf, 0]"),
        ("sigma_s = [1, 2, 3]", "sigma_s = [1, nan, 3]"),
        ("sigma_s = [1, 2, 3]", "sigma_s = [1, 2]"),
        (COEFFICIENTS, "sigma_a = 1e308\nsigma_s = 1e308"),
        (COEFFICIENTS, "sigma_t = 1\nalbedo = 1.2"),
        (COEFFICIENTS, "sigma_t = 1\nalbedo = [0, -0.5, 0]"),
        (COEFFICIENTS, "sigma_t = 1"),
        (COEFFICIENTS, "albedo = 1"),
        (COEFFICIENTS, "sigma_t = 1\nsigma_s = 1"),
        (COEFFICIENTS, "albedo = 1\nsigma_a = 1\nsigma_s = 1"),
        (COEFFICIENTS, "g = 1"),
        (COEFFICIENTS, "g = -1.5"),
        (COEFFICIENTS, "emission = -1"),
    ]), @r"
    13:11: `sigma_a` must be finite and at least 0 in every channel, got [-0.5, -0.5, -0.5]
    13:11: `sigma_a` must be finite, got inf
    14:11: `sigma_s` must be finite, got nan
    14:11: `sigma_s` must be a colour: three numbers red, green, blue, such as [1, 0.5, 0], one for all three, or sRGB such as '#ff8000'
    13:11: the coefficients are too large: sigma_t must be finite and not negative in every channel, got [inf, inf, inf] help: give smaller coefficients, or choose another unit of length
    14:10: `albedo` must lie in [0, 1] in every channel, got [1.2, 1.2, 1.2]
    14:10: `albedo` must lie in [0, 1] in every channel, got [0, -0.5, 0]
    13:11: [radiative.medium[0]] gives `sigma_t` without `albedo` help: give `albedo` too: Fraction of the extinction that scatters, sigma_s / sigma_t, in [0, 1]; to give coefficients, write `sigma_a` and `sigma_s`.
    13:10: [radiative.medium[0]] gives `albedo` without `sigma_t` help: give `sigma_t` too: Extinction per world length, absorption and scattering together; goes with `albedo`.
    14:11: [radiative.medium[0]] mixes `sigma_s` with `sigma_t` help: give either `sigma_a`, `sigma_s`, or `sigma_t`, `albedo`
    15:11: [radiative.medium[0]] mixes `sigma_a`, `sigma_s` with `albedo` help: give either `sigma_a`, `sigma_s`, or `sigma_t`, `albedo`
    13:5: `g` must lie in (-1, 1), got 1
    13:5: `g` must lie in (-1, 1), got -1.5
    13:12: `emission` must be finite and at least 0 in every channel, got [-1, -1, -1]
    ");
}

/// Every way to say how a density differs from place to place.
#[test]
fn densities() {
    let medium = |text: &str| {
        let scene = parse(&edited(&[(BOX, &format!("{BOX}\n{text}"))])).unwrap();
        let body = radiative(&scene, 0).media[0].clone();
        body.density.expect("a density")
    };
    let value = |text: &str, point| medium(text).at(point, &mut 0);
    let half = DVec3::splat(0.5);
    let layer = "exponential = { density = 2, base = [0, -1, 0], scale_height = 1.5 }";
    assert_eq!(value(layer, half), 2.0 * volref::math::exp(-1.0));
    let ramp = "linear = { density = 1, origin = [0, 0, 0], gradient = [1, -2, 0] }";
    assert_eq!(value(ramp, half), 0.5);
    let blob = "blob = { centre = [0, 0, 0.5], width = 0.5, peak = 3 }";
    assert_eq!(
        value(blob, DVec3::new(0.0, 0.0, -0.5)),
        3.0 * volref::math::exp(-2.0)
    );
    let noise = "noise = { scale = [1, 1, 1], offset = [3, 42, 7], octaves = 1, max_density = 2 }";
    // The published value of the noise at (3.14, 42, 7).
    let expected = 0.136_919_958_784_000_12 + 1.0;
    let found = value(noise, DVec3::new(0.14, 0.0, 0.0));
    assert!((found - expected).abs() < 1e-14, "{found}");
    let spread = medium("noise = {}").blocks().range();
    assert!(0.0 <= spread.low && spread.low < spread.high && spread.high <= 1.0);
}

/// A grid brings its own box, where the medium has no shape, and goes where that goes.
#[test]
fn grids() {
    let grid = "grid = { file = \"../../volumes/formats/grid.vol\" }";
    let body = |shape: &str| {
        let scene = parse(&edited(&[(BOX, shape)])).unwrap();
        radiative(&scene, 0).media[0].clone()
    };
    let alone = body(grid);
    let own = alone.boundary.as_ref().unwrap().bounds();
    let density = alone.density.as_ref().unwrap();
    assert_eq!(own, *density.blocks().bounds());
    let moved = body(&format!(
        "{grid}\ntranslate = [10, 0, 0]\nscale = [2, 1, 1]"
    ));
    let bounds = moved.boundary.as_ref().unwrap().bounds();
    assert_eq!(bounds.min.x, 2.0 * own.min.x + 10.0);
    let at = |density: &volref::optics::Density, point| density.at(point, &mut 0);
    let point = own.centre();
    let there = DVec3::new(2.0 * point.x + 10.0, point.y, point.z);
    assert_eq!(
        at(moved.density.as_ref().unwrap(), there),
        at(density, point)
    );
    assert!(at(density, point) > 0.0);
    let nearest = body(&format!("{grid}\ninterpolation = \"nearest\""));
    let values = at(nearest.density.as_ref().unwrap(), own.min);
    assert_eq!(values, at(density, own.min));
    // A shape of its own, of which the grid fills a part.
    let ball = body(&format!(
        "sphere = {{ centre = [0, 0, 0], radius = 9 }}\n{grid}"
    ));
    assert!(matches!(ball.boundary, Some(Boundary::Sphere(_))));
    assert_eq!(*ball.density.unwrap().blocks().bounds(), own);
}

/// The block of the source, as it stands, in a file and in the scene itself.
#[test]
fn the_block_of_the_source() {
    let text = std::fs::read_to_string("fixtures/scenes/procedural/source-block.xml").unwrap();
    let read = |source: &str| {
        let base = edited(&[(COEFFICIENTS, source)]);
        radiative(&parse(&base).unwrap(), 0).media[0].clone()
    };
    let by_file = read("procedural = { file = \"../procedural/source-block.xml\" }");
    let inside = read(&format!(
        "[radiative.medium.procedural]\ntext = '''\n{text}'''"
    ));
    let by_keys = read(
        "sigma_a = 1\nsigma_s = 4\nnoise = { octaves = 10, lacunarity = 4, gain = 0.5, \
         scale = [0.5, 1, 1], max_density = 4, threshold = 1.25 }",
    );
    assert_eq!(by_keys.medium.coefficients.sigma_s(), DVec3::splat(4.0));
    for other in [&by_file, &inside] {
        assert_eq!(other.medium, by_keys.medium);
        for point in [DVec3::ZERO, DVec3::new(0.3, -0.7, 0.2), DVec3::splat(0.9)] {
            let [a, b] =
                [other, &by_keys].map(|body| body.density.as_ref().unwrap().at(point, &mut 0));
            assert_eq!(a, b);
        }
    }
    let scene = parse(&edited(&[(
        COEFFICIENTS,
        "procedural = { file = \"../procedural/source-block.xml\" }",
    )]));
    let panel = &scene.unwrap().panels[0];
    assert_eq!(panel.inputs[0].name, "../procedural/source-block.xml");
    let read = |key: &str| {
        let key = format!("radiative.medium[0].procedural.{key}");
        let found = panel.readings.iter().find(|reading| reading.key == key);
        found.map(|reading| reading.value.clone())
    };
    assert_eq!(read("nrOctaves").as_deref(), Some("10"));
}

#[test]
fn phase_functions() {
    let phase = |text: &str| {
        let text = edited(&[(COEFFICIENTS, &format!("{COEFFICIENTS}\n{text}"))]);
        radiative(&parse(&text).unwrap(), 0).media[0].medium.phase
    };
    let asymmetry = |g| Asymmetry::new(g).unwrap();
    let draine = |g, alpha| Phase::Draine(Draine::new(asymmetry(g), alpha).unwrap());
    assert_eq!(phase("g = 0.5"), Phase::henyey_greenstein(asymmetry(0.5)));
    assert_eq!(phase("draine = {}"), draine(0.0, 1.0));
    assert_eq!(phase("draine = { g = -0.2, alpha = 3 }"), draine(-0.2, 3.0));
    let droplets = Phase::Droplets(Droplets::new(12.0).unwrap());
    assert_eq!(phase("droplets = { diameter = 12 }"), droplets);

    let with = |text: &str| {
        let text = format!("{COEFFICIENTS}\n{text}");
        said_about(&edited(&[(COEFFICIENTS, &text)]))
    };
    let wrong = [
        with("draine = { g = 1 }"),
        with("draine = { alpha = -0.5 }"),
        with("droplets = {}"),
        with("droplets = { diameter = 0.5 }"),
        with("g = 0.5\ndraine = {}"),
    ];
    insta::assert_snapshot!(wrong.concat(), @r"
    15:16: `g` must lie in (-1, 1), got 1
    15:20: `alpha` must be finite and at least 0, got -0.5
    15:12: missing key `diameter` in [radiative.medium[0].droplets]
    15:25: `diameter` must lie in [5, 50], got 0.5
    16:10: [radiative.medium[0]] has more than one phase function: `g`, `draine` help: keep at most one of `g`, `draine`
    ");
}

#[test]
fn densities_that_are_none() {
    let with = |text: &str| said_about(&edited(&[(BOX, &format!("{BOX}\n{text}"))]));
    let bare = |text: &str| said_about(&edited(&[(BOX, text)]));
    let block = |text: &str| {
        let source = format!("[radiative.medium.procedural]\ntext = '''\n{text}'''");
        said_about(&edited(&[(COEFFICIENTS, &source)]))
    };
    let all = [
        bare("noise = {}"),
        bare("grid = { file = \"none.vol\" }"),
        with("noise = {}\nblob = { centre = [0, 0, 0], width = 1 }"),
        with("procedural = { file = \"a.xml\" }"),
        with("interpolation = \"nearest\""),
        with("noise = { octaves = 99 }"),
        with("noise = { gain = 0 }"),
        with("noise = { lacunarity = 1e300 }"),
        with("blob = { centre = [0, 0, 0], width = 0 }"),
        with("exponential = { scale_height = 1, up = [0, 0, 0] }"),
        with("exponential = {}"),
        with("blob = { centre = [0, 0, 0], width = 1, peak = 1e308 }"),
        with("blob = { centre = [0, 0, 0], width = 1, peak = 1e7 }"),
        said_about(&edited(&[
            (
                BOX,
                "blob = { centre = [0, 0, 0], width = 1 }\nbox = { min = [-1, -1, -1], max = [1, 1, 1] }",
            ),
            (COEFFICIENTS, ""),
        ])),
        said_about(&edited(&[(
            COEFFICIENTS,
            "procedural = { file = \"none.xml\" }\ninterpolation = \"nearest\"",
        )])),
        said_about(&edited(&[(
            COEFFICIENTS,
            "procedural = { file = \"none.xml\" }",
        )])),
        said_about(&edited(&[(COEFFICIENTS, "procedural = {}")])),
        block("<medium type=\"procedural\">\n  <flaot name=\"gain\" value=\"1\"/>\n</medium>"),
        block("<medium type=\"procedural\">\n  <color name=\"sigma_a\" value=\"1 1\"/>\n</medium>"),
    ];
    insta::assert_snapshot!(all.concat(), @r"
    12:9: a heterogeneous medium needs a shape: without one it is unbounded help: give the medium a `box`, `sphere` or `mesh`
    12:17: none.vol: there is no such file
    14:8: [radiative.medium[0]] has more than one density: `noise`, `blob` help: keep at most one of `noise`, `blob`
    15:11: [radiative.medium[0]] mixes `procedural` with `sigma_a`, `sigma_s` help: give either `procedural`, or `sigma_a`, `sigma_s`, `sigma_t`, `albedo`
    13:17: `interpolation` belongs to a grid, and the medium has none help: remove it, or give the medium a `grid`
    13:21: `octaves` must lie in [1, 32], got 99
    13:18: `gain` must be finite and above 0, got 0
    13:24: lacunarity 1e300 makes the frequency of octave 4 overflow
    13:38: `width` must be finite and above 0, got 0
    13:40: up must be finite and not zero, got [0, 0, 0]
    13:15: missing key `scale_height` in [radiative.medium[0].exponential]
    14:11: the medium is up to inf optical depths thick, with a density of up to 1.0000e308 over a length of up to 3.4641e0: light is traced through at most 1.6777e7 help: give smaller coefficients, densities or lengths
    14:11: the medium is up to 1.2124e8 optical depths thick, with a density of up to 1.0000e7 over a length of up to 3.4641e0: light is traced through at most 1.6777e7 help: give smaller coefficients, densities or lengths
    12:8: the medium has a density but no coefficients, so it has no effect on light help: give it `sigma_a`, `sigma_s` or `emission`, as they are where the density is 1
    14:17: [radiative.medium[0]] mixes `procedural` with `interpolation` help: give either `procedural`, or `interpolation`
    13:23: there is no file none.xml
    13:14: [radiative.medium[0].procedural] has no source help: give one of `file`, `text`
    13:1: the medium has a density but no coefficients, so it has no effect on light help: give it `sigma_a`, `sigma_s` or `emission`, as they are where the density is 1
    2:32: `sigma_a` must be a colour: three numbers red, green, blue, such as [1, 0.5, 0], one for all three, or sRGB such as '#ff8000'
    ");
}

#[test]
fn matter() {
    insta::assert_snapshot!(said(&[
        ("reflectance = 0.5", "reflectance = 1.5"),
        ("reflectance = 0.5", "reflectance = [0, 0, -0.1]"),
        ("reflectance = 0.5", ""),
        (DIFFUSE, ""),
        (DIFFUSE, "diffuse = { reflectance = 0.5 }\nglass = { index = 1.5 }"),
        (DIFFUSE, "glass = { index = 0 }"),
        (DIFFUSE, "glass = {}"),
        (DIFFUSE, "difuse = { reflectance = 0.5 }"),
        (DIFFUSE, "diffuse = { reflectence = 0.5 }"),
        (DIFFUSE, "emitter = { radiance = 1, sides = \"back\" }"),
        (DIFFUSE, "emitter = { radiance = -1 }"),
    ]), @r#"
    9:27: `reflectance` must lie in [0, 1] in every channel, got [1.5, 1.5, 1.5]
    9:27: `reflectance` must lie in [0, 1] in every channel, got [0, 0, -0.1]
    9:11: missing key `reflectance` in [radiative.surface[0].diffuse]
    7:1: [radiative.surface[0]] has no material help: give one of `diffuse`, `mirror`, `glass`, `emitter`
    10:9: [radiative.surface[0]] has more than one material: `diffuse`, `glass` help: keep exactly one of `diffuse`, `glass`
    9:19: `index` must be finite and above 0, got 0
    9:9: missing key `index` in [radiative.surface[0].glass]
    9:1: unknown key `difuse` in [radiative.surface[0]] help: did you mean `diffuse`?
    9:13: unknown key `reflectence` in [radiative.surface[0].diffuse] help: did you mean `reflectance`?
    9:35: `sides` must be one of "front", "both", but is "back"
    9:24: `radiance` must be finite and at least 0 in every channel, got [-1, -1, -1]
    "#);
}

#[test]
fn shapes() {
    insta::assert_snapshot!(said(&[
        (SPHERE, ""),
        (SPHERE, "sphere = { centre = [0, 0, 0], radius = 1 }\nmesh = { file = \"open.obj\" }"),
        ("radius = 1", "radius = 0"),
        ("radius = 1", "radius = -1"),
        ("centre = [0, 0, 0], radius = 1", "centre = [1, 0, 0], radius = 1e-20"),
        ("radius = 1", "raduis = 1"),
        (SPHERE, "rectangle = { corner = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [2, 0, 0] }"),
        (SPHERE, "box = { min = [0, 2, 0], max = [1, 1, 1] }"),
        (SPHERE, "mesh = { file = \"none.obj\" }"),
        (SPHERE, "mesh = { file = \"folder.obj\" }"),
        (SPHERE, "mesh = { file = \"points.obj\" }"),
        (SPHERE, "mesh = { file = \"thin.obj\" }"),
        (BOX, "mesh = { file = \"open.obj\" }"),
        (BOX, "mesh = { file = \"thin.obj\" }"),
        (BOX, "box = { min = [0, 1, 0], max = [1, 1, 1] }"),
        (BOX, "box = { min = [0, 1, 0], max = [1, 1, 1] }\nsphere = { centre = [0, 0, 0], radius = 1 }"),
        (BOX, "rectangle = { corner = [0, 0, 0] }"),
        (BOX, "translate = [1, 0, 0]"),
    ]), @r"
    7:1: [radiative.surface[0]] has no shape help: give one of `rectangle`, `sphere`, `box`, `mesh`
    9:8: [radiative.surface[0]] has more than one shape: `sphere`, `mesh` help: keep exactly one of `sphere`, `mesh`
    8:41: `radius` must be finite and above 0, got 0
    8:41: `radius` must be finite and above 0, got -1
    8:41: the radius of a sphere must be positive, finite, and not vanish beside its coordinates, got 0.00000000000000000001 at [1, 0, 0]
    8:32: unknown key `raduis` in [radiative.surface[0].sphere] help: did you mean `radius`?
    8:64: a rectangle with edges [1, 0, 0] and [2, 0, 0] has no area; give two edges that are not parallel
    8:15: the box's min [0, 2, 0] must not exceed its max [1, 1, 1] on any axis; swap them where it does
    8:17: there is no file none.obj
    8:17: folder.obj cannot be read: this is a directory, not a file
    8:17: points.obj: the mesh has no faces: export it as polygons; a file of bare points is a point cloud
    8:17: thin.obj: the face in line 6 has no area: its corners [0, 0, 0], [1, 0, 0] and [2, 0, 0] lie on a line; remove it
    12:17: open.obj: the edge from [0, 1, 0] to [1, 0, 0] belongs to the face in line 5, and a closed boundary has two faces at each, which run along it in opposite directions: fill the hole, merge vertices by distance, or reverse the corners of a face, for instance in Blender or MeshLab
    12:17: thin.obj: the face in line 6 has no area: its corners [0, 0, 0], [1, 0, 0] and [2, 0, 0] lie on a line; remove it
    12:7: the box is flat: it has no inside, as a medium needs help: give `max` larger coordinates than `min` on every axis; a flat surface is a `rectangle`
    13:10: [radiative.medium[0]] has more than one shape: `sphere`, `box` help: keep at most one of `sphere`, `box`
    12:1: unknown key `rectangle` in [radiative.medium[0]] help: allowed keys in [radiative.medium[0]]: sphere, box, mesh, scale, rotate, translate, grid, interpolation, noise, exponential, linear, blob, procedural, g, draine, droplets, sigma_a, sigma_s, sigma_t, albedo, emission
    12:13: a medium without a shape fills all space: `translate` has no effect help: give the medium a `sphere`, `box` or `mesh`, or remove `translate`
    ");
}

#[test]
fn places() {
    let after_sphere =
        |lines: &str| said_about(&edited(&[(SPHERE, &format!("{SPHERE}\n{lines}"))]));
    let mut all = String::new();
    for lines in [
        "scale = [1, 0, 1]",
        "scale = 2",
        "rotate = { axis = [0, 0, 0], angle = 1 }",
        "rotate = { axis = [0, 1, 0] }",
        "rotate = { axis = [0, 1, 0], angle = inf }",
        "rotate = [{ axis = [0, 1, 0], angle = 1 }]",
        "scale = [1e-30, 1e-30, 1e-30]\ntranslate = [1, 1, 1]",
        "scale = [1e308, 1e308, 1e308]\ntranslate = [1e308, 0, 0]",
        "rotat = 1",
    ] {
        all.push_str(&after_sphere(lines));
    }
    let glass = edited(&[
        (SPHERE, "box = { min = [0, 1, 0], max = [1, 1, 1] }"),
        (DIFFUSE, "glass = { index = 1.5 }"),
    ]);
    all.push_str(&said_about(&glass));
    for shape in [
        "sphere = { centre = [0, 0, 0], radius = 1 }\nscale = [1, 2, 1]",
        "sphere = { centre = [0, 0, 0], radius = 1e200 }",
        "box = { min = [0, 1, 0], max = [1, 1, 1] }",
        "rectangle = { corner = [0, 0, 0], edge_u = [0, 0, 0], edge_v = [0, 1, 0] }",
        "rectangle = { corner = [0, 0, 0], edge_u = [1, 0, 0], edge_v = [0, 1, 0] }\nscale = [1e-30, 1e-30, 1]\ntranslate = [1, 1, 1]",
        "mesh = { file = \"open.obj\" }\nscale = [1e-30, 1e-30, 1]\ntranslate = [1, 1, 1]",
    ] {
        let text = edited(&[(SPHERE, shape), (DIFFUSE, "emitter = { radiance = 1 }")]);
        all.push_str(&said_about(&text));
    }
    insta::assert_snapshot!(all, @r"
    9:9: scaling by [1, 0, 1] flattens the object; give a factor other than 0 on every axis
    9:9: `scale` must be three numbers, such as [0, 1, 0], not an integer
    9:19: a rotation needs an axis other than the zero vector
    9:10: missing key `angle` in [radiative.surface[0].rotate]
    9:38: `angle` must be finite, got inf
    9:10: `rotate` must be a table, not an array
    8:10: the sphere is 0.000e0 across and reaches to coordinates of 1.000e0: light is traced between shapes at least 1e-100 across, in coordinates up to 1e100 help: choose another unit of length
    8:10: the sphere is inf across and reaches to coordinates of inf: light is traced between shapes at least 1e-100 across, in coordinates up to 1e100 help: choose another unit of length
    9:1: unknown key `rotat` in [radiative.surface[0]] help: did you mean `rotate`?
    8:7: the box is flat: it has no inside, as glass needs help: give `max` larger coordinates than `min` on every axis; a flat surface is a `rectangle`
    9:9: an emitting sphere cannot be stretched to an ellipsoid help: scale by the same factor along x, y and z, or give a mesh of the ellipsoid
    8:10: the sphere is 3.464e200 across and reaches to coordinates of 1.000e200: light is traced between shapes at least 1e-100 across, in coordinates up to 1e100 help: choose another unit of length
    8:7: the box is flat: it has no inside, as a light in the shape of a box needs help: give `max` larger coordinates than `min` on every axis; a flat surface is a `rectangle`
    8:64: a rectangle with edges [0, 0, 0] and [0, 1, 0] has no area; give two edges that are not parallel
    8:13: after its transform: a rectangle with edges [0.000000000000000000000000000001, 0, 0] and [0, 0.000000000000000000000000000001, 0] has no area; give two edges that are not parallel
    8:8: after its transform: the face in line 5 has no area: its corners [1, 1, 1], [1, 1, 1] and [1, 1, 1] lie on a line; remove it
    ");
}

#[test]
fn lights() {
    insta::assert_snapshot!(said(&[
        (POINT, ""),
        (POINT, "point = { position = [0, 3, 0], intensity = -1 }"),
        (POINT, "point = { position = [0, 3], intensity = 1 }"),
        (POINT, "point = { position = [0, 3, 0], intensity = 1 }\ndirectional = { direction = [0, 1, 0], irradiance = 1 }"),
        (POINT, "spot = { position = [0, 3, 0], target = [0, 3, 0], intensity = 1, inner_angle = 1, outer_angle = 2 }"),
        (POINT, "spot = { position = [0, 3, 0], target = [0, 0, 0], intensity = 1, inner_angle = 3, outer_angle = 2 }"),
        (POINT, "spot = { position = [0, 3, 0], target = [0, 0, 0], intensity = 1, inner_angle = 3, outer_angle = 181 }"),
        (POINT, "spot = { position = [0, 3, 0], target = [0, 0, 0], intensity = 1, inner_angle = 0, outer_angle = 0 }"),
        (POINT, "spot = { position = [0, 3, 0], target = [0, 0, 0], intensity = 1, outer_angle = 9 }"),
        (POINT, "directional = { direction = [0, 0, 0], irradiance = 1 }"),
        (POINT, "sun = 1"),
        ("[[radiative.light]]", "[radiative.light]"),
        ("[[radiative.light]]\npoint = { position = [0, 3, 0], intensity = 10 }", "[[panel]]\nradiative.light = [1]"),
    ]), @r"
    16:1: [radiative.light[0]] has no kind of light help: give one of `point`, `spot`, `directional`
    17:45: `intensity` must be finite and at least 0 in every channel, got [-1, -1, -1]
    17:22: `position` must be three numbers, such as [0, 1, 0]
    18:15: [radiative.light[0]] has more than one kind of light: `point`, `directional` help: keep exactly one of `point`, `directional`
    17:41: the spotlight has no direction: its target is its position
    17:98: a spotlight needs 0 <= inner_angle <= outer_angle <= 180 degrees and an outer_angle above 0, got 3 and 2
    17:98: `outer_angle` must lie in [0, 180], got 181
    17:98: a spotlight needs 0 <= inner_angle <= outer_angle <= 180 degrees and an outer_angle above 0, got 0 and 0
    17:8: missing key `inner_angle` in [radiative.light[0].spot]
    17:29: the direction of the light is the zero vector
    17:1: unknown key `sun` in [radiative.light[0]] help: allowed keys in [radiative.light[0]]: point, spot, directional
    16:1: `light` must be tables in double brackets, [[…]], not a table
    17:19: `light` must be tables in double brackets, [[…]], not an integer
    ");
}

#[test]
fn parts_that_make_no_picture_together() {
    let fog = |lines: &str| (format!("{BOX}\n{COEFFICIENTS}"), lines.to_owned());
    let mut all = String::new();
    for (edits, more) in [
        (fog("sigma_a = [0, 0, 1]"), "environment = [1, 0, 0]"),
        (fog("emission = 1"), ""),
        (fog("emission = 1\nsigma_a = [1, 1, 0]"), ""),
        (fog("sigma_s = 1"), ""),
        (
            fog("sigma_s = 1\nsigma_a = [1, 1, 0]"),
            "scattering = \"multiple\"",
        ),
        (fog("sigma_t = 1\nalbedo = 1"), ""),
    ] {
        let radiative = format!("[radiative]\n{more}");
        let text = edited(&[(&edits.0, &edits.1), ("[radiative]", &radiative)]);
        all.push_str(&said_about(&text));
    }
    let spot = "spot = { position = [0, 3, 0], target = [0, 0, 0], intensity = 1, inner_angle = 1, outer_angle = 2 }";
    let sun = "directional = { direction = [0, -1, 0], irradiance = 1 }";
    let (glass, mirror) = ("glass = { index = 1.5 }", "mirror = { reflectance = 1 }");
    for edits in [
        [
            (POINT, sun),
            ("box = { min = [-1, -1, -1], max = [1, 1, 1] }\n", ""),
        ],
        [(POINT, POINT), (DIFFUSE, glass)],
        [(POINT, spot), (DIFFUSE, mirror)],
        [(POINT, sun), (DIFFUSE, mirror)],
    ] {
        all.push_str(&said_about(&edited(&edits)));
    }
    insta::assert_snapshot!(all, @r"
    6:15: a medium fills all space, and no light arrives from infinitely far away, as of `environment` help: give the medium a boundary: a `sphere`, `box` or closed `mesh`; or light the scene from within, by emitting surfaces, points or spots
    12:1: a medium that fills all space and emits or scatters without absorbing is infinitely bright help: give the medium a boundary: a `sphere`, `box` or closed `mesh`; or give it some absorption in every channel that it emits or scatters in, or limit `radiative.max_bounces`
    12:1: a medium that fills all space and emits or scatters without absorbing is infinitely bright help: give the medium a boundary: a `sphere`, `box` or closed `mesh`; or give it some absorption in every channel that it emits or scatters in, or limit `radiative.max_bounces`
    12:1: a medium that fills all space and emits or scatters without absorbing is infinitely bright help: give the medium a boundary: a `sphere`, `box` or closed `mesh`; or give it some absorption in every channel that it emits or scatters in, or limit `radiative.max_bounces`
    12:1: a medium that fills all space and emits or scatters without absorbing is infinitely bright help: give the medium a boundary: a `sphere`, `box` or closed `mesh`; or give it some absorption in every channel that it emits or scatters in, or limit `radiative.max_bounces`
    12:1: a medium that fills all space and emits or scatters without absorbing is infinitely bright help: give the medium a boundary: a `sphere`, `box` or closed `mesh`; or give it some absorption in every channel that it emits or scatters in, or limit `radiative.max_bounces`
    16:15: a medium fills all space, and no light arrives from infinitely far away, as of `directional` help: give the medium a boundary: a `sphere`, `box` or closed `mesh`; or light the scene from within, by emitting surfaces, points or spots
    16:1: camera paths cannot sample light from a point, spot or directional light that arrives by way of a mirror or glass help: use a small or far emitting surface, or the environment, in place of the light; or a diffuse surface
    16:1: camera paths cannot sample light from a point, spot or directional light that arrives by way of a mirror or glass help: use a small or far emitting surface, or the environment, in place of the light; or a diffuse surface
    16:1: camera paths cannot sample light from a point, spot or directional light that arrives by way of a mirror or glass help: use a small or far emitting surface, or the environment, in place of the light; or a diffuse surface
    ");
}

/// A light in the plane of a rectangle is refused, one beside or off it is not.
#[test]
fn lights_exactly_in_surfaces() {
    let scene = |lights: &str| {
        format!(
            "[camera]\neye = [0, 1, -4]\ntarget = [0, 1, 0]\n[radiative]\n\
             [[radiative.surface]]\n\
             rectangle = {{ corner = [-2, 5, -2], edge_u = [4, 0, 0], edge_v = [0, 0, 4] }}\n\
             diffuse = {{ reflectance = 0.5 }}\n{lights}"
        )
    };
    let point = |y: f64, x: f64| {
        format!("[[radiative.light]]\npoint = {{ position = [{x}, {y}, 0], intensity = 1 }}\n")
    };
    let lamp = |y: f64| {
        format!(
            "[[radiative.surface]]\n\
             rectangle = {{ corner = [-1, {y}, -1], edge_u = [1, 0, 0], edge_v = [0, 0, 1] }}\n\
             emitter = {{ radiance = 1 }}\n"
        )
    };
    for fine in [point(4.999, 0.0), point(5.0, 3.0), lamp(4.999)] {
        assert!(parse(&scene(&fine)).is_ok(), "{fine}");
    }
    let said = [point(5.0, 0.0), lamp(5.0)].map(|light| said_about(&scene(&light)));
    insta::assert_snapshot!(said.concat(), @r"
    8:1: the light stands exactly in a rectangle, on neither side of it help: move the light a little off the surface, to the side that it shines on
    5:1: an emitting rectangle lies exactly in another surface: either hides the other help: move the light a little off the surface, to the side that it shines on
    ");
}

/// Next to each of these lies a mistake.
#[test]
fn what_is_not_refused() {
    let body = format!("{BOX}\n{COEFFICIENTS}");
    let accept = |edits: &[(&str, &str)]| {
        let text = edited(edits);
        if let Err(error) = parse(&text) {
            panic!("{error}\n{text}");
        }
        assert!(schema_accepts(&text), "{text}");
    };
    let environment = ("[radiative]", "[radiative]\nenvironment = 1");
    accept(&[environment]);
    accept(&[environment, (&body, "g = 0.5")]);
    accept(&[environment, (&body, "")]);
    accept(&[(&body, "sigma_s = 1\nsigma_a = 1e-9")]);
    accept(&[(
        &body,
        "emission = [0, 0, 1]\nsigma_s = [0, 0, 1]\nsigma_a = 1e-9",
    )]);
    // Two media without boundary add up: the one absorbs what the other scatters.
    accept(&[(&body, "sigma_s = 1\n[[radiative.medium]]\nsigma_a = 1")]);
    let single = ("[radiative]", "[radiative]\nscattering = \"single\"");
    let bounded = ("[radiative]", "[radiative]\nmax_bounces = 4");
    for limit in [single, bounded] {
        accept(&[limit, (&body, "sigma_s = 1")]);
    }
    accept(&[single, (DIFFUSE, "glass = { index = 1.5 }")]);
    accept(&[(POINT, POINT), (DIFFUSE, "emitter = { radiance = 0 }")]);
    let spherical =
        format!("[[radiative.surface]]\n{SPHERE}\nemitter = {{ radiance = 1, sides = \"both\" }}");
    let light = format!("[[radiative.light]]\n{POINT}");
    accept(&[
        (&light, &spherical),
        (DIFFUSE, "mirror = { reflectance = 1 }"),
    ]);
    // A flat box reflects like the rectangle it is.
    accept(&[(SPHERE, "box = { min = [0, 0, 0], max = [1, 0, 1] }")]);
}

#[test]
fn at_most_64_media() {
    let medium = "[[radiative.medium]]\nsigma_a = 1\n";
    let with = |count: usize| {
        edited(&[(
            "[[radiative.light]]",
            &(medium.repeat(count - 1) + "[[radiative.light]]"),
        )])
    };
    assert_eq!(radiative(&parse(&with(64)).unwrap(), 0).media.len(), 64);
    insta::assert_snapshot!(said_about(&with(65)), @r"
    11:1: 65 tables of `medium` are too many: a scene has at most 64
    ");
}

#[test]
fn what_belongs_to_other_models() {
    let mut all = String::new();
    for text in [
        edited(&[("[camera]", "[transfer_function]\nfloor = 0.5\n[camera]")]),
        edited(&[("[camera]", "[sampling]\nsamples = 0\n[camera]")]),
        edited(&[("[camera]", "[sampling]\nsamples = 4294967296\n[camera]")]),
        edited(&[("[camera]", "[sampling]\nseed = -1\n[camera]")]),
        edited(&[("[camera]", "[sampling]\nspp = 1\n[camera]")]),
        edited(&[(
            "[camera]",
            "[classified]\nvolume.file = \"none.obj\"\n[camera]",
        )]),
        edited(&[("eye = [0, 0, -5]\n", "")]),
        edited(&[("target = [0, 0, 0]\n", "")]),
        edited(&[("target = [0, 0, 0]", "target = [0, 0, -5]")]),
        edited(&[("[camera]\neye = [0, 0, -5]\ntarget = [0, 0, 0]\n", "")]),
        edited(&[("[radiative]", "[radiative]\nscatering = \"none\"")]),
        edited(&[("[[radiative.light]]", "[[radiative.lights]]")]),
    ] {
        all.push_str(&said_about(&text));
    }
    insta::assert_snapshot!(all, @r#"
    1:1: a radiative scene has no densities for a transfer function
    2:11: `samples` must lie in [1, 2147483648], got 0
    2:11: `samples` must lie in [1, 2147483648], got 4294967296
    2:8: `seed` must lie in [0, 9223372036854775807], got -1
    2:1: unknown key `spp` in [sampling] help: allowed keys in [sampling]: samples, seed
    7:1: the file has more than one model: [classified], [radiative] help: keep exactly one of [classified], [radiative]
    1:1: missing key `eye` in [camera]
    1:1: missing key `target` in [camera]
    2:7: the camera is at its target, so it has no direction
    1:1: missing key `eye` in [camera]
    6:1: unknown key `scatering` in [radiative] help: did you mean `scattering`?
    16:13: unknown key `lights` in [radiative] help: did you mean `light`?
    "#);
}

/// What the declaration says about keys, the schema says too.
#[test]
fn the_schema_knows_which_keys_exclude_each_other() {
    assert!(schema_accepts(BASE));
    for (old, new) in [
        (SPHERE, ""),
        (
            SPHERE,
            "sphere = { centre = [0, 0, 0], radius = 1 }\nmesh = { file = \"a.obj\" }",
        ),
        (DIFFUSE, ""),
        (
            DIFFUSE,
            "diffuse = { reflectance = 0.5 }\nglass = { index = 1.5 }",
        ),
        (DIFFUSE, "diffuse = { reflectance = 1.5 }"),
        (DIFFUSE, "diffuse = { reflectance = [0, 0, 2] }"),
        (
            BOX,
            "box = { min = [-1, -1, -1], max = [1, 1, 1] }\nsphere = { centre = [0, 0, 0], radius = 1 }",
        ),
        (COEFFICIENTS, "sigma_t = 1"),
        (COEFFICIENTS, "albedo = 1"),
        (COEFFICIENTS, "sigma_t = 1\nalbedo = 1\nsigma_a = 1"),
        (POINT, ""),
        (
            POINT,
            "point = { position = [0, 3, 0], intensity = 1 }\ndirectional = { direction = [0, 1, 0], irradiance = 1 }",
        ),
        ("[radiative]", "[curve]\n[radiative]"),
        (
            "[radiative]",
            "[[panel]]\n[panel.curve]\n[panel.radiative]\n[radiative]",
        ),
    ] {
        let text = edited(&[(old, new)]);
        assert!(!schema_accepts(&text), "the schema accepts {new:?}");
        assert!(parse(&text).is_err(), "the reader accepts {new:?}");
    }
    assert!(!schema_accepts("[film]\n"));
    // A scene may leave its model to its panels.
    assert!(schema_accepts("[[panel]]\n[panel.curve]\n"));
    parse("[[panel]]\n[panel.curve]\n").unwrap();
}
