//! Volumes that a map places in the world.
//!
//! A second evaluation knows the edges of the volume in the world, and no matrix: points are found
//! between its faces by Cramer's rule, distances and directions are of the world from the start.
//! Its field is linear, so that it has a closed form between and at the nodes.

use crate::common::suite::{self, film_of as rendered};
use glam::{DMat3, DVec3};
use std::fmt::Write as _;
use std::path::Path;
use volref::conventions as conventional;
use volref::film::Film;
use volref::geometry::{Direction, Ray, Transform};
use volref::math::{exp_m1, ln_1p, powu};
use volref::reference;
use volref::render::Sampling;
use volref::scene::{Classified, Scene};
use volref::variations::mistakes;
use volref::volume::{LoadOptions, Orientation, load_hashed};

/// Nodes of the ramp, and their distances: the box ends at the outermost.
const NODES: [usize; 3] = [5, 4, 3];
const SPACING: DVec3 = DVec3::new(0.25, 0.5, 0.5);
const FIRST: DVec3 = DVec3::new(-0.25, 1.0, -0.5);
/// The field at the first node, and its change from face to face: multiples of 1/64, which are exact
/// numbers at each node.
const BASE: f64 = 0.125;
const CHANGES: DVec3 = DVec3::new(0.25, 0.375, 0.25);

const SIDE: usize = 14;

/// Rows of maps: a turn, an uneven scale, a shear, a reflection, all of them, and a shear of a condition
/// of a million.
const MAPS: [[[f64; 4]; 3]; 6] = [
    [
        [0.6, -0.8, 0.0, 3.0],
        [0.8, 0.6, 0.0, -1.0],
        [0.0, 0.0, 1.0, 0.5],
    ],
    [
        [2.0, 0.0, 0.0, 0.0],
        [0.0, 0.5, 0.0, 0.0],
        [0.0, 0.0, 1.5, 0.0],
    ],
    [
        [1.0, 0.7, 0.0, 0.0],
        [0.0, 1.0, -0.4, 0.0],
        [0.2, 0.0, 1.0, 0.0],
    ],
    [
        [-1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
    ],
    [
        [0.3, -1.1, 0.4, 7.0],
        [0.9, 0.2, -0.5, 1.0],
        [0.1, 0.6, 1.7, -2.0],
    ],
    [
        [1.0, 1000.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
    ],
];

fn nrrd(header: &str, values: impl Iterator<Item = f64>) -> Vec<u8> {
    let [nx, ny, nz] = NODES;
    let mut bytes = format!(
        "NRRD0004\ntype: float\ndimension: 3\nsizes: {nx} {ny} {nz}\nencoding: raw\nendian: little\n{header}\n\n"
    )
    .into_bytes();
    bytes.extend(values.flat_map(|value| (value as f32).to_le_bytes()));
    bytes
}

const UPRIGHT: &str = "spacings: 0.25 0.5 0.5\nspace dimension: 3\nspace origin: (-0.25,1,-0.5)";

/// The ramp, x fastest, or a constant field.
fn ramp(changes: DVec3) -> impl Iterator<Item = f64> {
    let [nx, ny, nz] = NODES;
    (0..nx * ny * nz).map(move |index| {
        let node = [index % nx, index / nx % ny, index / (nx * ny)];
        let share = DVec3::from_array([0, 1, 2].map(|axis| {
            // A third of 0.375 is exact, of a share in thirds it is not.
            node[axis] as f64 * changes[axis] / (NODES[axis] - 1) as f64
        }));
        BASE + share.element_sum()
    })
}

const LOOK: &str = "[transfer_function]\nreference_length = 0.4\npoint = [\n\
    { value = 0, colour = [1, 0.1, 0.2], opacity = 0.05 },\n\
    { value = 1, colour = [0.1, 0.5, 1], opacity = 0.4 },\n]\n";

/// The scene of the file `ramp.nrrd` in `folder`, with keys of the volume, of `[classified]`, and an eye.
fn scene_of(folder: &Path, volume: &str, more: &str, view: &str) -> Scene {
    let text = format!(
        "film = {{ width = {SIDE}, height = {SIDE} }}\n{LOOK}[camera]\n{view}\n\
         [classified]\nbackground = [0.1, 0.2, 0.3]\n{more}\n[classified.volume]\nfile = \"ramp.nrrd\"\n{volume}\n"
    );
    Scene::parse(&text, &folder.join("scene.toml"))
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn volume(scene: &Scene) -> &Classified {
    scene.panels[0].classified().unwrap()
}

/// The fast, the plain and the counted caster, which agree to the bit.
fn by_all(scene: &Scene) -> Film {
    let fast = rendered(scene);
    assert_eq!(
        fast,
        reference::render(scene, Sampling::default(), &[true]).unwrap()
    );
    assert_eq!(fast, conventional::render(volume(scene), [SIDE; 2]));
    fast
}

/// A field between the faces of a volume, by shares of its edges.
trait Field {
    fn value(&self, shares: DVec3) -> f64;

    /// Changes of the value from face to face.
    fn changes(&self, shares: DVec3) -> DVec3;
}

/// A linear one.
struct Ramp(DVec3);

impl Field for Ramp {
    fn value(&self, shares: DVec3) -> f64 {
        BASE + shares.dot(self.0)
    }

    fn changes(&self, _: DVec3) -> DVec3 {
        self.0
    }
}

/// Values at nodes, x fastest, between which they are interpolated; and their central differences.
struct Nodes {
    nodes: [usize; 3],
    values: Vec<f64>,
}

impl Nodes {
    fn between<T>(&self, shares: DVec3, at: impl Fn([usize; 3]) -> T) -> T
    where
        T: Copy + std::ops::Mul<f64, Output = T> + std::ops::Add<Output = T>,
    {
        let places = [0, 1, 2].map(|axis| {
            let last = (self.nodes[axis] - 1) as f64;
            let place = (shares[axis] * last).clamp(0.0, last);
            let low = (place as usize).min(self.nodes[axis] - 2);
            (low, place - low as f64)
        });
        let corners = (0..8).map(|corner| {
            let upper = [0, 1, 2].map(|axis| corner >> axis & 1);
            let weights = [0, 1, 2].map(|axis| {
                let part = places[axis].1;
                if upper[axis] == 1 { part } else { 1.0 - part }
            });
            at([0, 1, 2].map(|axis| places[axis].0 + upper[axis])) * weights.iter().product::<f64>()
        });
        corners.reduce(|sum, corner| sum + corner).unwrap()
    }

    fn at(&self, [i, j, k]: [usize; 3]) -> f64 {
        self.values[(k * self.nodes[1] + j) * self.nodes[0] + i]
    }
}

impl Field for Nodes {
    fn value(&self, shares: DVec3) -> f64 {
        self.between(shares, |node| self.at(node))
    }

    fn changes(&self, shares: DVec3) -> DVec3 {
        self.between(shares, |node| {
            let inner = [0, 1, 2].map(|axis| node[axis].clamp(1, self.nodes[axis] - 2));
            DVec3::from_array([0, 1, 2].map(|axis| {
                let (mut before, mut after) = (inner, inner);
                (before[axis], after[axis]) = (inner[axis] - 1, inner[axis] + 1);
                0.5 * (self.at(after) - self.at(before)) * (self.nodes[axis] - 1) as f64
            }))
        })
    }
}

/// A volume by its edges in the world.
struct Slanted {
    corner: DVec3,
    /// For each edge the vector that is 1 along it and 0 along the others: the normal of two faces.
    across: [DVec3; 3],
    /// Shortest edge of a cell.
    voxel: f64,
}

impl Slanted {
    /// That of the ramp.
    fn new(rows: [[f64; 4]; 3]) -> Slanted {
        Slanted::of(rows, FIRST, SPACING, NODES)
    }

    fn of(rows: [[f64; 4]; 3], first: DVec3, spacing: DVec3, nodes: [usize; 3]) -> Slanted {
        let image = |p: DVec3, one: f64| {
            DVec3::from_array(rows.map(|[x, y, z, o]| x * p.x + y * p.y + z * p.z + o * one))
        };
        let cells = [0, 1, 2].map(|axis| image(DVec3::AXES[axis] * spacing[axis], 0.0));
        let edges = [0, 1, 2].map(|axis| cells[axis] * (nodes[axis] - 1) as f64);
        let size = edges[0].dot(edges[1].cross(edges[2]));
        Slanted {
            corner: image(first, 1.0),
            across: [0, 1, 2].map(|i| edges[(i + 1) % 3].cross(edges[(i + 2) % 3]) / size),
            voxel: cells
                .map(DVec3::length)
                .into_iter()
                .fold(f64::INFINITY, f64::min),
        }
    }

    fn shares(&self, point: DVec3) -> DVec3 {
        DVec3::from_array(self.across.map(|across| (point - self.corner).dot(across)))
    }

    /// The gradient by points of the world, from changes by shares.
    fn gradient(&self, changes: DVec3) -> DVec3 {
        let [x, y, z] = self.across;
        x * changes.x + y * changes.y + z * changes.z
    }

    /// Distances at which a ray from `origin` is inside.
    fn span(&self, origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        let (mut near, mut far) = (0.0_f64, f64::INFINITY);
        for across in self.across {
            let ends = [0.0, 1.0]
                .map(|face| (face - (origin - self.corner).dot(across)) / direction.dot(across));
            near = near.max(ends[0].min(ends[1]));
            far = far.min(ends[0].max(ends[1]));
        }
        (near < far).then_some([near, far])
    }
}

/// Middles and lengths of steps.
fn steps([near, far]: [f64; 2], step: f64) -> impl Iterator<Item = (f64, f64)> {
    let count = ((far - near) / step).ceil() as usize;
    (0..count).map(move |index| {
        let begin = near + index as f64 * step;
        let length = step.min(far - begin);
        (begin + 0.5 * length, length)
    })
}

/// Colour and opacity by value.
type Look<'l> = &'l dyn Fn(f64) -> (DVec3, f64);

/// The points of the table of the ramp, in closed form.
fn look(value: f64) -> (DVec3, f64) {
    let (low, high) = (DVec3::new(1.0, 0.1, 0.2), DVec3::new(0.1, 0.5, 1.0));
    (low + (high - low) * value, 0.05 + 0.35 * value)
}

fn opacity(opacity: f64, steps: f64) -> f64 {
    -exp_m1(ln_1p(-opacity) * steps)
}

/// A pixel by the second evaluation.
fn expected(
    scene: &Classified,
    box_: &Slanted,
    field: &dyn Field,
    look: Look<'_>,
    ray: &Ray,
    step: f64,
) -> DVec3 {
    let (mut colour, mut passes) = (DVec3::ZERO, 1.0);
    let Some(span) = box_.span(ray.origin, *ray.direction) else {
        return scene.background;
    };
    for (t, length) in steps(span, step) {
        let point = ray.origin + *ray.direction * t;
        let shares = box_.shares(point);
        let (mut source, stated) = look(field.value(shares));
        let to_light = scene.light - point;
        let gradient = box_.gradient(field.changes(shares));
        if let (Some(phong), Some(normal)) = (scene.phong, Direction::of(-gradient)) {
            let light = to_light.normalize();
            let cosine = normal.dot(light);
            let (ambient, base) = (source * phong.ambient, source);
            source = ambient;
            if cosine > 0.0 {
                let mirrored = *normal * (2.0 * cosine) - light;
                let highlight = powu((-mirrored.dot(*ray.direction)).max(0.0), phong.shininess);
                source +=
                    base * (phong.diffuse * cosine) + DVec3::splat(phong.specular * highlight);
            }
        }
        if let Some(shadow) = scene.shadow {
            let towards = to_light.normalize();
            let [_, far] = box_.span(point, towards).unwrap_or([0.0, 0.0]);
            for (t, length) in steps([0.0, far.min(to_light.length())], shadow.step) {
                let (_, a) = look(field.value(box_.shares(point + towards * t)));
                source *= 1.0 - opacity(a, length / shadow.reference_step);
            }
        }
        let a = opacity(stated, length / scene.transfer_function.reference_length);
        colour += source * (a * passes);
        passes *= 1.0 - a;
    }
    colour + scene.background * passes
}

/// Largest difference of a channel from the second evaluation, and pixels that see the volume.
fn farthest(
    film: &Film,
    scene: &Classified,
    box_: &Slanted,
    field: &dyn Field,
    look: Look<'_>,
    step: f64,
) -> (f64, usize) {
    let (mut worst, mut seen) = (0.0_f64, 0);
    let size = [film.width(), film.height()];
    for (index, pixel) in film.radiance().iter().enumerate() {
        let ray = scene.camera.ray([index % size[0], index / size[0]], size);
        let right = expected(scene, box_, field, look, &ray, step);
        seen += usize::from(right != scene.background);
        let found = DVec3::from_array(pixel.map(f64::from));
        worst = worst.max((found - right).abs().max_element());
    }
    (worst, seen)
}

/// The same of an image of the ramp.
fn off(
    film: &Film,
    scene: &Classified,
    changes: DVec3,
    rows: [[f64; 4]; 3],
    step: f64,
) -> (f64, usize) {
    farthest(
        film,
        scene,
        &Slanted::new(rows),
        &Ramp(changes),
        &look,
        step,
    )
}

fn folder_with(changes: DVec3) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("ramp.nrrd"),
        nrrd(UPRIGHT, ramp(changes)),
    )
    .unwrap();
    folder
}

/// Rows as TOML, and an eye and a light beside the volume.
fn placed(rows: [[f64; 4]; 3]) -> (String, String, String) {
    let bounds = {
        let map = Transform::from_rows(rows).unwrap();
        map.bounds(&volref::geometry::Aabb {
            min: FIRST,
            max: FIRST + SPACING * DVec3::new(4.0, 3.0, 2.0),
        })
    };
    let size = bounds.size().max_element();
    // A needle is seen from beside its middle.
    let size = if size > 100.0 { 1.5 } else { size };
    let eye = bounds.centre() + DVec3::new(0.9, 0.7, -1.3) * size;
    let light = bounds.centre() + DVec3::new(-0.4, 1.2, -0.9) * size;
    (
        format!("transform = {rows:?}"),
        format!("light = {{ position = {:?} }}", light.to_array()),
        format!("eye = {:?}", eye.to_array()),
    )
}

/// Rounding: pixels are numbers of 32 bits up to 2, of an error of 1.2e-7; gradients are, too, which a highlight of
/// exponent 8 multiplies by 8 at most.
const ROUNDING: f64 = 2e-6;

#[test]
fn ramps_and_constants_under_any_map() {
    let lit = "phong = { ambient = 0.2, diffuse = 0.7, specular = 0.5, shininess = 8 }\n";
    let shadow = "shadow = { step = \"0.7 voxels\" }\n";
    for changes in [CHANGES, DVec3::ZERO] {
        let folder = folder_with(changes);
        for rows in MAPS {
            let (map, light, eye) = placed(rows);
            for more in [
                "",
                lit,
                shadow,
                &format!("{lit}{shadow}compositing = \"back-to-front\"\n"),
            ] {
                let scene = scene_of(folder.path(), &map, &format!("{light}\n{more}"), &eye);
                let scene_volume = volume(&scene);
                // The shortest edge of a cell is a voxel.
                let voxel = Slanted::new(rows).voxel;
                assert!(
                    (scene_volume.step / (0.5 * voxel) - 1.0).abs() < 1e-12,
                    "{rows:?}"
                );
                let film = by_all(&scene);
                let (worst, seen) = off(&film, scene_volume, changes, rows, scene_volume.step);
                assert!(worst < ROUNDING, "{worst:e}: {rows:?} {more}");
                assert!(seen >= 5, "{seen} pixels of {rows:?}");
            }
        }
    }
}

#[test]
fn integrals_under_any_map() {
    for changes in [CHANGES, DVec3::ZERO] {
        let folder = folder_with(changes);
        for rows in &MAPS[..5] {
            let (map, _, eye) = placed(*rows);
            let scene = scene_of(folder.path(), &map, "compositing = \"continuous\"", &eye);
            // The midpoint rule with 200 steps to a voxel.
            let step = 0.01 * volume(&scene).step;
            let (worst, _) = off(&rendered(&scene), volume(&scene), changes, *rows, step);
            assert!(worst < 1e-5, "{worst:e}: {rows:?}");
        }
    }
}

/// A volume with hills, so that normals differ from sample to sample.
fn hills() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let values = ramp(CHANGES)
        .enumerate()
        .map(|(index, value)| 0.5 * value + 0.05 * (index * 7 % 11) as f64);
    std::fs::write(folder.path().join("ramp.nrrd"), nrrd(UPRIGHT, values)).unwrap();
    folder
}

const LIT: &str = "phong = { specular = 0.5, shininess = 8 }\nshadow = {}\n";

fn vector(v: DVec3) -> String {
    format!("{:?}", v.to_array())
}

/// The scene of the hills with the map `volume`, seen and lit from places moved by `motion`.
fn moved(folder: &Path, volume: &str, motion: &Transform) -> Scene {
    let at = |x, y, z| vector(motion.point(DVec3::new(x, y, z)));
    let view = format!(
        "eye = {}\ntarget = {}\nup = {}",
        at(1.9, 2.8, -2.6),
        at(0.2, 1.7, 0.1),
        vector(motion.vector(DVec3::new(0.1, 1.0, 0.0)))
    );
    let light = format!("light = {{ position = {} }}\n{LIT}", at(-1.0, 4.0, -3.0));
    scene_of(folder, volume, &light, &view)
}

fn difference(one: &Film, other: &Film) -> f64 {
    let pixels = one
        .radiance()
        .iter()
        .flatten()
        .zip(other.radiance().iter().flatten());
    pixels
        .map(|(a, b)| f64::from((a - b).abs()))
        .fold(0.0, f64::max)
}

#[test]
fn a_volume_turned_with_its_camera_and_light_is_the_same_image() {
    let folder = hills();
    let still = by_all(&moved(folder.path(), "", &Transform::IDENTITY));
    assert!(still.brightest() > 0.3);
    for (axis, degrees, offset) in [
        (DVec3::Y, 90.0, DVec3::ZERO),
        (DVec3::new(1.0, -2.0, 0.5), 71.0, DVec3::new(3.0, -1.0, 2.0)),
        (DVec3::X, 0.0, DVec3::new(1e4, 2e4, -1e4)),
    ] {
        let turn = Transform::rotation(axis, degrees).unwrap();
        let motion = turn.then(&Transform::translation(offset).unwrap());
        let keys = format!(
            "rotate = {{ axis = {}, angle = {degrees:?} }}\ntranslate = {}",
            vector(axis),
            vector(offset)
        );
        let by_steps = by_all(&moved(folder.path(), &keys, &motion));
        assert!(difference(&still, &by_steps) < ROUNDING, "{keys}");
        let matrix = format!("transform = {:?}", motion.rows());
        let by_matrix = by_all(&moved(folder.path(), &matrix, &motion));
        assert!(difference(&by_steps, &by_matrix) < ROUNDING, "{keys}");
    }
}

#[test]
fn a_mirrored_volume_is_the_mirrored_image() {
    let folder = hills();
    let still = by_all(&moved(folder.path(), "", &Transform::IDENTITY));
    let mirror = Transform::scale(DVec3::new(-1.0, 1.0, 1.0)).unwrap();
    let mirrored = by_all(&moved(folder.path(), "scale = [-1, 1, 1]", &mirror));
    let rows = mirrored.radiance().chunks(SIDE);
    let back: Vec<[f32; 3]> = rows.flat_map(|row| row.iter().rev().copied()).collect();
    assert!(difference(&still, &Film::new(SIDE, SIDE, back)) < ROUNDING);
    assert!(difference(&still, &mirrored) > 0.05);
}

/// As large in all lengths by a power of two: the same bits.
#[test]
fn a_volume_twice_as_large_is_the_same_image_to_the_bit() {
    let folder = hills();
    let sheared = "transform = [[1, 0.3, 0, 0.1], [0, 0.9, 0.2, 0], [0.4, 0, 1.2, 0]]";
    let doubled = "transform = [[2, 0.6, 0, 0.2], [0, 1.8, 0.4, 0], [0.8, 0, 2.4, 0]]";
    let twice = Transform::scale(DVec3::splat(2.0)).unwrap();
    let mut large = moved(folder.path(), doubled, &twice);
    for panel in &mut large.panels {
        if let volref::scene::Model::Classified(volume) = &mut panel.model {
            volume.transfer_function.reference_length *= 2.0;
            let shadow = volume.shadow.as_mut().unwrap();
            shadow.reference_step *= 2.0;
        }
    }
    let small = by_all(&moved(folder.path(), sheared, &Transform::IDENTITY));
    assert_eq!(by_all(&large), small);
}

/// Headers of the same samples at the same places.
#[test]
fn files_stand_where_their_headers_put_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ramp.nrrd");
    let options = LoadOptions {
        orientation: Orientation::Oblique,
        ..LoadOptions::default()
    };
    // Steps along the axes of the file, and the first sample.
    let oblique = [
        DVec3::new(0.3, 0.4, 0.0),
        DVec3::new(-0.4, 0.3, 0.1),
        DVec3::new(0.0, 0.2, -0.7),
    ];
    let upright = [DVec3::X * 0.5, DVec3::Y * -2.0, DVec3::Z * 3.0];
    let first = DVec3::new(1.0, 4.0, -2.0);
    let directions = |steps: [DVec3; 3]| {
        let steps = steps
            .map(|s| format!("({},{},{})", s.x, s.y, s.z))
            .join(" ");
        format!("space dimension: 3\nspace directions: {steps}\nspace origin: (1,4,-2)")
    };
    for (header, steps) in [
        (directions(oblique), oblique),
        (directions(upright), upright),
        ("spacings: 0.5 -2 3\naxis mins: 1 4 -2".to_owned(), upright),
        ("axis mins: 1 4 -2\naxis maxs: 3 -2 4".to_owned(), upright),
        (
            "spacings: 0.5 -2 3\nspace dimension: 3\nspace origin: (1,4,-2)".to_owned(),
            upright,
        ),
    ] {
        std::fs::write(&path, nrrd(&header, (0..60).map(f64::from))).unwrap();
        let loaded = load_hashed(&path, &options).unwrap();
        assert_eq!(loaded.to_world.is_some(), steps == oblique, "{header}");
        let (lattice, values) = (loaded.grid.lattice(), loaded.grid.values());
        for (index, value) in values.iter().enumerate() {
            let place = lattice.position(lattice.node(index));
            let place = loaded.to_world.map_or(place, |map| map.point(place));
            let stored = *value as usize;
            let [i, j, k] = [stored % 5, stored / 5 % 4, stored / 20].map(|n| n as f64);
            let right = first + steps[0] * i + steps[1] * j + steps[2] * k;
            assert!(
                place.distance(right) < 1e-14 * 16.0,
                "{header}: {place} {right}"
            );
        }
    }
}

#[test]
fn mistakes_of_placement() {
    let folder = hills();
    let placed = moved(
        folder.path(),
        "scale = [1, 0.5, 2]\nrotate = { axis = [1, 1, 0], angle = 40 }",
        &Transform::IDENTITY,
    );
    let still = moved(folder.path(), "", &Transform::IDENTITY);
    let right = rendered(&placed);
    let mut said = String::new();
    for name in [
        "transform-ignored",
        "transform-inverted",
        "normals-not-inverse-transposed",
        "step-in-volume-space",
    ] {
        let mistake = mistakes::named(name).unwrap();
        assert!(mistake.in_scene(&still).is_none(), "{name}");
        let wrong = rendered(&mistake.in_scene(&placed).unwrap());
        let _ = writeln!(said, "{name} {}", difference(&right, &wrong));
        assert!(difference(&right, &wrong) > 0.02, "{said}");
    }
}

/// Images of the suite, each by the map that its manifest states in words.
#[test]
fn goldens_of_placed_volumes() {
    let turn =
        |axis: DVec3, degrees: f64| DMat3::from_axis_angle(axis.normalize(), degrees.to_radians());
    let stretched = turn(DVec3::Z, 35.0) * DMat3::from_diagonal(DVec3::new(1.5, 0.5, 0.9));
    let mirrored = turn(DVec3::Y, 20.0) * DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
    let sheared = DMat3::from_cols(
        DVec3::new(1.0, 0.0, 0.25),
        DVec3::new(0.8, 0.7, 0.0),
        DVec3::new(0.0, -0.3, 1.2),
    );
    let oblique = DMat3::from_cols(
        DVec3::new(0.12, 0.09, 0.0),
        DVec3::new(0.09, -0.12, 0.03),
        DVec3::new(0.0, 0.04, 0.2),
    );
    let (rings, head) = (DVec3::splat(0.125), DVec3::new(0.125, 0.1, 0.25));
    for (name, linear, offset, spacing) in [
        (
            "turned",
            turn(DVec3::new(1.0, 2.0, 0.5), 50.0),
            DVec3::new(0.2, -0.1, 0.3),
            Some(rings),
        ),
        ("uneven", stretched, DVec3::ZERO, Some(head)),
        ("sheared", sheared, DVec3::new(0.1, 0.0, 0.0), Some(rings)),
        ("mirrored", mirrored, DVec3::ZERO, Some(head)),
        ("shadowed", sheared, DVec3::new(0.1, 0.0, 0.0), Some(rings)),
        // By its steps, from the first node on.
        (
            "oblique",
            oblique,
            DVec3::new(-1.485 + 0.2, -0.115 + 0.1, -1.295),
            None,
        ),
    ] {
        let name = format!("scenes/{name}");
        let scene = suite::scene_of(&name);
        let scene = volume(&scene);
        let nodes = scene.grid.lattice().nodes();
        let last = DVec3::from_array(nodes.map(|nodes| (nodes - 1) as f64));
        let (first, spacing) = match spacing {
            Some(spacing) => (last * spacing * -0.5, spacing),
            None => (DVec3::ZERO, DVec3::ONE),
        };
        let columns = linear.transpose();
        let rows = [0, 1, 2].map(|row| {
            let DVec3 { x, y, z } = columns.col(row);
            [x, y, z, offset[row]]
        });
        let box_ = Slanted::of(rows, first, spacing, nodes);
        let values = scene.grid.values().iter().map(|&value| value.into());
        let field = Nodes {
            nodes,
            values: values.collect(),
        };
        let look = |value: f64| {
            let function = &scene.transfer_function;
            (function.colour(value), function.reference_opacity(value))
        };
        let film = suite::golden_of(&name);
        let (worst, seen) = farthest(&film, scene, &box_, &field, &look, 0.5 * box_.voxel);
        assert!(
            worst < 1e-5 && seen > 1500,
            "{name}: {worst:e}, {seen} pixels"
        );
    }
}
