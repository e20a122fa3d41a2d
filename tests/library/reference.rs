//! The plain renderers of `src/reference` and the fast ones of `src/render` make the same images.
//!
//! Classified volumes agree to the bit, on the suite and on generated scenes; so does the ray caster
//! for conventions of other renderers, under those of volref. Radiative scenes are
//! sampled by two programs that share no random number and hardly a method, so their images agree
//! by the stochastic gate: pixel by pixel they differ by noise, and by no more.

use crate::any_scene::scenes;
use crate::common::suite::{root, scene_files, scene_of};
use crate::needs::tries;
use rayon::prelude::*;
use std::collections::BTreeSet;
use volref::compare::stochastic;
use volref::conventions as conventional;
use volref::faulty_tracer::FaultyTracer;
use volref::film::Film;
use volref::geometry::length_of;
use volref::math::rng::philox4x32_10;
use volref::reference::{self, ReferenceError};
use volref::render::{Sampling, Seed, plans, render};
use volref::scene::{Classified, Conventions, Mode, Model, Scene};
use volref::variations::mistakes;

/// Radiative scenes that the plain path tracer cannot render within a test, and what holds them
/// instead: known answers, which `volref verify` and the unit tests `hard_cases` check.
const HELD_BY_KNOWN_ANSWERS: [(&str, &str); 6] = [
    (
        "hard/d10-tiny-and-huge-voxels",
        "1e12 null collisions a path under one majorant",
    ),
    (
        "hard/d7-bright-voxel-glow",
        "a majorant of 20000 for one voxel",
    ),
    (
        "hard/e2-seen-through-80",
        "an optical depth of 80, which no collision estimator passes",
    ),
    (
        "hard/e2-thick-and-thin",
        "a majorant of 100000 for one of three channels",
    ),
    (
        "hard/e5-endless-glow",
        "an endless medium that is transparent in one channel",
    ),
    (
        "hard/s10-coloured-scattering",
        "a majorant of 1000, where one channel has 0.001",
    ),
];

/// `scene` with panels of `side` × `side` pixels at most.
fn small(mut scene: Scene, side: usize) -> Scene {
    for panel in &mut scene.panels {
        panel.width = panel.width.min(side);
        panel.height = panel.height.min(side);
    }
    scene
}

fn rendered(scene: &Scene, sampling: Sampling) -> Result<Film, String> {
    let rendering = render(&plans(scene), sampling, &|| {});
    rendering
        .map(|rendering| rendering.film)
        .map_err(|error| error.to_string())
}

fn plain(scene: &Scene, sampling: Sampling) -> Result<Film, ReferenceError> {
    let centres: Vec<bool> = plans(scene).iter().map(|plan| !plan.is_sampled()).collect();
    reference::render(scene, sampling, &centres)
}

fn all(scene: &Scene, is: impl Fn(&Model) -> bool) -> bool {
    scene.panels.iter().all(|panel| is(&panel.model))
}

/// The panels of classified volumes, without conventions, by the ray caster for conventions, which composites samples;
/// `film` is that of a scene that does not.
fn by_conventions(scene: &Scene, film: &Film) -> Film {
    if !all(scene, is_composited) {
        return film.clone();
    }
    let panels = scene.panels.iter().map(|panel| {
        let classified = panel.classified().unwrap();
        assert_eq!(classified.conventions, Conventions::default());
        conventional::render(classified, [panel.width, panel.height])
    });
    Film::side_by_side(&panels.collect::<Vec<_>>())
}

fn is_composited(model: &Model) -> bool {
    matches!(model, Model::Classified(scene) if scene.mode == Mode::Composited)
}

/// Composited from samples of one volume, or projected, or passed: an integral has one renderer, whose opponent is in
/// `limits.rs`; several volumes agree up to rounding (`several_volumes.rs`).
fn is_sampled(model: &Model) -> bool {
    matches!(model, Model::Classified(scene) if !scene.continuous && !scene.has_objects())
}

#[test]
fn classified_scenes_of_the_suite_agree_to_the_bit() {
    let mut compared = 0;
    for (name, path) in scene_files() {
        let scene = small(Scene::load(&path).unwrap(), 40);
        if all(&scene, is_sampled) {
            let (fast, plain) = (
                rendered(&scene, SAMPLING).unwrap(),
                plain(&scene, SAMPLING).unwrap(),
            );
            assert_eq!(fast, plain, "{name}");
            assert_eq!(by_conventions(&scene, &plain), plain, "{name}");
            compared += 1;
        }
    }
    assert!(compared >= 21, "{compared} classified scenes");
}

/// Generated scenes that are compared.
const GENERATED: usize = tries(200, 600);

/// Density lookups of the largest scene that is compared; a shadow ray at every sample.
const MOST_LOOKUPS: f64 = 1e5;

fn lookups(scene: &Classified, pixels: usize) -> f64 {
    let across = length_of(scene.grid.lattice().bounds().size());
    let shadow = scene.shadow.map_or(0.0, |shadow| across / shadow.step);
    pixels as f64 * (across / scene.step) * (1.0 + shadow)
}

#[test]
fn generated_classified_scenes_agree_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let (mut compared, mut refused, mut with_light) = (0, 0, 0);
    for number in 0.. {
        if compared == GENERATED {
            break;
        }
        let list: Vec<u32> = (0..200)
            .map(|i| philox4x32_10([i, number, 0, 0], [7, 0])[0])
            .collect();
        let written = scenes::written(&list);
        if !written.text.contains("[classified]") {
            continue;
        }
        for (name, bytes) in &written.files {
            std::fs::write(folder.path().join(name), bytes).unwrap();
        }
        let Ok(scene) = Scene::parse(&written.text, &folder.path().join("scene.toml")) else {
            continue;
        };
        let scene = small(scene, 8);
        let Model::Classified(classified) = &scene.panels[0].model else {
            panic!("a classified scene");
        };
        if classified.continuous || lookups(classified, 64) > MOST_LOOKUPS {
            continue;
        }
        match (rendered(&scene, SAMPLING), plain(&scene, SAMPLING)) {
            (Ok(fast), Ok(plain)) => {
                assert_eq!(fast, plain, "{}", written.text);
                assert_eq!(by_conventions(&scene, &plain), plain, "{}", written.text);
                let lit = |pixel: &[f32; 3]| pixel.iter().any(|&channel| channel > 0.0);
                with_light += usize::from(plain.radiance().iter().any(lit));
                compared += 1;
            }
            (Err(_), Err(_)) => refused += 1,
            (fast, plain) => panic!("{fast:?}\n{plain:?}\n{}", written.text),
        }
    }
    println!("{compared} agree, {with_light} of them not black; both refuse {refused}");
    assert!(with_light >= GENERATED / 2, "{with_light} not black");
}

/// Pixels along each side of sampled images: four blocks of the stochastic gate.
const SIDE: usize = 16;

/// Samples of both programs, and their seed.
const SAMPLING: Sampling = Sampling {
    samples: Some(32),
    seed: Seed::Given(1),
};

/// What the stochastic gate finds against `test`, one of `cases` images that are judged by `right`;
/// nothing where they agree. Images that agree to 16 roundings of 32-bit numbers need no gate: where
/// every sample is the same, the noise that an image states is rounding, and so is the difference.
fn fault(right: &Film, test: &Film, cases: usize) -> Option<String> {
    let pixels = right
        .radiance()
        .iter()
        .flatten()
        .zip(test.radiance().iter().flatten());
    let mut differences = pixels.map(|(a, b)| (a - b).abs() / a.abs().max(b.abs()).max(1e-30));
    if differences.all(|difference| difference <= 8.0 * f32::EPSILON) {
        return None;
    }
    let judgement = stochastic::judge(right, test, cases).unwrap();
    (!judgement.passed).then_some(judgement.reason)
}

/// The radiative scenes of the suite, small, but for those held by known answers.
fn radiative() -> Vec<(String, Scene)> {
    let mut scenes = Vec::new();
    for (name, path) in scene_files() {
        if HELD_BY_KNOWN_ANSWERS.iter().any(|(held, _)| *held == name) {
            continue;
        }
        // 80 mean free paths without absorption: as many bounces as all other scenes together.
        let side = if name == "hard/e7-thick-furnace" {
            4
        } else {
            SIDE
        };
        let scene = small(Scene::load(&path).unwrap(), side);
        if all(&scene, |model| matches!(model, Model::Radiative(_))) {
            scenes.push((name, scene));
        }
    }
    scenes
}

#[test]
fn radiative_scenes_of_the_suite_agree_within_noise() {
    let scenes = radiative();
    let faults: Vec<String> = scenes
        .par_iter()
        .filter_map(|(name, scene)| {
            let (fast, plain) = (
                rendered(scene, SAMPLING).unwrap(),
                plain(scene, SAMPLING).unwrap(),
            );
            Some(format!("{name}: {}", fault(&fast, &plain, scenes.len())?))
        })
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(scenes.len() >= 110, "{} radiative scenes", scenes.len());
}

/// Area lights in a room: one-sided, two-sided and tilted, without right angles, a sphere, a mesh.
const AREA_LIGHTS: [&str; 5] = [
    "rectangle = { corner = [-1.5, 7, 3.5], edge_u = [3, 0, 0], edge_v = [0, 0, 3] }\nemitter = { radiance = 12 }",
    "rectangle = { corner = [-1.5, 4, 3.5], edge_u = [3, 1, 0], edge_v = [0, 0, 3] }\nemitter = { radiance = [12, 3, 6], sides = \"both\" }",
    "rectangle = { corner = [-1.5, 7, 3.5], edge_u = [3, 0, 0], edge_v = [1, 0, 3] }\nemitter = { radiance = 12 }",
    "sphere = { centre = [0, 4, 5], radius = 0.8 }\nemitter = { radiance = 12 }",
    "mesh = { file = \"fixtures/meshes/gem.obj\" }\ntranslate = [2, 4, 5]\nemitter = { radiance = 12 }",
];

/// Media in the room: grey, coloured that overlap, heterogeneous.
const MEDIA: [&str; 3] = [
    "box = { min = [-5, 0, 0], max = [5, 8, 10] }\nsigma_s = 0.3",
    "box = { min = [-5, 0, 0], max = [5, 8, 10] }\nsigma_s = [0.3, 0.1, 0.02]\nsigma_a = [0, 0.05, 0.1]\ng = 0.7\n\
     [[radiative.medium]]\nsphere = { centre = [1, 3, 4], radius = 2 }\nsigma_s = [0.1, 0.5, 1]\ng = -0.4",
    "box = { min = [-5, 0, 0], max = [5, 8, 10] }\nsigma_s = 0.3\nsigma_a = 0.03\n\
     noise = { octaves = 3, lacunarity = 2, gain = 0.5, scale = [0.7, 1.2, 0.7], max_density = 2, threshold = 1 }",
];

fn room(light: &str, medium: &str) -> Scene {
    let text = format!(
        "title = \"room\"\n[film]\nwidth = {SIDE}\nheight = {SIDE}\n\
         [camera]\neye = [0, 4, -11.5]\ntarget = [0, 3.9, 5]\nup = [0, 1, 0]\nvertical_fov = 37\n\
         [radiative]\nscattering = \"multiple\"\n\
         [[radiative.surface]]\ndiffuse = {{ reflectance = 0.5 }}\n\
         rectangle = {{ corner = [-5, 0, 0], edge_u = [10, 0, 0], edge_v = [0, 0, 10] }}\n\
         [[radiative.surface]]\n{light}\n[[radiative.medium]]\n{medium}\n"
    );
    Scene::parse(&text, &root().join("room.toml")).unwrap()
}

/// Whatever the light and the medium, the fast renderer finds the light that the plain one finds: the
/// mean of each image to four standard errors, 1 to 5 % of it. With lights that are hit after a collision
/// counted whole, each scene is off by 7 to 54 standard errors.
#[test]
fn area_lights_in_media_agree_within_noise() {
    assert_agreement_in_rooms(&AREA_LIGHTS, &MEDIA);
}

/// Lamps whose light comes by a mirror alone, through glass, by a mirror and glass.
const BY_MIRRORS_AND_GLASS: [&str; 5] = [
    "rectangle = { corner = [-1.5, 5, 3.5], edge_u = [0, 0, 3], edge_v = [3, 0, 0] }\nemitter = { radiance = 12 }\n\
     [[radiative.surface]]\nrectangle = { corner = [-3, 8, 2], edge_u = [6, 0, 0], edge_v = [0, 0, 6] }\nmirror = { reflectance = [0.9, 0.6, 0.3] }",
    "rectangle = { corner = [-1.5, 7, 3.5], edge_u = [3, 0, 0], edge_v = [0, 0, 3] }\nemitter = { radiance = 12 }\n\
     [[radiative.surface]]\nsphere = { centre = [0, 3, 4], radius = 2 }\nglass = { index = 1.5 }",
    "sphere = { centre = [0, 7, 5], radius = 0.7 }\nemitter = { radiance = 30 }\n\
     [[radiative.surface]]\nsphere = { centre = [0, 0, 0], radius = 1 }\nscale = [2, 1, 1.5]\nrotate = { axis = [1, 1, 0], angle = 30 }\ntranslate = [0, 3, 4]\nglass = { index = 1.3 }",
    "rectangle = { corner = [-1.5, 7, 3.5], edge_u = [3, 0, 0], edge_v = [0, 0, 3] }\nemitter = { radiance = 12 }\n\
     [[radiative.surface]]\nmesh = { file = \"fixtures/meshes/gem.obj\" }\nscale = [2, 2, 2]\ntranslate = [0, 3, 5]\nglass = { index = 1.5 }",
    "rectangle = { corner = [-1.5, 5, 3.5], edge_u = [0, 0, 3], edge_v = [3, 0, 0] }\nemitter = { radiance = 12 }\n\
     [[radiative.surface]]\nsphere = { centre = [2, 7, 5], radius = 1 }\nmirror = { reflectance = 0.9 }\n\
     [[radiative.surface]]\nsphere = { centre = [-1, 3, 3], radius = 1.5 }\nglass = { index = 1.5 }",
];

/// Media beside which light by mirrors and glass is not lost.
const THIN_MEDIA: [&str; 3] = [
    "box = { min = [-5, 0, 0], max = [5, 8, 10] }\nsigma_a = [0.05, 0.02, 0.01]",
    "box = { min = [-5, 0, 0], max = [5, 8, 10] }\nsigma_s = 0.05\ng = 0.5",
    MEDIA[2],
];

/// The same by way of mirrors and glass. With lights counted whole behind a chain that begins at a
/// vertex, four scenes are off by 4 to 8 standard errors; behind one that begins at the eye, three.
#[test]
fn light_by_mirrors_and_glass_agrees_within_noise() {
    assert_agreement_in_rooms(&BY_MIRRORS_AND_GLASS, &THIN_MEDIA);
}

fn assert_agreement_in_rooms(lights: &[&str], media: &[&str]) {
    let sampling = Sampling {
        samples: Some(512),
        ..SAMPLING
    };
    let scenes = lights
        .iter()
        .flat_map(|light| media.iter().map(move |medium| (light, medium)));
    let faults: Vec<String> = scenes
        .collect::<Vec<_>>()
        .par_iter()
        .flat_map_iter(|(light, medium)| {
            let scene = room(light, medium);
            let fast = rendered(&scene, sampling).unwrap();
            let plain = plain(&scene, sampling).unwrap();
            (0..3).filter_map(move |c| {
                let sum = |film: &Film| -> [f64; 2] {
                    let noise = film.noise().unwrap();
                    let variance = noise.variance().iter().map(|v| f64::from(v[c])).sum();
                    let radiance = film.radiance().iter().map(|r| f64::from(r[c])).sum();
                    [radiance, variance]
                };
                let ([a, of_a], [b, of_b]) = (sum(&fast), sum(&plain));
                let z = (a - b) / (of_a + of_b).sqrt();
                println!("{light}, channel {c}: {a:.2} for {b:.2}, {z:.2} standard errors");
                (z.abs() > 4.0).then(|| format!("{light} in {medium}, channel {c}: {a} for {b}"))
            })
        })
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The double of the plain path tracer makes no mistake of its own.
#[test]
fn the_double_without_a_fault_is_the_reference_to_the_bit() {
    for name in WITH_MISTAKES {
        let mut scene = small(scene_of(name), 12);
        let panel = scene.panels.remove(0);
        let Model::Radiative(radiative) = &panel.model else {
            panic!("{name} is radiative");
        };
        let size = [panel.width, panel.height];
        let tracer = FaultyTracer::new(radiative, None);
        let pixels = (0..size[0] * size[1]).into_par_iter().map(|pixel| {
            let place = [pixel % size[0], pixel / size[0]];
            tracer.pixel(place, size, 1.0, (7, 4)).unwrap()
        });
        let film = Film::of_moments(size, &pixels.collect::<Vec<_>>(), 4);
        let sampling = Sampling {
            samples: Some(4),
            seed: Seed::Given(7),
        };
        let plain = reference::path_tracer::render(radiative, size, sampling, false);
        assert_eq!(Ok(film), plain, "{name}");
    }
}

/// Scenes in which mistakes are made, with occasions for many.
const WITH_MISTAKES: [&str; 6] = [
    "fog/absorption",
    "fog/forward",
    "hard/s9-cone-of-light",
    "procedural/coloured",
    "procedural/emissive-grid",
    "smoke/cornell",
];

/// The comparison is worth something: a mistake in the plain renderer shows.
#[test]
fn mistakes_in_the_reference_are_found() {
    let scenes = radiative();
    let scenes_in_all = scenes.len();
    let scenes = scenes
        .iter()
        .filter(|(name, _)| WITH_MISTAKES.contains(&name.as_str()));
    let mut found = BTreeSet::new();
    for (name, scene) in scenes {
        let right = rendered(scene, SAMPLING).unwrap();
        for mistake in mistakes::catalogue() {
            // Found once is found.
            if found.contains(mistake.name) {
                continue;
            }
            let Some(wrong) = mistake.in_scene(scene) else {
                continue;
            };
            let wrong = plain(&wrong, SAMPLING).unwrap();
            match fault(&right, &wrong, scenes_in_all) {
                Some(_) => _ = found.insert(mistake.name),
                None => println!("{name}: {} is not seen", mistake.name),
            }
        }
    }
    println!("{} mistakes found: {found:?}", found.len());
    assert!(found.len() >= 10, "only {found:?}");
}
