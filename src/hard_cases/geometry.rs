//! G: rays, boxes, spheres and cells.

use super::Row;
use super::margin::{Margin, U};
use super::scenes::*;
use crate::geometry::{
    Aabb, Camera, ClosedMesh, Direction, Emitter, Mesh, Placed, Ray, Rectangle, ShapeError, Side,
    Solid, Span, Surface, Transform,
};
use crate::math::sampling;
use crate::media::{Field, optical_depth, transmittance};
use crate::optics::{Light, Point};
use crate::scene::{Model, Radiative};
use crate::volume::{Blob, Walk};
use glam::DVec3;

pub const ROWS: &[Row] = &[
    Row {
        id: "G1",
        what: "a zero component of the direction, the origin within that slab",
        tolerance: "exact",
        remedy: "a zero component is a branch of its own: nothing is multiplied by an infinite reciprocal",
        file: "src/geometry/aabb.rs",
        check: g1_zero_component_within_the_slab,
    },
    Row {
        id: "G2",
        what: "a zero component of the direction, the origin on a face",
        tolerance: "exact",
        remedy: "boxes are half open: a face belongs to the box whose minimum face it is",
        file: "src/geometry/aabb.rs",
        check: g2_zero_component_on_a_face,
    },
    Row {
        id: "G3",
        what: "through a corner, and touching an edge",
        tolerance: "16 u; exact where nothing is crossed",
        remedy: "entry and exit of each axis are compared, and none is widened: a touched edge has length 0",
        file: "src/geometry/aabb.rs",
        check: g3_corner_and_edge,
    },
    Row {
        id: "G4",
        what: "from inside, from a face, and with the box behind",
        tolerance: "exact",
        remedy: "the entry is raised to the origin of the ray before it is compared with the exit",
        file: "src/geometry/surface.rs",
        check: g4_origin_inside_on_the_face_and_behind,
    },
    Row {
        id: "G5",
        what: "boxes without an inside, and inverted ones",
        tolerance: "exact",
        remedy: "corners are checked on their way in; a flat box is one of length 0",
        file: "src/geometry/aabb.rs",
        check: g5_flat_and_inverted_boxes,
    },
    Row {
        id: "G6",
        what: "two touching halves equal the whole, on 100 000 rays",
        tolerance: "8 u of sigma times the exit distance",
        remedy: "half-open boxes, and distances to a face that depend on its coordinate alone",
        file: "src/geometry/aabb.rs",
        check: g6_two_halves_are_the_whole,
    },
    Row {
        id: "G7",
        what: "directions that are not of length 1",
        tolerance: "exact for powers of two, else 1e-14",
        remedy: "directions are brought to length 1 once, by way of a power of two, so that all distances are world distances",
        file: "src/geometry/ray.rs",
        check: g7_direction_of_any_length,
    },
    Row {
        id: "G8",
        what: "the whole scene 2^40 times as large, and as small",
        tolerance: "exact",
        remedy: "no absolute length anywhere: clearances are relative to the coordinates of a shape",
        file: "src/geometry/hit.rs",
        check: g8_whole_scene_scaled,
    },
    Row {
        id: "G9",
        what: "far from the origin: 2^20, 2^30, 2^40",
        tolerance: "4 units in the last place of the offset",
        remedy: "distances are formed from differences to the origin of the ray, in 64 bits",
        file: "src/geometry/aabb.rs",
        check: g9_far_from_the_origin,
    },
    Row {
        id: "G10",
        what: "a sphere 10^8 radii away, and one that is grazed",
        tolerance: "2 units in the last place of the distance; 1e-9",
        remedy: "the chord by the foot of the perpendicular, from (r - b)(r + b)",
        file: "src/geometry/sphere.rs",
        check: g10_far_and_grazed_sphere,
    },
    Row {
        id: "G11",
        what: "leaving a surface: no self-hit and no leak, sizes from 10^-6 to 10^6",
        tolerance: "exact count, 0",
        remedy: "rays start off a surface by a proven bound on all roundings",
        file: "src/geometry/hit.rs",
        check: g11_leaving_a_surface,
    },
    Row {
        id: "G12",
        what: "grid walks in planes of voxels, along diagonals, and without an end",
        tolerance: "8 u of the exit distance; exact number of cells",
        remedy: "whole numbers for cells, and every crossing from its plane",
        file: "src/volume/walk.rs",
        check: g12_grid_walk,
    },
];

fn span(near: f64, far: f64) -> Option<Span> {
    Some(Span { near, far })
}

fn g1_zero_component_within_the_slab(margin: &mut Margin) {
    for zero in [0.0, -0.0] {
        let ray = ray([0.5, 0.5, -1.0], [zero, zero, 1.0]);
        margin.exact(
            format_args!("zero {zero}"),
            unit_box().span(&ray),
            span(1.0, 2.0),
        );
    }
}

fn g2_zero_component_on_a_face(margin: &mut Margin) {
    for zero in [0.0, -0.0] {
        let mut along = |x: f64, right| {
            let ray = ray([x, 0.5, -1.0], [zero, zero, 1.0]);
            margin.exact(format_args!("x = {x:e}"), unit_box().span(&ray), right);
        };
        along(0.0, span(1.0, 2.0));
        along(-0.0, span(1.0, 2.0));
        along(1.0, None);
        along(-1e-300, None);
        along(1.5, None);
    }
}

fn g3_corner_and_edge(margin: &mut Margin) {
    let chord = |ray: Ray| unit_box().span(&ray).map_or(0.0, |span| span.length());
    let diagonal = chord(ray([-1.0; 3], [1.0; 3]));
    margin.roundings("diagonal", diagonal, 3.0_f64.sqrt(), 16.0);
    // Through the edge x = 0, y = 1 only.
    let touching = chord(ray([-1.0, 0.0, 0.5], [1.0, 1.0, 0.0]));
    margin.exact("length at one edge", touching, 0.0);
    margin.exact("one edge", transmittance(optical_depth(5.0, touching)), 1.0);
}

fn g4_origin_inside_on_the_face_and_behind(margin: &mut Margin) {
    let along = |z: f64, towards: f64| unit_box().span(&ray([0.5, 0.5, z], [0.0, 0.0, towards]));
    margin.exact("inside", along(0.5, 1.0), span(0.0, 0.5));
    margin.exact("on a face, looking in", along(0.0, 1.0), span(0.0, 1.0));
    let out = along(0.0, -1.0).map_or(0.0, |span| span.length());
    margin.within("on a face, looking out", out, 0.0, 0.0);
    margin.exact("behind", along(2.0, 1.0), None);
    let fog = before_sky(vec![in_box(unit_box(), grey(3.0, 0.0, 0.0))]);
    let away = straight(&fog, &ray([0.5, 0.5, 2.0], DVec3::Z));
    margin.exact("seen away from the box", away, DVec3::ONE);
}

fn g5_flat_and_inverted_boxes(margin: &mut Margin) {
    let flat = cuboid(DVec3::ZERO, [1.0, 0.0, 1.0]);
    for towards in [DVec3::Y, DVec3::X, DVec3::ONE] {
        let ray = ray(DVec3::new(0.5, 0.0, 0.5) - towards, towards);
        let depth = flat
            .span(&ray)
            .map_or(0.0, |span| optical_depth(9.0, span.length()));
        margin.exact(format_args!("flat, along {towards}"), depth, 0.0);
    }
    let inverted = Aabb::new(DVec3::ONE, DVec3::new(2.0, 0.5, 2.0));
    margin.holds(
        "an inverted box is refused",
        matches!(inverted, Err(ShapeError::Inverted { .. })),
    );
    let no_number = Aabb::new(DVec3::splat(f64::NAN), DVec3::ONE);
    margin.holds("a box that is no number is refused", no_number.is_err());
}

fn g6_two_halves_are_the_whole(margin: &mut Margin) {
    let sigma = 3.0;
    let whole = unit_box();
    let (mut left, mut right) = (whole, whole);
    // Both have the bits of the one number.
    (left.max.x, right.min.x) = (0.5, 0.5);
    let points = numbers(61, 100_000).map(DVec3::from_array);
    for (index, (from, to)) in points
        .zip(numbers(62, 100_000).map(DVec3::from_array))
        .enumerate()
    {
        // From around the box to a point in it; of four rays one runs in the plane of the cut, and
        // one along an axis.
        let mut origin = from * 4.0 - 1.5;
        let mut target = to;
        if index % 4 == 0 {
            (origin.x, target.x) = (0.5, 0.5);
        }
        if index % 4 == 1 {
            (target.y, target.z) = (origin.y, origin.z);
        }
        let Some(ray) = Ray::new(origin, target - origin) else {
            continue;
        };
        let depth = |shape: &Aabb| {
            shape
                .span(&ray)
                .map_or(0.0, |span| optical_depth(sigma, span.length()))
        };
        let exit = whole.span(&ray).map_or(0.0, |span| span.far);
        let halves = depth(&left) + depth(&right);
        margin.within(
            format_args!("from {origin} to {target}"),
            halves,
            depth(&whole),
            8.0 * U * sigma * exit,
        );
    }
}

/// A soft ball of fog across a hard box of it, in the light of a lamp.
fn foggy(scale: f64, centre: DVec3) -> Radiative {
    let point_at = |x: f64, y: f64, z: f64| centre + DVec3::new(x, y, z) * scale;
    let bounds = cuboid(point_at(-1.0, -1.0, -1.0), point_at(1.0, 1.0, 1.0));
    let blob = Field::Blob(Blob {
        centre: point_at(0.25, 0.0, 0.125),
        peak: 1.0,
        width: 0.5 * scale,
    });
    let corner = cuboid(point_at(-0.5, -0.75, 0.0), point_at(0.5, 0.25, 0.75));
    let mut scene = before_sky(vec![
        heterogeneous(bounds, blob, grey(3.0 / scale, 0.75, 0.0)),
        in_box(corner, grey(2.0 / scale, 0.5, 0.5)),
    ]);
    scene.camera = Camera::new(point_at(0.5, 0.25, -4.0), centre, DVec3::Y, 0.5).expect("a view");
    scene.lights.push(Light::Point(Point {
        position: point_at(0.5, 2.0, -0.5),
        // Irradiance falls with the square of the distance.
        intensity: DVec3::splat(2.0 * scale * scale),
    }));
    scene
}

fn g7_direction_of_any_length(margin: &mut Margin) {
    let scene = foggy(1.0, DVec3::ZERO);
    // Entry, exit, and what is seen through the fog.
    let along = |scale: f64| {
        let ray = ray([0.3, 0.2, -5.0], DVec3::new(0.01, 0.02, 1.0) * scale);
        let span = unit_box()
            .span(&ray)
            .map_or([f64::NAN; 2], |span| [span.near, span.far]);
        [span[0], span[1], straight(&scene, &ray).x]
    };
    let right = along(1.0);
    for scale in [1_048_576.0, 1.0 / 1_048_576.0, 1e6, 1e-6] {
        let is_power_of_two = f64::to_bits(scale) << 12 == 0;
        let allowed = if is_power_of_two { 0.0 } else { 1e-14 };
        for (found, right) in along(scale).into_iter().zip(right) {
            let what = format_args!("direction times {scale}");
            margin.within(what, found, right, allowed * right);
        }
    }
}

fn g8_whole_scene_scaled(margin: &mut Margin) {
    let fog = |scale: f64| {
        let scene = Model::Radiative(Box::new(foggy(scale, DVec3::ZERO)));
        bits(&scene_of(scene, [8, 8]))
    };
    let smoke = |scale: f64| {
        let scene = Model::Classified(Box::new(plume(scale)));
        bits(&scene_of(scene, [8, 8]))
    };
    let large = f64::from(1 << 20) * f64::from(1 << 20);
    for scale in [large, 1.0 / large] {
        margin.same_picture(format_args!("fog times {scale:e}"), fog(scale), fog(1.0));
        margin.same_picture(
            format_args!("smoke times {scale:e}"),
            smoke(scale),
            smoke(1.0),
        );
    }
}

fn g9_far_from_the_origin(margin: &mut Margin) {
    let sigma = 2.0;
    let near = ray([0.3, 0.35, -1.1], [0.1, 0.2, 1.0]);
    for power in [20, 30, 40] {
        let offset = (1_u64 << power) as f64;
        let ulp = offset.next_up() - offset;
        // Here the numbers of the set-up themselves are rounded to the offset's last place.
        let far = Ray {
            origin: near.origin + offset,
            ..near
        };
        let moved = cuboid(DVec3::splat(offset), DVec3::splat(offset + 1.0));
        let spans =
            |shape: &Aabb, ray: &Ray| shape.span(ray).map_or([f64::NAN; 2], |s| [s.near, s.far]);
        let (found, right) = (spans(&moved, &far), spans(&unit_box(), &near));
        for (found, right) in found.into_iter().zip(right) {
            margin.within(format_args!("moved by 2^{power}"), found, right, 4.0 * ulp);
        }
        let depth = |[near, far]: [f64; 2]| optical_depth(sigma, far - near);
        let what = format_args!("depth, moved by 2^{power}");
        margin.within(what, depth(found), depth(right), sigma * 4.0 * ulp);
        let sphere = |centre, ray: &Ray| {
            ball(centre, 0.75)
                .spans(ray)
                .first()
                .map_or(f64::NAN, |span| span.near)
        };
        let (found, right) = (
            sphere(DVec3::splat(offset + 0.5), &far),
            sphere(DVec3::splat(0.5), &near),
        );
        margin.within(
            format_args!("sphere, moved by 2^{power}"),
            found,
            right,
            4.0 * ulp,
        );
    }
}

fn g10_far_and_grazed_sphere(margin: &mut Margin) {
    let unit = ball(DVec3::ZERO, 1.0);
    let distance = 1e8_f64;
    let ulp = distance.next_up() - distance;
    let far = ray([0.3, 0.0, -distance], DVec3::Z);
    let hit = unit.hit(&far, f64::INFINITY).map_or(f64::NAN, |hit| hit.t);
    margin.within("distance", hit, distance - 0.91_f64.sqrt(), 2.0 * ulp);
    // From the middle of the chord, for the ends of a span are numbers near 1 with their rounding.
    let grazed = ray([1.0 - 4.0 * f64::EPSILON, 0.0, 0.0], DVec3::Z);
    let half = unit
        .spans(&grazed)
        .first()
        .map_or(f64::NAN, |span| span.length());
    let chord = 8.429_369_702_178_8e-8;
    margin.within("grazed chord", 2.0 * half, chord, 1e-9 * chord);
    let beside = ray([1.0 + f64::EPSILON, 0.0, 0.0], DVec3::Z);
    margin.exact("beside", unit.spans(&beside).len(), 0);
}

fn g11_leaving_a_surface(margin: &mut Margin) {
    let turn = Transform::rotation(DVec3::new(1.0, 2.0, 3.0), 37.0).expect("an axis");
    for scale in [1e-6, 1.0, 1e6] {
        let centre = DVec3::new(5.0, -7.0, 11.0) * scale;
        let cube = cuboid(centre - scale, centre + scale);
        let shift = Transform::translation(centre).expect("finite");
        let unequal = Transform::scale(DVec3::new(scale, 3.0 * scale, 0.2 * scale)).expect("not 0");
        let ellipsoid = unequal.then(&turn).then(&shift);
        let triangles = Mesh::cuboid(&cube)
            .and_then(ClosedMesh::new)
            .expect("closed");
        let shapes: [(&str, Box<dyn Solid>); 5] = [
            ("sphere", Box::new(ball(centre, scale))),
            ("box", Box::new(cube)),
            ("turned box", Box::new(Placed::new(cube, turn.then(&shift)))),
            (
                "ellipsoid",
                Box::new(Placed::new(ball(DVec3::X, 1.0), ellipsoid)),
            ),
            ("box of triangles", Box::new(triangles)),
        ];
        for (name, shape) in &shapes {
            let what = |which: &str| format!("{which}, {name} of size {scale:e}");
            let (hits, self_hits, leaks) = leave(shape.as_ref());
            margin.holds(what("points are left"), hits >= 1000);
            margin.exact(what("self-hits"), self_hits, 0);
            margin.exact(what("leaks"), leaks, 0);
        }
        let floor = Rectangle::centred(centre, DVec3::X * scale, DVec3::Z * scale).expect("edges");
        let lamp = centre + DVec3::new(0.3, 0.5, -0.4) * scale;
        let shadowed = numbers(112, 2000).filter(|&[u, v, _]| {
            let towards = floor.sample([u, v]).towards_point(lamp);
            towards.is_none_or(|(ray, limit)| floor.hit(&ray, limit).is_some())
        });
        margin.exact(format_args!("plane of size {scale:e}"), shadowed.count(), 0);
    }
}

/// Leaves the convex `shape` from many points, to either side, at every angle down to 1e-12 of a
/// right one. Counts the points, self-hits, outwards, and leaks: rays inside that find no exit.
fn leave(shape: &dyn Solid) -> (usize, usize, usize) {
    let (centre, size) = (shape.bounds().centre(), shape.bounds().size().length());
    let (mut hits, mut self_hits, mut leaks) = (0, 0, 0);
    let directions = |seed| numbers(seed, 2000).map(|[u, v, _]| sampling::sphere([u, v]));
    let rays = directions(113)
        .zip(directions(114))
        .zip(directions(115))
        .enumerate();
    for (index, ((from, to), any)) in rays {
        let origin = centre + from * size * [1.0, 1e3, 0.0][index % 3];
        let target = centre + to * (0.1 * size);
        let hit = Ray::new(origin, target - origin).and_then(|ray| shape.hit(&ray, f64::INFINITY));
        let Some(hit) = hit else { continue };
        hits += 1;
        let normal = hit.point.normal;
        let along = (*any - normal * any.cosine_to(normal)).normalize();
        let steepness = [1.0, 1e-3, 1e-8, 1e-12][index % 4];
        let outward = Direction::of(along + normal * steepness);
        let outward = outward.and_then(|outward| hit.point.leave(outward));
        self_hits +=
            usize::from(outward.is_none_or(|ray| shape.hit(&ray, f64::INFINITY).is_some()));
        let is_inward = any.cosine_to(normal) < 0.0;
        let inward = hit.point.leave(if is_inward { any } else { -any });
        let exit = inward.and_then(|ray| shape.hit(&ray, f64::INFINITY));
        leaks += usize::from(exit.is_none_or(|exit| exit.side != Side::Back));
    }
    (hits, self_hits, leaks)
}

fn g12_grid_walk(margin: &mut Margin) {
    const SIDE: usize = 8;
    const MOST_CELLS: usize = 3 * SIDE + 1;
    let bounds = cuboid(DVec3::ZERO, DVec3::splat(8.0));
    let mut rays = Vec::new();
    for plane in 0..SIDE {
        rays.push(ray([-1.0, plane as f64, 2.5], DVec3::X));
        rays.push(ray([2.5, 9.0, plane as f64], DVec3::NEG_Y));
    }
    for signs in 0..8 {
        let sign = |axis: usize| if signs >> axis & 1 == 0 { 1.0 } else { -1.0 };
        let direction = DVec3::new(sign(0), sign(1), sign(2));
        rays.push(ray(DVec3::splat(4.0) - 6.0 * direction, direction));
    }
    for ray in rays {
        let chord = bounds.span(&ray).unwrap_or(Span {
            near: 0.0,
            far: f64::NAN,
        });
        let visits: Vec<_> = Walk::new([SIDE; 3], ray.origin, *ray.direction, chord).collect();
        let what = format!("from {} along {}", ray.origin, *ray.direction);
        margin.holds(
            format_args!("{what}: few cells"),
            visits.len() <= MOST_CELLS,
        );
        let forwards = visits.iter().all(|visit| visit.span.length() >= 0.0);
        margin.holds(format_args!("{what}: no length below 0"), forwards);
        let sum: f64 = visits.iter().map(|visit| visit.span.length()).sum();
        margin.within(what, sum, chord.length(), 8.0 * U * chord.far);
    }
    let endless = Span {
        near: 0.0,
        far: f64::INFINITY,
    };
    let walk = Walk::new([SIDE; 3], DVec3::splat(0.5), DVec3::X, endless);
    margin.holds(
        "a walk without an end has few cells",
        walk.take(1000).count() <= MOST_CELLS,
    );
}
