//! The family `bricks`: goldens against the formula of their field, without a grid; files that hold the same grid; and
//! what is said of renderers that store volumes in bricks and are wrong at their borders.

use crate::common::suite::{
    case_of, cases_of, film_of as rendered, golden_of, searched, validated,
};
use crate::sampled::{composited, number, rays, span, table_of, vector};
use glam::{DVec3, dvec3};
use std::sync::Arc;
use volref::film::Film;
use volref::judging::Verdict;
use volref::math::{cos, sin};
use volref::scene::Classified;
use volref::suite::Case;
use volref::variations::mistakes;
use volref::volume::{Grid, Lattice};

fn case(name: &str) -> &'static Case {
    case_of(&format!("bricks/{name}"))
}

/// Three whole numbers.
fn counts(value: &toml::Value) -> [i64; 3] {
    vector(value).to_array().map(|count| count as i64)
}

/// The field of a volume table by node coordinates: of a ramp the linear function, of spots the values of the eight
/// nodes around, by the rule of the table and weighted.
fn field(volume: &toml::Value) -> impl Fn(DVec3) -> f64 {
    let nodes = counts(&volume["nodes"]);
    let slope = volume.get("slope").map(vector);
    let value = number(&volume["value"]);
    let every = volume.get("every").map(|every| every.as_integer().unwrap());
    let bright = volume.get("bright").map_or(1.0, number);
    let spots = volume.get("spot").and_then(toml::Value::as_array);
    let spots: Vec<([i64; 3], f64)> = spots
        .into_iter()
        .flatten()
        .map(|spot| (counts(&spot["node"]), number(&spot["value"])))
        .collect();
    let at_node = move |node: [i64; 3]| {
        if let Some((_, value)) = spots.iter().rev().find(|(at, _)| *at == node) {
            return *value;
        }
        let is_bright = every.is_some_and(|every| {
            (0..3).all(|axis| match nodes[axis] > every {
                true => node[axis] % every == 0,
                false => node[axis] == nodes[axis] / 2,
            })
        });
        if is_bright { bright } else { value }
    };
    move |at: DVec3| {
        if let Some(slope) = slope {
            return value + slope.dot(at);
        }
        let low = at.floor();
        let part = at - low;
        let weighted = (0..8).map(|corner: u32| {
            let is_high = [0, 1, 2].map(|axis| corner >> axis & 1 == 1);
            let weights = [0, 1, 2].map(|axis| match is_high[axis] {
                true => part[axis],
                false => 1.0 - part[axis],
            });
            let node = [0, 1, 2].map(|axis| low[axis] as i64 + i64::from(is_high[axis]));
            weights.iter().product::<f64>() * at_node(node)
        });
        weighted.sum()
    }
}

/// The ray in the coordinates of the volume, which is turned about z, then moved, if at all.
fn in_volume(volume: &toml::Value, (origin, direction): (DVec3, DVec3)) -> (DVec3, DVec3) {
    let Some(rotate) = volume.get("rotate") else {
        return (origin, direction);
    };
    assert_eq!(vector(&rotate["axis"]), DVec3::Z);
    let angle = -number(&rotate["angle"]).to_radians();
    let turned = |v: DVec3| {
        let (sine, cosine) = (sin(angle), cos(angle));
        dvec3(cosine * v.x - sine * v.y, sine * v.x + cosine * v.y, v.z)
    };
    (
        turned(origin - vector(&volume["translate"])),
        turned(direction),
    )
}

/// Each golden has the radiance of samples of the formula, to the rounding of its 32 bits: values of colours below
/// 1, and positions of samples that are off by some 2⁻⁴⁰ of the volume.
#[test]
fn goldens_are_those_of_the_formula() {
    let cases = cases_of("bricks");
    assert!(cases.len() >= 16);
    for case in &cases {
        let scene = table_of(&case.scene);
        let volume = &scene["classified"]["volume"];
        let (nodes, spacing) = (counts(&volume["nodes"]), vector(&volume["spacing"]));
        let first = vector(&volume["origin"]);
        let size = spacing * DVec3::from_array(nodes.map(|count| (count - 1) as f64));
        let field = field(volume);
        let step = &scene["classified"]["step"];
        let step = match step.as_str() {
            Some(text) => {
                let voxels: f64 = text.split(' ').next().unwrap().parse().unwrap();
                voxels * spacing.min_element()
            }
            None => number(step),
        };
        let (film, rays) = (golden_of(&case.name), rays(&scene));
        assert_eq!(rays.len(), film.radiance().len());
        let mut shown = 0;
        for (index, (&ray, found)) in rays.iter().zip(film.radiance()).enumerate() {
            let (origin, direction) = in_volume(volume, ray);
            let centred = origin - (first + 0.5 * size);
            let [near, far] = span(0.5 * size, (centred, direction));
            let count = ((far - near) / step).ceil() as u32;
            let sample = |index: u32| {
                let begin = near + step * f64::from(index);
                let end = (begin + step).min(far);
                let point = origin + direction * (0.5 * (begin + end));
                (field((point - first) / spacing), end - begin)
            };
            let samples: Vec<(f64, f64)> = (0..count).map(sample).collect();
            shown += usize::from(count > 0);
            let right = composited(&scene, &samples);
            let error = (right - DVec3::from(found.map(f64::from)))
                .abs()
                .max_element();
            let name = &case.name;
            assert!(error < 1e-6, "{name}, pixel {index}: {right} and {found:?}");
        }
        assert!(8 * shown > rays.len(), "{}: {shown} pixels", case.name);
    }
}

/// The verdict on an image of a case whose grid or conventions an edit has changed.
fn verdict(case: &Case, edit: impl FnMut(&mut Classified)) -> (Verdict, Film) {
    let wrong = rendered(&case.load_scene().unwrap().with_volumes(edit));
    (validated(case, wrong.clone()).result.verdict, wrong)
}

/// The grid with the value of each node from another one, or none.
fn with_nodes(volume: &mut Classified, of: impl Fn([usize; 3]) -> Option<[usize; 3]>) {
    let grid = &volume.grid;
    let lattice = *grid.lattice();
    let values = (0..grid.values().len()).map(|index| {
        let from = of(lattice.node(index));
        from.map_or(0.0, |node| grid.values()[lattice.index(node)])
    });
    volume.grid = Arc::new(Grid::new(lattice, values.collect()).unwrap());
}

/// Mistakes of bricks are named with the size of the brick.
#[test]
fn mistakes_of_bricks_are_named() {
    for (name, mistake) in [
        ("ramp-31-32-33", "brick-borders-doubled-16"),
        ("ramp-37-19-10", "atlas-width-wrong"),
        ("ramp-63-64-65", "brick-borders-dropped-32"),
        ("bands-129-127-31", "brick-borders-clamped-16"),
        ("spots-of-8", "samples-counted-from-bricks-of-8"),
        ("spots-of-8", "brick-borders-clamped-8"),
        ("ramp-below-zero", "signed-read-as-unsigned"),
        ("ramp-of-16-bits", "low-byte-left-out"),
    ] {
        let case = case(name);
        let scene = case.load_scene().unwrap();
        let wrong = mistakes::named(mistake).unwrap().in_scene(&scene).unwrap();
        let said = searched(case, rendered(&wrong)).looks_like.first().cloned();
        assert_eq!(said.as_deref(), Some(mistake), "{name}");
    }
}

/// Axes in another direction or order are named in cases of every family with grids, whatever places them: each is made here
/// from the nodes of the right volume.
#[test]
fn reversed_and_exchanged_axes_are_named() {
    type Source = fn([usize; 3], [usize; 3]) -> [usize; 3];
    let reversed_x: Source = |[i, j, k], [nx, _, _]| [nx - 1 - i, j, k];
    let reversed_z: Source = |[i, j, k], [_, _, nz]| [i, j, nz - 1 - k];
    // A file read as though z ran fastest.
    let other_order: Source = |[i, j, k], [nx, ny, nz]| {
        let index = k + nz * (j + ny * i);
        [index % nx, index / nx % ny, index / (nx * ny)]
    };
    // array[x, y, z] of an array whose axes are z, y, x.
    let other_indices: Source = |[i, j, k], [nx, _, nz]| [k.min(nx - 1), j, i.min(nz - 1)];
    for (name, source, mistake) in [
        ("scenes/turned", reversed_z, "volume-reversed-along-z"),
        ("scenes/oblique", reversed_x, "volume-reversed-along-x"),
        (
            "scenes/maximum-exact",
            reversed_z,
            "volume-reversed-along-z",
        ),
        (
            "sampled/perspective-z-up",
            reversed_z,
            "volume-reversed-along-z",
        ),
        (
            "sampled/parallel-z-up",
            reversed_x,
            "volume-reversed-along-x",
        ),
        (
            "bricks/ramp-37-19-10",
            reversed_z,
            "volume-reversed-along-z",
        ),
        ("scenes/turned", other_order, "volume-axes-exchanged"),
        ("bricks/ramp-31-32-33", other_order, "volume-axes-exchanged"),
        ("scenes/oblique", other_indices, "volume-indices-reversed"),
        (
            "bricks/ramp-37-19-10",
            other_indices,
            "volume-indices-reversed",
        ),
    ] {
        let case = case_of(name);
        let edit = |volume: &mut Classified| {
            let nodes = volume.grid.lattice().nodes();
            with_nodes(volume, |node| Some(source(node, nodes)));
        };
        let said = searched(case, verdict(case, edit).1)
            .looks_like
            .first()
            .cloned();
        assert_eq!(said.as_deref(), Some(mistake), "{name}");
    }
    // Coordinates of a texture in another order: the box stays, the counts of nodes are exchanged.
    let case = case_of("scenes/sheared");
    let edit = |volume: &mut Classified| {
        let (old, bounds) = (*volume.grid.lattice(), volume.grid.lattice().bounds());
        let [nx, ny, nz] = old.nodes();
        let counts = DVec3::new(nz as f64, ny as f64, nx as f64);
        let lattice =
            Lattice::new([nz, ny, nx], bounds.size() / (counts - 1.0), bounds.min).unwrap();
        let values = (0..lattice.node_count()).map(|index| {
            let [i, j, k] = lattice.node(index);
            volume.grid.values()[old.index([k, j, i])]
        });
        volume.grid = Arc::new(Grid::new(lattice, values.collect()).unwrap());
    };
    let said = searched(case, verdict(case, edit).1)
        .looks_like
        .first()
        .cloned();
    assert_eq!(said.as_deref(), Some("volume-transposed"));
}
