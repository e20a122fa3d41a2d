//! Conventions of other ray casters.

use crate::common::suite::{case_of, cases_of, film_of as film, root, suite, validated};
use crate::ray_caster::scenes::{PHONG, plain};
use glam::DVec3;
use std::ops::Range;
use std::sync::Arc;
use std::time::{Duration, Instant};
use volref::check::check_within;
use volref::compare::{Conditions, Picture, judge};
use volref::conventions::{
    CATALOGUE, Profile, RayCaster, bounds, images_by_chance, mean_of_places, under,
};
use volref::film::{Bits, Film};
use volref::geometry::{Camera, Transform, length_of};
use volref::judging::Verdict;
use volref::math::{pow, tan};
use volref::naming::ConventionSearch;
use volref::optics::{Appearance, Phong, TransferPoint, TransferPoints};
use volref::scene::format::{Key, Kind};
use volref::scene::{
    CONVENTIONS, Classified, Compositing, Conventions, LastStep, Model, Precision, Scene, Shadow,
};
use volref::suite::Case;
use volref::variations::mistakes;
use volref::volume::{Centring, Grid, Interpolation, Lattice};

/// The scene of `values` at the nodes of a lattice of 3 × 3 × 3, over the unit cube, with opacity
/// 1 − 2^−value over a length of 1, clamped to [0, 1], and white.
fn scene(value: impl Fn([usize; 3]) -> f64) -> Classified {
    let lattice = Lattice::new([3; 3], DVec3::splat(0.5), DVec3::ZERO).unwrap();
    let values = (0..27).map(|index| value(lattice.node(index)) as f32);
    let grid = Arc::new(Grid::new(lattice, values.collect()).unwrap());
    let mut scene = plain(grid);
    let point = |value: f64| TransferPoint {
        value,
        opacity: value,
        colour: DVec3::new(1.0, 0.5, 0.25),
    };
    let points = TransferPoints::new(vec![point(0.0), point(1.0)]).unwrap();
    scene.transfer_function.appearance = Appearance::Points(points);
    scene.transfer_function.reference_length = 1.0;
    scene
}

/// One without symmetries.
fn uneven() -> Classified {
    scene(|[i, j, k]| [0.1, 0.4, 0.9][i] * [0.9, 0.5, 0.1][j] * [0.3, 1.0, 0.6][k])
}

/// Red and opacity of the ray through the middle of the front face, under `conventions` as a scene states them.
fn seen(scene: &Classified, conventions: &str) -> [f64; 2] {
    let mut scene = scene.clone();
    scene.conventions = read(conventions).unwrap();
    let [red, _, _, opacity] = RayCaster::new(&scene).pixel([0, 0], [1, 1]).0;
    [red.into(), opacity.into()]
}

/// A pixel is stored in 32 bits.
const ROUNDING: f64 = f32::EPSILON as f64;

/// Transmittance of a uniform volume along a span of length 1, counted by hand.
#[test]
fn steps_and_opacities_of_a_uniform_volume() {
    let mut scene = scene(|_| 0.5);
    scene.step = 0.3;
    for (conventions, transmittance) in [
        ("", 0.5),
        ("first_sample = 0\nlast_step = 'whole'", pow(0.5, 1.2)),
        ("first_sample = 0.5\nlast_step = 'whole'", pow(0.5, 0.9)),
        ("first_sample = 1\nlast_step = 'whole'", pow(0.5, 0.9)),
        ("last_step = 'dropped'", pow(0.5, 0.9)),
        ("opacity = 'linear'", 0.85 * 0.85 * 0.85 * 0.95),
    ] {
        let [red, opacity] = seen(&scene, conventions);
        let off = opacity - (1.0 - transmittance);
        assert!(off.abs() < ROUNDING, "{conventions}");
        assert!((red - opacity).abs() < ROUNDING);
    }
}

/// Opacity of the ray through `scene` under conventions, compared with `transmittance`, counted by hand.
fn assert_passes(scene: &Classified, transmittance: f64, conventions: &str) {
    let [_, opacity] = seen(scene, conventions);
    let off = opacity - (1.0 - transmittance);
    assert!(off.abs() < ROUNDING, "{conventions}: off by {off}");
}

/// A profile states conventions about several objects alone, too; with rays that end early these are sampled by common
/// steps, or one volume is.
#[test]
fn profiles_of_several_objects() {
    let scene = |name: &str| case_of(name).load_scene().unwrap();
    let applied = |name: &str, keys: &str, conventions: &str| {
        let text = format!("name = 'mine'\n{keys}[conventions]\n{conventions}\n");
        let profile = Profile::parse(&text, "mine.toml").unwrap();
        profile.applied_to(&scene(name)).map(Option::unwrap)
    };
    let image = film;
    let early = "early_termination = 0.5\n";
    for (keys, conventions) in [("", "first_sample = 0"), (early, "")] {
        let refused = applied("scenes/two-fogs", keys, conventions).unwrap_err();
        assert!(refused.contains("volume_steps"), "{refused}");
    }
    // One volume among surfaces: its rays end early, without any other convention.
    let [whole, ended] = ["", early].map(|keys| applied("scenes/ball-in-rings", keys, "").unwrap());
    assert_ne!(image(&whole).radiance(), image(&ended).radiance());
}

/// With the eye inside, a near plane cuts every ray at one depth: a fifth of that half a spacing behind the far face,
/// which is 0.75 away.
#[test]
fn near_planes_cut_rays_at_a_depth() {
    let mut scene = scene(|_| 0.5);
    scene.step = 0.3;
    let eye = DVec3::new(0.5, 0.5, 0.25);
    let (target, half_height) = (eye + DVec3::Z, tan(0.3));
    scene.camera = Camera::new(eye, target, DVec3::Y, 0.6).unwrap();
    scene.conventions.near_plane = 0.2;
    let caster = RayCaster::new(&scene);
    for [column, row] in [[0, 0], [3, 1], [4, 4], [7, 2]] {
        let [_, _, _, opacity] = caster.pixel([column, row], [8, 8]).0;
        let [across, up] = [column, row].map(|it| ((it as f64 + 0.5) / 4.0 - 1.0) * half_height);
        // All rays leave by the far face.
        let length = (0.75 - 0.2) * length_of(DVec3::new(across, up, 1.0));
        let expected = 1.0 - pow(0.5, length);
        assert!(
            (f64::from(opacity) - expected).abs() < ROUNDING,
            "{column}, {row}"
        );
    }
}

/// Steps, boxes and corrections of a uniform volume: spans of length 1, half of the light passes it.
#[test]
fn steps_are_fitted_and_opacities_corrected() {
    let mut scene = scene(|_| 0.5);
    scene.step = 0.3;
    let passed = |length: f64| pow(0.5, length);
    // A table with an entry at 0.5.
    let in_table = "table_size = 3\nopacity_bits = 8\n";
    let entries = format!("{in_table}opacity_correction = 'entries'");
    let nominal = |fitted: &str| format!("fitted_steps = '{fitted}'\nstep_opacity = 'nominal'");
    for (transmittance, conventions) in [
        (passed(1.5), "box = 'voxels'"),
        (passed(1.0), "last_sample = 'face'"),
        (passed(1.0), "fitted_steps = 'rounded'"),
        (passed(1.0), "fitted_steps = 'up'"),
        (passed(1.0), "fitted_steps = 'down'"),
        (passed(0.9), &nominal("rounded")),
        (passed(1.2), &nominal("up")),
        (passed(0.9), &nominal("down")),
        // Over a step the opacity is 0.188; the last one is a third of a step.
        (0.5, "least_opacity = 0.18"),
        (1.0, "least_opacity = 0.19"),
        (0.5, "least_stated_opacity = 0.49"),
        (1.0, "least_stated_opacity = 0.51"),
        (0.9, "most_opacity = 0.1"),
        (passed(10.0 / 3.0), "uncorrected_opacity = 0.5"),
        (passed(1.0), "uncorrected_opacity = 0.49"),
        (128.0 / 255.0, &format!("{in_table}bit_rounding = 'down'")),
        (127.0 / 255.0, in_table),
        (pow(207.0 / 255.0, 10.0 / 3.0), &entries),
    ] {
        assert_passes(&scene, transmittance, conventions);
    }
    scene.compositing = Compositing::EarlyTermination(0.9);
    assert_passes(&scene, passed(0.3), "");
    assert_passes(&scene, 0.0, "ended_rays = 'opaque'");
}

/// Each profile that volref brings has an effect.
#[test]
fn shipped_profiles() {
    let own = opaque_scene("");
    let image = film;
    for name in Profile::shipped().filter(|name| *name != "anari") {
        let applied = Profile::named(name)
            .unwrap()
            .applied_to(&own)
            .unwrap()
            .unwrap();
        assert_ne!(image(&applied).radiance(), image(&own).radiance(), "{name}");
    }
}

/// Steps in voxels of a grid whose first axis is stretched: as many as the nodes ask for.
#[test]
fn steps_in_voxels() {
    let mut scene = scene(|_| 0.5);
    let lattice = Lattice::new([3; 3], DVec3::new(0.5, 0.5, 2.0), DVec3::ZERO).unwrap();
    scene.grid = Arc::new(Grid::new(lattice, scene.grid.values().to_vec()).unwrap());
    scene.step = 0.25;
    // Along the stretched axis half a voxel is a whole unit, of which the volume has four.
    for length in ["voxels", "main-axis"] {
        let line = format!("step_length = '{length}'\n");
        assert_passes(&scene, pow(0.5, 4.0), &line);
        assert_passes(&scene, 0.5, &(line + "step_opacity = 'nominal'"));
    }
}

/// Colours of classified nodes, interpolated with and without their opacities, in few bits.
#[test]
fn colours_of_classified_nodes() {
    let mut scene = scene(|[_, _, k]| [0.0, 1.0, 0.0][k]);
    let point = |value, opacity, colour| TransferPoint {
        value,
        opacity,
        colour: DVec3::splat(colour),
    };
    let points = vec![point(0.0, 0.2, 1.0), point(1.0, 0.6, 0.3)];
    scene.transfer_function.appearance = Appearance::Points(TransferPoints::new(points).unwrap());
    // One sample a quarter of the way in.
    scene.step = 1.0;
    for (more, expected) in [
        ("", [0.5 * (0.2 + 0.18), 0.4]),
        ("node_colours = 'separate'", [0.4 * 0.65, 0.4]),
        (
            "node_colours = 'separate'\nopacity_bits = 2",
            [0.5 * 0.65, 0.5],
        ),
        (
            "node_colours = 'separate'\ncolour_bits = 2",
            [0.4 * 2.0 / 3.0, 0.4],
        ),
    ] {
        let found = seen(
            &scene,
            &format!("first_sample = 0.25\nclassification = 'pre'\n{more}"),
        );
        let is_near = |k: usize| (found[k] - expected[k]).abs() < ROUNDING;
        assert!(is_near(0) && is_near(1), "{more}: {found:?}");
    }
}

/// Values in few bits, and fractions between them: one sample at a quarter of a voxel beyond the middle layer.
#[test]
fn values_and_fractions_in_few_bits() {
    let mut scene = scene(|[_, _, k]| [0.0, 0.3, 1.0][k]);
    scene.step = 1.0;
    let single = f64::from(0.3_f32);
    let half = f64::from(half::f16::from_f64(0.3));
    for (conventions, value, part) in [
        ("first_sample = 0.625", single, 0.25),
        ("first_sample = 0.625\nstored_values = 'f16'", half, 0.25),
        // 19660.5 of 65535 in decimals, a little more in 32 bits.
        (
            "first_sample = 0.625\nstored_values = 'u16'",
            19661.0 / 65535.0,
            0.25,
        ),
        (
            "first_sample = 0.625\nstored_values = 'u8'",
            77.0 / 255.0,
            0.25,
        ),
        ("first_sample = 0.625\nfraction_bits = 2", single, 0.25),
        // An eighth is half of a unit of two bits: rounded away from the layer before.
        ("first_sample = 0.5625", single, 0.125),
        ("first_sample = 0.5625\nfraction_bits = 2", single, 0.25),
    ] {
        assert_passes(&scene, (1.0 - value) * (1.0 - part), conventions);
    }
}

/// Parallel light is light from far away, in shading and in shadows.
#[test]
fn parallel_light() {
    let mut scene = uneven();
    scene.phong = Some(PHONG);
    scene.shadow = Some(Shadow {
        step: 0.1,
        reference_step: 1.0,
    });
    let centre = scene.grid.lattice().bounds().centre();
    scene.light = DVec3::new(-0.3, 1.1, -0.4);
    let [found, _] = seen(&scene, "parallel_light = true");
    assert!((found - seen(&scene, "")[0]).abs() > 1e-3);
    scene.light = centre + (scene.light - centre) * 1e7;
    let [expected, _] = seen(&scene, "");
    assert!((found - expected).abs() < 1e-6, "{found} {expected}");
}

/// Bounds and mean over all first samples: a jittered image lies between them.
#[test]
fn images_of_all_first_samples() {
    for random in [
        "jitter = true",
        "first_step_jitter = true",
        "unstated_first_sample = true",
    ] {
        let image = |line: &str| {
            let last = format!("[classified.conventions]\nlast_step = 'whole'\n{line}");
            opaque_scene(&last)
        };
        assert!(images_by_chance(&image("")).is_none());
        let scene = image(random);
        let images = images_by_chance(&scene).unwrap();
        let ([lower, upper], mean) = (bounds(&images), mean_of_places(&images));
        let film = film(&scene);
        let (mut is_wide, mut outside) = (false, 0);
        for index in 0..64 {
            let [least, most, mean, value] =
                [&lower, &upper, &mean, &film].map(|film| film.pixel(index));
            for channel in 0..4 {
                let (least, most) = (least[channel], most[channel]);
                assert!((least..=most).contains(&mean[channel]));
                is_wide |= most - least > 0.01;
                outside += usize::from(!(least - 1e-3..=most + 1e-3).contains(&value[channel]));
            }
        }
        assert!(is_wide && outside <= 8, "{random}: {is_wide} {outside}");
    }
}

/// Samples on the faces between voxels take one of both, by a rounding; others have one value.
#[test]
fn images_of_rounded_places() {
    let image = |volume: Classified| {
        let mut scene = opaque_scene("");
        let panel = &mut scene.panels[0];
        (panel.width, panel.height) = (1, 1);
        panel.model = Model::Classified(Box::new(volume));
        scene
    };
    let mut volume = scene(|[_, _, k]| [0.2, 0.7, 0.4][k]);
    volume.interpolation = Interpolation::Nearest;
    for (step, is_on_faces) in [(0.5, true), (0.35, false)] {
        volume.step = step;
        volume.conventions = Conventions::default();
        assert!(images_by_chance(&image(volume.clone())).is_none());
        volume.conventions.precision = Precision::F32;
        // Parallel to the last axis, whose voxels end at 0.25 and 0.75.
        let scene = image(volume.clone());
        let [lower, upper] = bounds(&images_by_chance(&scene).unwrap());
        let film = film(&scene);
        let [least, value, most] = [&lower, &film, &upper].map(|it| it.pixel(0)[3]);
        assert!((least..=most).contains(&value));
        assert_eq!(most - least > 0.05, is_on_faces, "{step}");
    }
    // A transmittance of a quarter, by two samples of a half, ends a ray or does not.
    let mut volume = self::scene(|_| 0.5);
    (volume.step, volume.transfer_function.reference_length) = (0.25, 0.25);
    volume.conventions.precision = Precision::F32;
    for (threshold, ends_by_rounding) in [(0.25, true), (0.26, false)] {
        volume.compositing = Compositing::EarlyTermination(threshold);
        let [lower, upper] = bounds(&images_by_chance(&image(volume.clone())).unwrap());
        let [least, most] = [lower, upper].map(|it| it.pixel(0)[3]);
        assert_eq!(most - least > 0.1, ends_by_rounding, "{least} {most}");
    }
}

/// Samples of a ramp at the beginning or the end of their steps.
#[test]
fn samples_at_the_beginning_and_the_end_of_steps() {
    let mut scene = scene(|[_, _, k]| 0.5 * k as f64);
    scene.step = 0.25;
    for (first_sample, places) in [
        (0.0, [0.0, 0.25, 0.5, 0.75]),
        (0.5, [0.125, 0.375, 0.625, 0.875]),
        (1.0, [0.25, 0.5, 0.75, 1.0]),
    ] {
        let passed = places.map(|z: f64| pow(1.0 - z, 0.25));
        let line = format!("first_sample = {first_sample:?}");
        assert_passes(&scene, passed.iter().product(), &line);
    }
}

/// A table of two entries is the straight line of two points; by nearest entry it is a step.
#[test]
fn tables() {
    let flat = |value: f64| scene(move |_| value);
    assert_eq!(seen(&flat(0.25), "table_size = 2"), seen(&flat(0.25), ""));
    let nearest = "table_lookup = 'nearest'";
    for (value, opacity, conventions) in [
        (0.25, 0.0, format!("table_size = 2\n{nearest}")),
        // The nearest of 0, 1/3, 2/3 and 1.
        (0.25, 1.0 / 3.0, format!("table_size = 4\n{nearest}")),
        // Between 0 and 1 as coordinates of a texture of two, and in quarters of an entry.
        (0.2, 0.0, "table_size = 2\ntable_place = 'texture'".into()),
        (0.4, 0.3, "table_size = 2\ntable_place = 'texture'".into()),
        (0.9, 1.0, "table_size = 2\ntable_place = 'texture'".into()),
        (0.2, 0.25, "table_size = 2\ntable_fraction_bits = 2".into()),
        (0.4, 0.5, "table_size = 2\ntable_fraction_bits = 2".into()),
        (0.9, 1.0, "table_size = 2\ntable_fraction_bits = 2".into()),
    ] {
        assert_passes(&flat(value), 1.0 - opacity, &conventions);
    }
}

/// A table of two entries in a texture of two, over the range of the densities: opacities are corrected there.
#[test]
fn a_table_in_a_texture() {
    let mut scene = scene(|[_, _, k]| [0.2, 0.4, 0.6][k]);
    scene.step = 1.0;
    let table = "table_size = 2\ntexture_size = 2\n";
    // The sample, in the middle, is half way between the entries 0.2 and 0.6.
    assert_passes(&scene, 0.6, table);
    scene.transfer_function.reference_length = 0.5;
    assert_passes(&scene, pow(0.6, 2.0), table);
    let corrected = format!("{table}opacity_correction = 'entries'");
    assert_passes(&scene, 0.5 * (pow(0.8, 2.0) + pow(0.4, 2.0)), &corrected);
    // A texture has its entries in the middle of texels.
    let mut scene = self::scene(|[_, _, k]| [0.2, 0.3, 0.6][k]);
    scene.step = 1.0;
    assert_passes(&scene, 0.8, table);
}

/// Where the transfer function is a straight line, nodes may be classified first; where it is not,
/// the pictures differ.
#[test]
fn preclassification() {
    let scene = scene(|[i, j, k]| ((i + j + k) % 2) as f64);
    let pre = "classification = 'pre'";
    let ([_, post], [_, before]) = (seen(&scene, ""), seen(&scene, pre));
    assert!((post - before).abs() < ROUNDING);
    let mut bent = scene.clone();
    let point = |value: f64, opacity: f64| TransferPoint {
        value,
        opacity,
        colour: DVec3::ONE,
    };
    let points = vec![point(0.0, 0.0), point(0.5, 0.9), point(1.0, 0.0)];
    bent.transfer_function.appearance = Appearance::Points(TransferPoints::new(points).unwrap());
    assert_eq!(seen(&bent, pre), [0.0, 0.0]);
    assert!(seen(&bent, "")[1] > 0.3);
}

/// Values at the centres of cells: the image of a grid of cells over the same box.
#[test]
fn values_at_the_centres_of_cells() {
    let mut scene = uneven();
    scene.step = 0.13;
    scene.phong = Some(PHONG);
    let nodes = scene.grid.lattice();
    let spacing = nodes.bounds().size() / 3.0;
    let cells = Lattice::new([3; 3], spacing, nodes.bounds().min + 0.5 * spacing).unwrap();
    let cells = cells.with_centring(Centring::Cells).unwrap();
    let mut of_cells = scene.clone();
    of_cells.grid = Arc::new(Grid::new(cells, scene.grid.values().to_vec()).unwrap());
    let conventions = "centring = 'cells'";
    let [red, opacity] = seen(&scene, conventions);
    let expected = seen(&of_cells, "");
    // Node coordinates differ in their last digits, and a pixel is stored in 32 bits.
    assert!(
        (red - expected[0]).abs() < 2.0 * ROUNDING,
        "{red} {expected:?}"
    );
    assert!((opacity - expected[1]).abs() < 2.0 * ROUNDING);
    assert_ne!([red, opacity], seen(&scene, ""));
    // Where there are cells, they stay.
    assert_eq!(seen(&of_cells, conventions), expected);
}

/// A ray of light through a uniform volume: the shadow's samples fill the way to the light, wherever
/// they lie in their steps; ambient light may pass it by.
#[test]
fn shadows() {
    let mut scene = scene(|_| 0.5);
    scene.phong = Some(PHONG);
    scene.light = DVec3::new(0.5, 0.5, -3.0);
    scene.shadow = Some(Shadow {
        step: 0.1,
        reference_step: 1.0,
    });
    let lit = |more: &str| seen(&scene, &format!("flat_samples = 'ambient'\n{more}"))[0];
    let in_shadow = lit("");
    for place in ["shadow_sample = 0.0", "shadow_sample = 1.0"] {
        assert!((lit(place) - in_shadow).abs() < ROUNDING);
    }
    // All of the light is ambient: as without a shadow.
    let mut unshadowed = scene.clone();
    unshadowed.shadow = None;
    let [expected, _] = seen(&unshadowed, "flat_samples = 'ambient'");
    let past_the_shadow = lit("shadowed_ambient = false");
    assert!((past_the_shadow - expected).abs() < ROUNDING);
    assert!(in_shadow < 0.95 * expected);
    // In a ramp towards the light, samples nearer to the point meet less of it.
    let mut ramp = self::scene(|[_, _, k]| 1.0 - 0.5 * k as f64);
    (ramp.light, ramp.shadow) = (scene.light, scene.shadow);
    let lit = |place: f64| seen(&ramp, &format!("shadow_sample = {place:?}"))[0];
    let [near, middle, far] = [0.0, 0.5, 1.0].map(lit);
    assert!(near > middle && middle > far, "{near} {middle} {far}");
}

/// Conventions in a scene file.
fn read(conventions: &str) -> Result<Conventions, String> {
    let text = format!(
        "[classified]\n[classified.volume]\nfile = 'fixtures/volumes/hard/hill.nrrd'\n\
         [classified.conventions]\n{conventions}\n"
    );
    let scene = Scene::parse(&text, &root().join("scene.toml"));
    let scene = scene.map_err(|error| error.to_string())?;
    Ok(scene.panels[0].classified().unwrap().conventions)
}

/// Keys that concern a single volume, composited; those of several objects are looked at in `several_volumes.rs`, those
/// of modes in `modes.rs`.
fn keys_of_one_volume() -> impl Iterator<Item = &'static Key> {
    const OTHERS: [&str; 6] = [
        "volume_steps",
        "volume_boxes",
        "sample_behind_ends",
        "isosurface_place",
        "isosurface_sides",
        "mean_colours",
    ];
    let keys = CONVENTIONS.keys.iter();
    keys.filter(|key| !OTHERS.contains(&key.name))
}

/// Each key with another value than volref's, and what that is to be told from: volref's own, or a table
/// where it says how tables are read.
fn every_value() -> Vec<(String, Conventions, Conventions)> {
    let mut all = Vec::new();
    for key in keys_of_one_volume() {
        let values: Vec<String> = match key.kind {
            Kind::Choice(words) => words.iter().map(|word| format!("{word:?}")).collect(),
            Kind::Flag => vec!["true".to_owned(), "false".to_owned()],
            Kind::Number(_) if key.name == "most_opacity" => vec!["0.3".to_owned()],
            Kind::Number(_) if key.name.ends_with("opacity") => {
                vec!["0.02".to_owned(), "0.05".to_owned()]
            }
            Kind::Number(_) => vec!["0.0".to_owned(), "1.0".to_owned()],
            Kind::Count(least, _) => vec![(least + 2).to_string(), (least + 14).to_string()],
            _ => panic!("{}: a kind without values here", key.name),
        };
        let without = match key.name {
            "table_lookup"
            | "table_place"
            | "table_fraction_bits"
            | "texture_size"
            | "colour_bits"
            | "opacity_bits"
            | "opacity_correction" => "table_size = 16\n",
            "bit_rounding" | "lookup_bits" => "table_size = 16\nopacity_bits = 8\n",
            "node_colours" => "classification = 'pre'\n",
            "one_sample" => "last_step = 'whole'\n",
            "step_opacity" => "fitted_steps = 'rounded'\n",
            _ => "",
        };
        let standard = read(without).unwrap();
        for value in values {
            let line = format!("{} = {value}", key.name);
            let other = read(&format!("{without}{line}")).unwrap();
            if other != standard {
                all.push((line, other, standard));
            }
        }
    }
    all
}

/// Pictures of volumes in which every convention has something to change: without symmetries, along
/// unequal sides, in light from all sides, in shadow, brighter than 1, and where nothing has a gradient.
fn pictures(conventions: Conventions) -> Vec<[f32; 4]> {
    let mut uneven = uneven();
    uneven.step = 0.13;
    // A wide highlight, which every pixel has a part of.
    uneven.phong = Some(Phong {
        shininess: 2,
        ..PHONG
    });
    uneven.light = DVec3::new(-2.0, 1.5, -1.0);
    uneven.transfer_function.appearance = crate::ray_caster::scenes::formula(0.36, "heat");
    let mut long = uneven.clone();
    let lattice = Lattice::new([3; 3], DVec3::new(0.5, 0.5, 2.0), DVec3::ZERO).unwrap();
    long.grid = Arc::new(Grid::new(lattice, uneven.grid.values().to_vec()).unwrap());
    let mut bright = uneven.clone();
    bright.phong = Some(Phong {
        ambient: 20.0,
        ..PHONG
    });
    let mut shadowed = uneven.clone();
    shadowed.shadow = Some(Shadow {
        step: 0.2,
        reference_step: 0.01,
    });
    let mut flat = scene(|_| 0.5);
    flat.phong = Some(PHONG);
    let mut ended = uneven.clone();
    ended.compositing = Compositing::EarlyTermination(0.9);
    // A step longer than any chord.
    let mut coarse = uneven.clone();
    coarse.step = 3.0;
    let mut sheared = uneven.clone();
    let rows = [
        [1.0, 0.6, 0.0, 0.0],
        [0.0, 0.5, 0.2, 0.0],
        [0.0, 0.0, 1.4, 0.0],
    ];
    sheared.to_world = Some(Transform::from_rows(rows).unwrap());
    let mut within = uneven.clone();
    within.camera = Camera::new(DVec3::splat(0.6), DVec3::ZERO, DVec3::Y, 0.6).unwrap();
    let mut scenes = vec![bright, shadowed, flat, ended, coarse, sheared, within];
    for corner in 0..8 {
        let side = |axis: usize| if corner >> axis & 1 == 1 { 4.0 } else { -3.0 };
        for mut scene in [uneven.clone(), long.clone()] {
            scene.light = DVec3::new(side(0), side(1), side(2));
            scenes.push(scene);
        }
    }
    let pixels = scenes.into_iter().flat_map(|mut scene| {
        scene.conventions = conventions;
        let caster = RayCaster::new(&scene);
        let pixels = (0..64).map(|index| caster.pixel([index % 8, index / 8], [8, 8]).0);
        pixels.collect::<Vec<_>>()
    });
    pixels.collect()
}

/// Every value of every key moves a pixel, and no two make the same pictures.
#[test]
fn every_convention_is_heard() {
    let choices = every_value();
    assert!(choices.len() > CONVENTIONS.keys.len(), "{}", choices.len());
    for key in keys_of_one_volume() {
        let is_of_key = |line: &str| line.split(' ').next() == Some(key.name);
        assert!(
            choices.iter().any(|(line, ..)| is_of_key(line)),
            "{}",
            key.name
        );
    }
    let mut known = vec![("volref's own".to_owned(), pictures(Conventions::default()))];
    for (line, conventions, standard) in choices {
        // It differs from `jitter` in how images are judged: no mean of all places is expected.
        if conventions.unstated_first_sample {
            continue;
        }
        let new = pictures(conventions);
        assert!(new != pictures(standard), "{line} moves no pixel");
        for (other, old) in &known {
            assert!(new != *old, "{line} looks like {other}");
        }
        known.push((line, new));
    }
    // The ambient term alone.
    let mut flat = scene(|_| 0.5);
    flat.phong = Some(PHONG);
    let ambient = "flat_samples = 'ambient'";
    let ([full, _], [part, _]) = (seen(&flat, ""), seen(&flat, ambient));
    assert!((part - PHONG.ambient * full).abs() < ROUNDING);
}

/// A scene in which nothing is transparent, under these conventions.
fn opaque_scene(conventions: &str) -> Scene {
    let text = format!(
        "[film]\nwidth = 8\nheight = 8\n[transfer_function]\nreference_length = 0.25\n\
         point = [{{ value = 0, colour = [1, 0.5, 0], opacity = 0.1 }}, \
         {{ value = 1, colour = [0, 0.5, 1], opacity = 0.3 }}]\n\
         [classified]\nstep = 0.11\n[classified.phong]\n[classified.shadow]\nstep = 0.2\n\
         {conventions}\n[classified.volume]\nfile = '../../volumes/hard/hill.nrrd'\n"
    );
    Scene::parse(&text, &root().join("fixtures/scenes/hard/scene.toml")).unwrap()
}

/// A table of conventions in a scene.
#[test]
fn conventions_in_a_scene() {
    let expected = Conventions {
        first_sample: 1.0,
        last_step: LastStep::Whole,
        precision: Precision::F32,
        ..Conventions::default()
    };
    let found = read("first_sample = 1.0\nlast_step = 'whole'\nprecision = 'f32'");
    assert_eq!(found, Ok(expected));
    for (wrong, message) in [
        ("last_step = 'half'", "last_step"),
        ("first_sample = 1.5", "[0, 1]"),
    ] {
        let error = read(wrong).unwrap_err();
        assert!(error.contains(message), "{wrong}: {error}");
    }
}

/// What a profile states is read as it was.
#[test]
fn conventions_become_lines_and_lines_conventions() {
    let (_, scene) = small("figures/figure-5");
    // The panel with a shadow.
    let of = |scene: &Scene| {
        scene
            .panels
            .last()
            .unwrap()
            .classified()
            .unwrap()
            .conventions
    };
    assert!(of(&scene).lines().is_empty());
    for (_, conventions, _) in every_value() {
        let lines = conventions.lines().join("\n");
        assert_eq!(read(&lines), Ok(conventions), "{lines}");
    }
    for index in 0..CATALOGUE.len() {
        let expected = of(&under(&scene, &[index]));
        let lines = expected.lines().join("\n");
        assert_eq!(read(&lines), Ok(expected), "{lines}");
    }
}

/// Every two conventions that a search may find together can be stated together.
#[test]
fn pairs_of_conventions_do_not_contradict_each_other() {
    let scene = opaque_scene("");
    for first in 0..CATALOGUE.len() {
        for second in first + 1..CATALOGUE.len() {
            if CATALOGUE[first].choice == CATALOGUE[second].choice {
                continue;
            }
            let both = under(&scene, &[first, second]);
            let lines = both.panels[0].classified().unwrap().conventions.lines();
            let profile = format!("name = 'both'\n[conventions]\n{}", lines.join("\n"));
            if let Err(error) = Profile::parse(&profile, "both.toml") {
                let words = [first, second].map(|index| CATALOGUE[index].words);
                panic!("{words:?}: {error}");
            }
        }
    }
}

/// A case of the suite and its scene, with few pixels.
fn small(name: &str) -> (&'static Case, Scene) {
    let case = case_of(name);
    let mut scene = case.load_scene().unwrap();
    for panel in &mut scene.panels {
        (panel.width, panel.height) = (96, 96);
    }
    (case, scene)
}

fn picture(scene: &Scene) -> Picture {
    Picture::Radiance(film(scene))
}

/// Whether an image of `right` is one of `test`, by the deterministic gate.
fn passes(right: &Scene, test: &Picture) -> bool {
    let (right, gate) = (picture(right), volref::compare::Gate::Deterministic);
    judge(gate, &right, test, &Conditions::default())
        .unwrap()
        .passed
}

/// Two conventions behind a picture are found, neither without need nor short of one, and a mistake is not taken for one.
#[test]
fn conventions_are_told_from_mistakes() {
    let (case, scene) = small("figures/figure-3");
    let index = |words: &str| {
        let found = CATALOGUE
            .iter()
            .position(|other| other.words.contains(words));
        found.unwrap_or_else(|| panic!("{words}"))
    };
    let search = ConventionSearch::default();
    for words in [
        ["Sobel", "half vector"],
        // Without the first, every pixel is within its tolerance, and the mean is not.
        ["stated opacity below 0.01", "shines in parallel"],
    ] {
        let set = words.map(index).to_vec();
        let test = film(&under(&scene, &set));
        let found = search.explain(case, &scene, &test, None).unwrap();
        assert_eq!(found.set, set);
        assert_eq!(found.but_for, 0.0);
    }
    // Of all others, `how_often_conventions_are_named`.
    let mistake = mistakes::named("opacity-halved").unwrap();
    let wrong = mistake.in_scene(&scene).unwrap();
    let found = search.explain(case, &scene, &film(&wrong), None);
    assert_eq!(found, None);
}

/// Normals stretched along the axes of the eye are those stretched along the volume's where the two are parallel, and
/// in other views they are not.
#[test]
fn normals_stretched_by_the_box() {
    let stretched = |along: &str| {
        let words = format!("stretches normals by the proportions of the volume{along}");
        CATALOGUE.iter().position(|other| other.words == words)
    };
    let [of_volume, of_eye] = ["", ", along the axes of the eye"].map(stretched);
    let (_, scene) = small("figures/figure-3");
    let pictures = |scene: &Scene| {
        let [of_volume, of_eye] = [of_volume, of_eye].map(|index| under(scene, &[index.unwrap()]));
        (of_volume, picture(&of_eye))
    };
    let (of_volume, of_eye) = pictures(&scene);
    assert!(passes(&of_volume, &of_eye));
    assert!(!passes(&scene, &of_eye));
    let oblique = scene.with_volumes(|volume| {
        let eye = DVec3::new(1.3, 1.2, -0.4);
        let target = DVec3::new(0.325, 0.505, 0.31);
        volume.camera = Camera::new(eye, target, DVec3::Y, 0.8).unwrap();
    });
    let (of_volume, of_eye) = pictures(&oblique);
    assert!(!passes(&of_volume, &of_eye));
}

/// What tests of another renderer call gives the verdict of `volref validate`.
#[test]
fn a_check_explains_by_conventions() {
    let mut scene = small("figures/figure-1").1;
    for panel in &mut scene.panels {
        (panel.width, panel.height) = (256, 256);
    }
    let convention = CATALOGUE.iter().position(|c| c.words.contains("Sobel"));
    let film = film(&under(&scene, &[convention.unwrap()]));
    let result = check_within("figures/figure-1", &film, 1e4).unwrap();
    assert_eq!(result.verdict, Verdict::Convention, "{}", result.reason);
    assert_eq!(result.conventions, ["takes gradients by Sobel's filter"]);
    let profile = "name = \"mine\"\n[conventions]\ngradient = \"sobel\"\n";
    assert_eq!(result.profile.as_deref(), Some(profile));
    assert!(result.looks_like.is_empty());
}

/// A set as words.
fn in_words(set: &[usize]) -> Vec<&'static str> {
    set.iter().map(|&index| CATALOGUE[index].words).collect()
}

/// A set of one to six conventions, each of another choice, by number: those whose words come first in an order of
/// this number. A new convention joins few of the sets, and the others stay as they are.
fn random_set(number: usize) -> Vec<usize> {
    let place = |index: &usize| {
        let words = CATALOGUE[*index].words;
        *blake3::hash(format!("{number} {words}").as_bytes()).as_bytes()
    };
    let mut order: Vec<usize> = (0..CATALOGUE.len()).collect();
    order.sort_by_key(place);
    let mut set: Vec<usize> = Vec::new();
    for next in order {
        let is_same = |&other: &usize| CATALOGUE[other].choice == CATALOGUE[next].choice;
        if set.len() <= number % 6 && !set.iter().any(is_same) {
            set.push(next);
        }
    }
    set.sort_unstable();
    set
}

/// `film` as codes of 8 bits, linear.
fn in_eight_bits(film: &Film) -> Film {
    let bits = "8-linear".parse::<Bits>().unwrap();
    bits.of_png(0.0).rounded(film)
}

/// Numbers of the random sets: those of `VOLREF_SETS`, such as `20..40`, else of a hundred.
fn numbers_of_sets() -> Range<usize> {
    let text = std::env::var("VOLREF_SETS").unwrap_or("0..100".to_owned());
    let ends = text.split_once("..").expect("VOLREF_SETS=20..40");
    let [first, end] = [ends.0, ends.1].map(|end| end.parse().expect("VOLREF_SETS=20..40"));
    first..end
}

/// How often the right set of conventions is named, from images of 32 and of 8 bits: the figures in the guide.
///
/// A set is found if it is named, or another one whose image passes the gate for it. One that is named with a
/// rest, of pixels or of the mean, is not found.
#[test]
#[ignore = "minutes"]
fn how_often_conventions_are_named() {
    let (case, scene) = small("figures/figure-3");
    for rounded in [false, true] {
        let mut longest = Duration::ZERO;
        let (mut named, mut same, mut seen, mut unclaimed) = (0, 0, 0, 0);
        for number in numbers_of_sets() {
            let set = random_set(number);
            let film = film(&under(&scene, &set));
            let film = if rounded { in_eight_bits(&film) } else { film };
            let test = Picture::Radiance(film.clone());
            if passes(&scene, &test) {
                continue; // it changes too little to be judged
            }
            // One that is a mistake of the catalogue, too, is not claimed by itself.
            let alone = |&index: &usize| {
                !CATALOGUE[index].stands_alone && passes(&under(&scene, &[index]), &test)
            };
            if set.iter().any(alone) {
                unclaimed += 1;
                continue;
            }
            seen += 1;
            let start = Instant::now();
            let found = ConventionSearch::default().explain(case, &scene, &film, None);
            let taken = start.elapsed();
            longest = longest.max(taken);
            match found {
                Some(found) if found.set == set => named += 1,
                Some(found) if passes(&under(&scene, &found.set), &test) => same += 1,
                found => {
                    let found = found.map(|found| (in_words(&found.set), found.but_for));
                    println!("{number}, {taken:.1?}: {found:?} for {:?}", in_words(&set));
                }
            }
        }
        println!(
            "{} bits, {seen} sets: {named} named, {same} by another set of the same image; {unclaimed} more are a \
             mistake by themselves; the longest search took {longest:.1?}",
            if rounded { 8 } else { 32 }
        );
        assert!(100 * (named + same) >= 95 * seen);
    }
}

/// How often a mistake is called a convention, of images of 32 and of 8 bits, with the work that `validate` gives to
/// an image. Each mistake is made in one or two of the cases, others than the one before it.
#[test]
#[ignore = "half an hour"]
fn how_often_mistakes_are_called_conventions() {
    let cases = ["figures/figure-1", "sampled"].map(cases_of).concat();
    let (mut wrong, mut made) = (0, 0);
    for (number, case) in cases.into_iter().enumerate() {
        let scene = case.load_scene().unwrap();
        let right = film(&scene);
        for mistake in mistakes::catalogue().skip(number % 12).step_by(12) {
            let of_the_scene = mistake.in_scene(&scene).map(|scene| film(&scene));
            let Some(film) = of_the_scene.or_else(|| mistake.in_image(&right)) else {
                continue;
            };
            for film in [in_eight_bits(&film), film] {
                let mut judged = validated(case, film);
                if judged.result.verdict != Verdict::Fail {
                    continue;
                }
                made += 1;
                let search = ConventionSearch::default();
                search.explain_mismatch(case, &suite().store(), &mut judged, 10.0, false);
                if judged.result.verdict == Verdict::Convention {
                    println!("{}: {}: {}", case.name, mistake.name, judged.result.reason);
                    wrong += 1;
                }
            }
        }
    }
    println!("{made} pictures with a mistake: {wrong} called a convention");
    assert!(100 * wrong <= 2 * made);
}
