//! The core set: 25 cases, and what of the placement of a volume each of them shows.

use crate::common::suite::{film_of, suite};
use glam::{DMat3, DVec3};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use volref::compare::{Conditions, Gate, Picture, judge};
use volref::film::Film;
use volref::geometry::Transform;
use volref::scene::{Model, Scene};

#[test]
fn twenty_five_cases_of_the_suite() {
    let suite = suite();
    let names: BTreeSet<&String> = suite.core().iter().collect();
    assert_eq!((names.len(), suite.core().len()), (25, 25));
    let selected = suite.select(&["core".to_owned()]).unwrap();
    assert_eq!(selected.len(), 25);
    // The families that are asked first come first; the last, of hard cases, has none.
    let families = suite.families(&selected);
    assert_eq!(families[0].name, "sampled");
    let hard = suite.families(&suite.cases().iter().collect::<Vec<_>>());
    assert_eq!(hard.last().unwrap().name, "hard");
    assert!(families.iter().all(|family| family.name != "hard"));
    assert!(hard.iter().all(|family| family.asks.is_some()));
}

/// Maps of a volume about the middle of its box: the symmetries of the cube but the identity, named by where x, y and
/// z go; one scale of all axes, and of each; shears of each axis along the next.
fn maps() -> Vec<(String, DMat3)> {
    const AXES: [&str; 3] = ["x", "y", "z"];
    const ORDERS: [[usize; 3]; 6] = [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ];
    let mut maps = Vec::new();
    for order in ORDERS {
        for signs in 0..8 {
            let is_back = |axis: usize| signs >> axis & 1 == 1;
            let image = |axis: usize| match is_back(axis) {
                true => -DVec3::AXES[order[axis]],
                false => DVec3::AXES[order[axis]],
            };
            let name = |axis: usize| [["+", "-"][usize::from(is_back(axis))], AXES[order[axis]]];
            let name = [0, 1, 2].map(|axis| name(axis).concat()).join(" ");
            maps.push((name, DMat3::from_cols(image(0), image(1), image(2))));
        }
    }
    maps.retain(|(_, map)| *map != DMat3::IDENTITY);
    // A tenth is less than the aspect of voxels that are no cubes, and more than rounding.
    const TENTH: f64 = 0.1;
    maps.push(("scale".to_owned(), DMat3::IDENTITY * (1.0 + TENTH)));
    for (axis, name) in AXES.iter().enumerate() {
        let along = DVec3::AXES[axis];
        let scale = DMat3::from_diagonal(DVec3::ONE + along * TENTH);
        maps.push((format!("scale of {name}"), scale));
        let next = (axis + 1) % 3;
        let mut shear = DMat3::IDENTITY;
        *shear.col_mut(next) += along * TENTH;
        maps.push((format!("shear of {} along {name}", AXES[next]), shear));
    }
    maps
}

/// The scene with its first volume mapped about the middle of its box; `None` if it has no volume of voxels.
fn mapped(scene: &Scene, map: DMat3) -> Option<Scene> {
    let mut scene = scene.clone();
    let Model::Classified(volume) = &mut scene.panels[0].model else {
        return None;
    };
    let placed = volume.to_world.unwrap_or(Transform::IDENTITY);
    let middle = placed.point(volume.grid.lattice().bounds().centre());
    let map = Transform::from_matrix(map, DVec3::ZERO).and_then(|map| map.about(middle));
    volume.to_world = Some(placed.then(&map.unwrap()));
    Some(scene)
}

/// The image at half the size, where a case needs a quarter of the time and shows the same.
fn image(scene: &Scene) -> Film {
    let mut scene = scene.clone();
    for panel in &mut scene.panels {
        (panel.width, panel.height) = (panel.width / 2, panel.height / 2);
    }
    film_of(&scene)
}

/// Whether another image fails beside the right one.
fn differs(right: &Film, other: &Film) -> bool {
    let [right, other] = [right, other].map(|film| Picture::Radiance(film.clone()));
    let judged = judge(Gate::Deterministic, &right, &other, &Conditions::default());
    !judged.unwrap().passed
}

/// A renderer that passes the core set has no axis exchanged or reversed, no wrong scale, no shear, and no image from the
/// wrong side: each is seen in some case. The table says in which it is not.
#[test]
fn each_symmetry_of_the_cube_is_broken_by_a_case() {
    let suite = suite();
    let mut scenes = Vec::new();
    for name in suite.core() {
        let case = suite.case(name).unwrap();
        let scene = case.load_scene().unwrap();
        if case.sampling.is_none() && matches!(scene.panels[0].model, Model::Classified(_)) {
            let right = image(&scene);
            scenes.push((name, scene, right));
        }
    }
    let mut unseen_by_case = vec![Vec::new(); scenes.len()];
    let mut all = 0;
    let mut note = |what: String, is_seen: Vec<bool>| {
        all += 1;
        assert!(
            is_seen.contains(&true),
            "no case of the core set shows: {what}"
        );
        for (unseen, _) in unseen_by_case
            .iter_mut()
            .zip(is_seen)
            .filter(|(_, seen)| !seen)
        {
            unseen.push(what.clone());
        }
    };
    for (what, map) in maps() {
        let is_seen = |(_, scene, right): &(_, Scene, Film)| {
            mapped(scene, map).is_some_and(|scene| differs(right, &image(&scene)))
        };
        note(what, scenes.iter().map(is_seen).collect());
    }
    for (what, mistake) in [
        ("mirrored image", "mirrored"),
        ("image upside down", "upside-down"),
    ] {
        let mistake = volref::variations::mistakes::named(mistake).unwrap();
        let is_seen = |(_, _, right): &(_, Scene, Film)| {
            mistake
                .in_image(right)
                .is_some_and(|film| differs(right, &film))
        };
        note(what.to_owned(), scenes.iter().map(is_seen).collect());
    }
    let mut table = format!("breaks, of {all} maps\n");
    for ((name, ..), unseen) in scenes.iter().zip(&unseen_by_case) {
        let but = match unseen.is_empty() {
            true => String::new(),
            false => format!(", not: {}", unseen.join("; ")),
        };
        writeln!(table, "{name}: {}{but}", all - unseen.len()).unwrap();
    }
    insta::assert_snapshot!(table);
}
