//! Projections and isosurfaces of a field.
//!
//! Exact ones are held by closed forms of fields that are linear along every ray, and by brute force: the same field
//! at thousands of places of a ray, with a bound on what lies between two of them. The sampled ones are those of
//! `src/reference`, to the bit (`reference.rs`).

use crate::common::suite::{cases_of, film_of, root, searched};
use crate::needs::tries;
use crate::ray_caster::scenes::{PHONG, hash, plain, sampled};
use glam::{DMat3, DVec3};
use std::collections::BTreeSet;
use std::sync::Arc;
use volref::film::Film;
use volref::geometry::{Camera, Direction, Ray, Span, Transform};
use volref::judging::Verdict;
use volref::math::{exp, ln, pow};
use volref::optics::{Appearance, TransferPoint, TransferPoints};
use volref::reference;
use volref::render::classified::modes::ExactField;
use volref::render::{Event, Sampling, plans, render};
use volref::scene::{
    Classified, Clip, Conventions, Isosurface, Isosurfaces, Kept, LastStep, Mode, Panel, Projected,
    Projection, Scene, Window,
};
use volref::variations::mistakes;
use volref::volume::{Cell, Centring, Grid, Lattice, NodeLine};

const ALL: [Projected; 5] = [
    Projected::Maximum,
    Projected::Minimum,
    Projected::Mean,
    Projected::Sum,
    Projected::AttenuatedMaximum(1.3),
];

const WINDOW: Window = Window {
    low: -0.2,
    high: 0.8,
};

fn projection(of: Projected) -> Projection {
    Projection {
        of,
        window: Some(WINDOW),
        fault: None,
    }
}

fn surfaces(values: &[f64], opacity: f64) -> Isosurfaces {
    let surface = |(index, &value): (usize, &f64)| Isosurface {
        value,
        colour: DVec3::new(0.2 + 0.1 * index as f64, 0.5, 0.9),
        opacity,
    };
    Isosurfaces {
        surfaces: values.iter().enumerate().map(surface).collect(),
        faults: Vec::new(),
    }
}

fn exact(grid: Arc<Grid<f32>>, mode: Mode) -> Classified {
    Classified {
        mode,
        continuous: true,
        ..plain(grid)
    }
}

fn panel(scene: Classified, side: usize) -> Panel {
    Panel::of(scene.into(), [side, side])
}

fn image(scene: &Classified, side: usize) -> Film {
    let scene = Scene::of(panel(scene.clone(), side));
    film_of(&scene)
}

/// Numbers in [−1, 1], with as many zeros.
fn noise(seed: u64, nodes: [usize; 3]) -> Arc<Grid<f32>> {
    let lattice = Lattice::new(nodes, DVec3::new(0.5, 0.7, 0.4), DVec3::splat(-1.0)).unwrap();
    sampled(lattice, |node| {
        let index = lattice.index(node);
        let is_zero = hash(seed, 2 * index) < 0.3;
        let value = 2.0 * hash(seed, 2 * index + 1) - 1.0;
        if is_zero { 0.0 } else { value as f32 }
    })
}

/// [`rays`] with their spans in the volume, of those longer than `least`.
fn spans(scene: &Classified, count: usize, least: f64) -> Vec<(Ray, Span)> {
    let rays = rays(scene, count).into_iter();
    let with_span = rays.filter_map(|ray| Some((ray, scene.extent().span(&ray)?)));
    with_span
        .filter(|(_, span)| span.length() > least)
        .collect()
}

/// Rays through a volume from all sides, some of them along edges and through nodes.
fn rays(scene: &Classified, count: usize) -> Vec<Ray> {
    let extent = scene.extent();
    let (centre, size) = (extent.bounds.centre(), extent.bounds.size());
    let place = |seed: u64, index: usize, reach: f64| {
        let number = |axis: usize| hash(seed, 3 * index + axis) - 0.5;
        centre + reach * size * DVec3::new(number(0), number(1), number(2))
    };
    let random = (0..count).filter_map(|index| {
        let from = extent.in_world(place(5, index, 3.0));
        let to = extent.in_world(place(6, index, 1.0));
        Ray::new(from, to - from)
    });
    let lattice = scene.grid.lattice();
    let through_nodes = (0..count / 4).filter_map(|index| {
        let node = |salt| {
            let node = lattice.node((hash(salt, index) * lattice.node_count() as f64) as usize);
            lattice.first() + lattice.spacing() * DVec3::from_array(node.map(|i| i as f64))
        };
        let [from, to] = [node(7), node(8)].map(|point| extent.in_world(point));
        Ray::new(from - (to - from), to - from)
    });
    random.chain(through_nodes).collect()
}

/// The field at the distance `t` along `ray`.
fn field(scene: &Classified, ray: &Ray, t: f64) -> f64 {
    let lattice = scene.grid.lattice();
    let line = NodeLine::new(scene.extent().line(ray), lattice);
    scene
        .interpolation
        .read(&*scene.grid, &Cell::around(lattice, line.at(t)))
}

/// Largest change of the field per world unit along `ray`: the largest difference of neighbours on each axis, over
/// their distance.
fn steepest(scene: &Classified, ray: &Ray) -> f64 {
    let (grid, lattice) = (&scene.grid, scene.grid.lattice());
    let nodes = lattice.nodes();
    let direction = scene.extent().line(ray).direction;
    let along = |axis: usize| {
        let stride = [1, nodes[0], nodes[0] * nodes[1]][axis];
        let values = grid.values();
        let differences = (0..lattice.node_count())
            .filter(|&index| lattice.node(index)[axis] + 1 < nodes[axis])
            .map(|index| f64::from((values[index + stride] - values[index]).abs()));
        let most = differences.fold(0.0, f64::max);
        most / lattice.spacing()[axis] * direction[axis].abs()
    };
    along(0) + along(1) + along(2)
}

/// A map that shears, stretches and moves.
fn map() -> Transform {
    Transform::from_rows([
        [1.0, 0.6, 0.0, 0.3],
        [-0.2, 0.8, 0.1, 0.0],
        [0.3, 0.0, 1.4, -0.5],
    ])
    .unwrap()
}

/// Places of brute force on a ray.
const PLACES: usize = 4000;

/// Extrema, means and sums against the field at thousands of places. Between two of them, `h` apart, a field that
/// changes by at most `L` per length is off by at most `Lh/2` from the nearer one; the rectangle rule is off by
/// `Lh/4` of the length. The weight of an attenuated value changes by at most `μ` per length besides, and its integral
/// is off by `Lh/4` of the length, divided by the width of the window.
#[test]
fn projections_are_those_of_brute_force() {
    for (seed, to_world) in [(1, None), (2, Some(map())), (3, None)] {
        let scene = Classified {
            to_world,
            ..exact(noise(seed, [5, 4, 6]), Mode::Composited)
        };
        let field_along = ExactField::new(&scene);
        let mut seen = 0;
        for (ray, span) in spans(&scene, 60, 1e-9) {
            seen += 1;
            let (h, steep) = (span.length() / PLACES as f64, steepest(&scene, &ray));
            let at = |place: usize| field(&scene, &ray, span.near + (place as f64 + 0.5) * h);
            let values: Vec<f64> = (0..PLACES).map(at).collect();
            let exactly = |of| field_along.number_along(&projection(of), &ray).unwrap();
            let rounding = 1e-12;
            let between = 0.5 * steep * h + rounding;
            let most = values.iter().copied().fold(f64::MIN, f64::max);
            let beyond = exactly(Projected::Maximum) - most;
            assert!((-rounding..between).contains(&beyond), "{beyond} {between}");
            let least = values.iter().copied().fold(f64::MAX, f64::min);
            let beyond = least - exactly(Projected::Minimum);
            assert!((-rounding..between).contains(&beyond), "{beyond} {between}");
            let mean = values.iter().sum::<f64>() / PLACES as f64;
            let off = (exactly(Projected::Mean) - mean).abs();
            assert!(off <= 0.5 * between, "{off} {between}");
            let off = exactly(Projected::Sum) - exactly(Projected::Mean) * span.length();
            assert!(off.abs() <= 1e-13 * span.length(), "{off}");

            for attenuation in [0.0, 0.4, 3.0, 40.0] {
                let (mut brute, mut depth) = (0.0_f64, 0.0);
                for value in &values {
                    let v = WINDOW.position(*value);
                    brute = brute.max(v * exp(-attenuation * (depth + 0.5 * v * h)));
                    depth += v * h;
                }
                let width = WINDOW.high - WINDOW.low;
                let bound = between / width * (1.0 + attenuation * span.length()) + attenuation * h;
                let off = exactly(Projected::AttenuatedMaximum(attenuation)) - brute;
                assert!(off.abs() <= bound && off >= -bound * 0.5, "{off} {bound}");
            }
        }
        assert!(seen > 50, "{seen}");
    }
}

/// Where the field changes its side between two places, there is an isosurface; no isosurface lies anywhere else but
/// between two places of one side, in pairs; and at each the field has its value.
#[test]
fn isosurfaces_are_the_roots_of_the_field() {
    // That of many nodes, ordinary ones, and the largest value.
    let mut passages = 0;
    for (seed, to_world) in [(4, None), (5, Some(map()))] {
        let grid = noise(seed, [5, 4, 6]);
        let most = grid.range().1;
        let values = [0.0, 0.25, -0.5, 0.1, most];
        let scene = Classified {
            to_world,
            ..exact(grid, Mode::Composited)
        };
        let field_along = ExactField::new(&scene);
        for (ray, span) in spans(&scene, 80, 1e-9) {
            let h = span.length() / PLACES as f64;
            let steep = steepest(&scene, &ray);
            let found = field_along.passed_along(&surfaces(&values, 0.5), &ray);
            passages += found.len();
            assert!(found.is_sorted_by(|(a, _), (b, _)| a <= b));
            for (t, surface) in &found {
                let excess = field(&scene, &ray, *t) - surface.value;
                assert!(excess.abs() <= 1e-12 * (1.0 + steep), "{excess:e} at {t}");
            }
            for value in values {
                let roots: Vec<f64> = found
                    .iter()
                    .filter(|(_, surface)| surface.value == value)
                    .map(|(t, _)| *t)
                    .collect();
                let excess = |place: usize| {
                    field(&scene, &ray, span.near + (place as f64 + 0.5) * h) - value
                };
                for place in 1..PLACES {
                    let [a, b] = [excess(place - 1), excess(place)];
                    // Where rounding decides of the side, there is no truth.
                    if a.abs().min(b.abs()) <= 1e-13 {
                        continue;
                    }
                    let from = span.near + (place as f64 - 0.5) * h;
                    let inside = |t: &&f64| (from..=from + h).contains(*t);
                    let count = roots.iter().filter(inside).count();
                    let changes = (a < 0.0) != (b < 0.0);
                    assert_eq!(count % 2 == 1, changes, "{value} at {from}: {a:e} {b:e}");
                }
            }
        }
    }
    assert!(passages > 800, "{passages}");
}

/// Values along x: a plateau of 0, a rise, a plateau of 1, a fall.
fn plateaus() -> Arc<Grid<f32>> {
    let lattice = Lattice::new([5, 3, 3], DVec3::ONE, DVec3::ZERO).unwrap();
    sampled(lattice, |[i, _, _]| [0.0, 0.0, 1.0, 1.0, 0.0][i])
}

/// A linear field, placed anywhere: along a ray it is a line, between its values at the two ends. Of values of 32 bits, up
/// to 4, the trilinear interpolant is off by roundings of 2⁻²³ at most where nodes are no multiples of 1/64; these are.
#[test]
fn a_ramp_has_closed_forms() {
    let lattice = Lattice::new([5, 4, 3], DVec3::new(0.25, 0.5, 0.5), DVec3::ZERO).unwrap();
    let slope = DVec3::new(0.5, 0.25, -0.375);
    let grid = sampled(lattice, |node| {
        let point = lattice.spacing() * DVec3::from_array(node.map(|i| i as f64));
        (1.0 + slope.dot(point)) as f32
    });
    for to_world in [None, Some(map())] {
        let scene = Classified {
            to_world,
            ..exact(grid.clone(), Mode::Composited)
        };
        let rows = map().rows();
        let matrix = DMat3::from_cols_array(&std::array::from_fn(|i| rows[i % 3][i / 3]));
        let offset = DVec3::from_array([0, 1, 2].map(|row| rows[row][3]));
        let value = |point: DVec3| match to_world {
            None => 1.0 + slope.dot(point),
            Some(_) => 1.0 + slope.dot(matrix.inverse() * (point - offset)),
        };
        let field_along = ExactField::new(&scene);
        for (ray, span) in spans(&scene, 100, 1e-6) {
            let [a, b] = [span.near, span.far].map(|t| value(ray.at(t)));
            let exactly = |of| field_along.number_along(&projection(of), &ray).unwrap();
            for (of, right) in [
                (Projected::Maximum, a.max(b)),
                (Projected::Minimum, a.min(b)),
                (Projected::Mean, 0.5 * (a + b)),
                (Projected::Sum, 0.5 * (a + b) * span.length()),
            ] {
                let off = exactly(of) - right;
                assert!(off.abs() < 1e-12 * (1.0 + span.length()), "{of:?}: {off:e}");
            }
            let middle = 0.3 * a + 0.7 * b;
            let found = field_along.passed_along(&surfaces(&[middle], 1.0), &ray);
            if (a - b).abs() > 1e-3 {
                let depth = span.near + 0.7 * span.length();
                assert_eq!(found.len(), 1);
                let off = (found[0].0 - depth) * (b - a) / span.length();
                assert!(off.abs() < 1e-12, "{off:e}");
            }
        }
    }
}

fn modes() -> Vec<Mode> {
    let projections = ALL.map(|of| Mode::Projection(projection(of)));
    let isosurfaces = Mode::Isosurfaces(surfaces(&[0.15, -0.3, 0.45], 0.4));
    projections.into_iter().chain([isosurfaces]).collect()
}

/// Samples become what is exact: the largest difference of a pixel halves with the step, or better. Of surfaces that a ray
/// touches this is not so: of those most pixels agree.
#[test]
fn samples_converge_to_what_is_exact() {
    for mode in modes() {
        let scene = exact(noise(21, [6, 5, 6]), mode);
        let right = image(&scene, 20);
        let off = |step: f64| {
            let sampled = Classified {
                continuous: false,
                step,
                ..scene.clone()
            };
            let pixels = image(&sampled, 20);
            let pairs = right.radiance().iter().zip(pixels.radiance());
            let mut off: Vec<f32> = pairs.map(|(a, b)| (a[0] - b[0]).abs()).collect();
            off.sort_by(f32::total_cmp);
            off[off.len() * 19 / 20]
        };
        let [coarse, fine] = [off(0.02), off(0.0025)];
        assert!(
            fine <= 0.5 * coarse && fine < 2e-3,
            "{:?}: {coarse} {fine}",
            scene.mode
        );
    }
}

/// Rays that miss the volume, or meet it in a point, show the background; a volume is opaque, and surfaces are as opaque
/// as they say. What is seen in surfaces does not depend on their order in the scene.
#[test]
fn opacity_and_order() {
    let background = DVec3::new(0.1, 0.2, 0.3);
    for mode in modes() {
        let scene = Classified {
            background,
            ..exact(noise(41, [5, 6, 4]), mode)
        };
        let film = image(&scene, 16);
        let opacity = film.opacity().unwrap();
        let volume = Scene::of(panel(scene.clone(), 16));
        let camera = scene.camera;
        for (index, (pixel, &opacity)) in film.radiance().iter().zip(opacity).enumerate() {
            let ray = camera.ray([index % 16, index / 16], [16, 16]);
            if scene.extent().span(&ray).is_none() {
                assert_eq!((*pixel, opacity), ([0.1, 0.2, 0.3], 0.0));
            } else if let Mode::Projection(_) = scene.mode {
                assert_eq!(opacity, 1.0);
            } else {
                // 1 − (3/5)ⁿ
                let layers = ln(f64::from(1.0 - opacity)) / ln(0.6);
                assert!((layers - layers.round()).abs() < 1e-3, "{opacity}");
            }
        }
        let work = render(&plans(&volume), Sampling::default(), &|| ())
            .unwrap()
            .work;
        assert_eq!(work[0][Event::DensityLookup], work[0][Event::CellWalked]);
        if let Mode::Isosurfaces(surfaces) = &scene.mode {
            let mut reversed = surfaces.clone();
            reversed.surfaces.reverse();
            let other = Classified {
                mode: Mode::Isosurfaces(reversed),
                ..scene.clone()
            };
            assert_eq!(image(&other, 16), film);
        }
    }
}

/// The colours of a table, where there is no window.
#[test]
fn a_table_colours_numbers() {
    let point = |value: f64, colour: DVec3| TransferPoint {
        value,
        colour,
        opacity: 0.0,
    };
    let mut scene = exact(plateaus(), Mode::Composited);
    let points = vec![point(0.0, DVec3::X), point(1.0, DVec3::Z)];
    scene.transfer_function.appearance = Appearance::Points(TransferPoints::new(points).unwrap());
    // Along x, from beyond: the values of `plateaus`.
    let eye = DVec3::new(-6.0, 1.0, 1.0);
    scene.camera = Camera::new(eye, DVec3::splat(1.0), DVec3::Y, 0.01).unwrap();
    for (of, share) in [
        (Projected::Maximum, 1.0),
        (Projected::Minimum, 0.0),
        (Projected::Mean, 0.5),
        (Projected::Sum, 1.0),
    ] {
        let window = None;
        scene.mode = Mode::Projection(Projection {
            of,
            window,
            fault: None,
        });
        let film = image(&scene, 1);
        let pixel = film.radiance()[0];
        let right = [1.0 - share, 0.0, share];
        assert!(
            (0..3).all(|i| (pixel[i] - right[i]).abs() < 1e-4),
            "{of:?} {pixel:?}"
        );
    }
}

/// An isosurface that no ray can pass is provably null: the plan says so, and no field is read.
#[test]
fn what_no_ray_passes_is_left_out() {
    for (values, is_seen) in [(vec![2.0, -2.0], false), (vec![2.0, 0.5], true)] {
        let mode = Mode::Isosurfaces(surfaces(&values, 1.0));
        let scene = Scene::of(panel(exact(plateaus(), mode), 8));
        let plans = plans(&scene);
        let work = render(&plans, Sampling::default(), &|| ()).unwrap().work;
        assert_eq!(work[0][Event::DensityLookup] > 0, is_seen);
        assert_eq!(plans[0].kernel.to_string() == "background only", !is_seen);
    }
}

/// Sampled modes are those of the plain renderers, to the bit, cells and nearest nodes included.
#[test]
fn samples_are_those_of_the_plain_renderers() {
    for mode in modes() {
        for to_world in [None, Some(map())] {
            for interpolation in [
                volref::volume::Interpolation::Nearest,
                volref::volume::Interpolation::Trilinear,
            ] {
                let grid = noise(51, [5, 6, 4]);
                let lattice = grid.lattice().with_centring(Centring::Cells).unwrap();
                let grid = Grid::new(lattice, grid.values().to_vec()).unwrap();
                let scene = Classified {
                    continuous: false,
                    to_world,
                    interpolation,
                    phong: matches!(mode, Mode::Isosurfaces(_)).then_some(PHONG),
                    ..exact(Arc::new(grid), mode.clone())
                };
                let [fast, plain] = by_both(&scene, 12);
                assert_eq!(fast, plain, "{mode:?}");
                // And what clips keep: they cut the image.
                let mut clipped = scene.clone();
                let extent = scene.extent();
                let centre = extent.in_world(extent.bounds.centre());
                clipped.objects.clips = [DVec3::new(1.0, 0.4, 0.2), DVec3::new(-0.3, 1.0, -1.0)]
                    .map(|normal| Clip {
                        kept: Kept::Side {
                            point: centre,
                            normal: Direction::of(normal).unwrap(),
                        },
                        volumes: None,
                    })
                    .to_vec();
                let [cut, plain] = by_both(&clipped, 12);
                assert_eq!(cut, plain, "{mode:?}");
                assert_ne!(cut, fast, "{mode:?}");
            }
        }
    }
}

/// The image by the fast renderer, and by the plain one.
fn by_both(scene: &Classified, side: usize) -> [Film; 2] {
    let whole = Scene::of(panel(scene.clone(), side));
    let plain = reference::render(&whole, Sampling::default(), &[true]).unwrap();
    [image(scene, side), plain]
}

/// A linear field and its slope: central differences are the slope wherever both neighbours exist.
fn ramp() -> (Arc<Grid<f32>>, DVec3) {
    let lattice = Lattice::new([9; 3], DVec3::splat(0.25), DVec3::splat(-1.0)).unwrap();
    let slope = DVec3::new(0.5, 0.25, -0.375);
    let grid = sampled(lattice, |node| {
        let index = DVec3::from_array(node.map(|i| i as f64));
        slope.dot(lattice.first() + lattice.spacing() * index) as f32
    });
    (grid, slope)
}

/// Distances of samples at the ends of whole steps along `ray`, as many as lie within the volume.
fn at_ends(scene: &Classified, ray: &Ray) -> Vec<f64> {
    let Some(span) = scene.extent().span(ray) else {
        return vec![];
    };
    let count = (span.length() / scene.step).floor() as usize;
    (1..=count)
        .map(|step| span.near + step as f64 * scene.step)
        .collect()
}

/// Samples of a mode where a convention has them: extrema and means of a linear field, by hand.
#[test]
fn modes_follow_places_of_samples() {
    let (grid, slope) = ramp();
    let (low, high) = grid.range();
    for (of, mean_of_range) in [
        (Projected::Maximum, false),
        (Projected::Minimum, false),
        (Projected::Mean, false),
        (Projected::Mean, true),
    ] {
        let mut scene = plain(grid.clone());
        scene.mode = Mode::Projection(projection(of));
        scene.step = 0.3;
        scene.conventions = Conventions {
            first_sample: 1.0,
            last_step: LastStep::Whole,
            mean_of_range,
            ..Conventions::default()
        };
        let own = Classified {
            conventions: Conventions::default(),
            ..scene.clone()
        };
        let film = image(&scene, 8);
        let mut moved = 0;
        for (index, pixel) in film.radiance().iter().enumerate() {
            let ray = scene.camera.ray([index % 8, index / 8], [8, 8]);
            let values = at_ends(&scene, &ray)
                .into_iter()
                .map(|t| slope.dot(ray.at(t)));
            let values: Vec<f64> = values.collect();
            if values.is_empty() {
                continue;
            }
            let number = match of {
                Projected::Maximum => values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
                Projected::Minimum => values.iter().copied().fold(f64::INFINITY, f64::min),
                _ => values.iter().sum::<f64>() / values.len() as f64,
            };
            let [low, high] = match mean_of_range {
                true => [low, high],
                false => [WINDOW.low, WINDOW.high],
            };
            let right = ((number - low) / (high - low)).clamp(0.0, 1.0);
            // A value of 32 bits, and a pixel.
            assert!((f64::from(pixel[0]) - right).abs() < 1e-6, "{of:?}");
            moved += u32::from(*pixel != image(&own, 8).radiance()[index]);
        }
        assert!(moved > 0, "{of:?} moves no pixel");
    }
}

/// Isosurfaces of a linear field, found at samples, one at each, and lit on one side: by Phong's model, by hand. The eye on
/// the one side and on the other.
#[test]
fn isosurfaces_are_found_at_samples_and_lit_on_one_side() {
    let (grid, slope) = ramp();
    let normal = -slope.normalize();
    // Between two samples there may be two values, of which the second waits for the next sample.
    let wanted = surfaces(&[0.05, 0.0, 0.4], 0.5);
    let sorted = [1, 0, 2].map(|index| wanted.surfaces[index]);
    for eye in [DVec3::new(-3.0, -1.0, 2.0), DVec3::new(3.0, 1.5, -2.0)] {
        let mut scene = plain(grid.clone());
        scene.mode = Mode::Isosurfaces(wanted.clone());
        scene.step = 0.3;
        scene.phong = Some(PHONG);
        scene.light = DVec3::new(-2.0, 2.0, 3.0);
        scene.camera = Camera::new(eye, DVec3::ZERO, DVec3::Y, 0.3).unwrap();
        let of = |surfaces_at_samples, one_sided_surfaces| {
            let mut scene = scene.clone();
            scene.conventions = Conventions {
                first_sample: 1.0,
                last_step: LastStep::Whole,
                surfaces_at_samples,
                one_sided_surfaces,
                ..Conventions::default()
            };
            image(&scene, 8)
        };
        let film = of(true, true);
        for other in [of(false, true), of(false, false)] {
            let pairs = film.radiance().iter().zip(other.radiance());
            assert!(pairs.filter(|(a, b)| a != b).count() > 48);
        }
        for (index, pixel) in film.radiance().iter().enumerate() {
            let ray = scene.camera.ray([index % 8, index / 8], [8, 8]);
            let ascends = slope.dot(*ray.direction) > 0.0;
            // The next one last.
            let mut waiting: Vec<&Isosurface> = sorted.iter().collect();
            if ascends {
                waiting.reverse();
            }
            let mut right = scene.background;
            let mut seen = Vec::new();
            for (place, t) in at_ends(&scene, &ray).into_iter().enumerate() {
                let value = slope.dot(ray.at(t));
                let is_behind = |next: &&Isosurface| (value > next.value) == ascends;
                if place == 0 {
                    // What lies before the first sample no sample finds.
                    while waiting.pop_if(|next| is_behind(next)).is_some() {}
                } else if let Some(found) = waiting.pop_if(|next| is_behind(next)) {
                    seen.push((t, found));
                }
            }
            for (t, surface) in seen.into_iter().rev() {
                let point = ray.at(t);
                let to_light = (scene.light - point).normalize();
                let cosine = normal.dot(to_light).max(0.0);
                let mut lit = surface.colour * (PHONG.ambient + PHONG.diffuse * cosine);
                if cosine > 0.0 {
                    let mirrored = 2.0 * cosine * normal - to_light;
                    let highlight = mirrored.dot(-*ray.direction).max(0.0);
                    lit += PHONG.specular * pow(highlight, f64::from(PHONG.shininess));
                }
                right = 0.5 * lit + 0.5 * right;
            }
            let off = (0..3).map(|c| (f64::from(pixel[c]) - right[c]).abs());
            // Gradients of 32 bits: a normal is off by some 2⁻²³, its highlight by the exponent times that.
            assert!(off.fold(0.0, f64::max) < 2e-5, "{pixel:?} {right}");
        }
    }
}

/// Conventions that a mode does not follow are those of volref.
#[test]
fn modes_follow_their_conventions_alone() {
    let read = |mode: &str, convention: &str| {
        let text = format!(
            "[classified]\n{mode}\nvolume.file = 'fixtures/volumes/hard/hill.nrrd'\n\
             [classified.conventions]\n{convention}\n"
        );
        let scene = Scene::parse(&text, &root().join("scene.toml"))?;
        Ok::<_, Box<volref::scene::SceneError>>(scene.panels[0].classified().unwrap().conventions)
    };
    let isosurface = "mode = 'isosurface'\nisosurface = [{ value = 0.5, colour = 1 }]";
    let mean = "mode = 'mean'\nwindow = { low = 0, high = 1 }";
    let maximum = "mode = 'maximum'\nwindow = { low = 0, high = 1 }";
    for (mode, convention) in [
        (isosurface, "isosurface_place = 'sample'"),
        (isosurface, "gradient = 'texture'"),
        (mean, "mean_colours = 'range'"),
        (maximum, "last_step = 'whole'"),
    ] {
        assert_ne!(read(mode, convention).unwrap(), Conventions::default());
    }
    for (mode, convention) in [
        (isosurface, "mean_colours = 'range'"),
        (isosurface, "opacity = 'linear'"),
        (maximum, "mean_colours = 'range'"),
        (maximum, "gradient = 'texture'"),
        (mean, "table_size = 256"),
        ("", "isosurface_sides = 'one'"),
        ("", "mean_colours = 'range'"),
    ] {
        assert_eq!(read(mode, convention).unwrap(), Conventions::default());
    }
    let exact = format!("{maximum}\ncompositing = 'continuous'");
    let error = read(&exact, "last_step = 'whole'").unwrap_err().to_string();
    assert!(error.contains("no samples"), "{error}");
}

/// Mistakes that the cases of the family list, each in the first of them: it fails there; what is said to explain it is
/// that mistake, or one that makes the same image.
#[test]
fn mistakes_of_the_family_are_named() {
    let mut unnamed = Vec::new();
    let mut named = 0;
    let mut tried = BTreeSet::new();
    for case in cases_of("scenes") {
        let scene = case.load_scene().unwrap();
        if scene.panels[0].classified().unwrap().mode == Mode::Composited {
            continue;
        }
        for name in &case.mistakes {
            if !tried.insert(name) || tried.len() % tries(4, 1) != 0 {
                continue;
            }
            let mistake = mistakes::named(name).unwrap();
            let wrong = mistake.in_scene(&scene).unwrap();
            let result = searched(case, film_of(&wrong));
            assert_eq!(result.verdict, Verdict::Fail, "{}: {name}", case.name);
            let said = &result.looks_like;
            if said.contains(name) {
                named += 1;
            } else if result.reason.contains("nothing was drawn") {
                // Turned around, the two planes leave nothing between them.
            } else {
                unnamed.push(format!("{}: {name}: {said:?}", case.name));
            }
        }
    }
    assert!(
        unnamed.is_empty() && named > tries(6, 25),
        "{named} named\n{}",
        unnamed.join("\n")
    );
}
