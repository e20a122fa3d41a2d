//! G: rays, boxes, spheres and cells.

use super::margin::{Margin, U};
use super::scenes::*;
use crate::geometry::{
    Aabb, Camera, ClosedMesh, Direction, Emitter, Mesh, Placed, Ray, Rectangle, Side, Solid, Span,
    Surface, Transform,
};
use crate::math::sampling;
use crate::optics::{Field, Light, Point, optical_depth, transmittance};
use crate::scene::Radiative;
use crate::volume::{Blob, Walk};
use glam::DVec3;

/// Both ends of the span of `ray` in `shape`; not numbers where it misses.
fn ends(shape: &Aabb, ray: &Ray) -> [f64; 2] {
    let span = shape.span(ray);
    span.map_or([f64::NAN; 2], |span| [span.near, span.far])
}

/// The length of `ray` in `shape`.
fn chord(shape: &Aabb, ray: &Ray) -> f64 {
    shape.span(ray).map_or(0.0, |span| span.length())
}

#[test]
fn g3_corner_and_edge() {
    let margin = &Margin;
    let diagonal = chord(&unit_box(), &ray([-1.0; 3], [1.0; 3]));
    margin.roundings("diagonal", diagonal, 3.0_f64.sqrt(), 16.0);
    // Through the edge x = 0, y = 1 only.
    let touching = chord(&unit_box(), &ray([-1.0, 0.0, 0.5], [1.0, 1.0, 0.0]));
    margin.exact("length at one edge", touching, 0.0);
    margin.exact("one edge", transmittance(optical_depth(5.0, touching)), 1.0);
}

#[test]
fn g4_origin_on_a_face() {
    let margin = &Margin;
    let out = chord(&unit_box(), &ray([0.5, 0.5, 0.0], DVec3::NEG_Z));
    margin.within("on a face, looking out", out, 0.0, 0.0);
}

#[test]
fn g5_flat_and_inverted_boxes() {
    let margin = &Margin;
    let flat = cuboid(DVec3::ZERO, [1.0, 0.0, 1.0]);
    for towards in [DVec3::Y, DVec3::X, DVec3::ONE] {
        let ray = ray(DVec3::new(0.5, 0.0, 0.5) - towards, towards);
        let depth = optical_depth(9.0, chord(&flat, &ray));
        margin.exact(format_args!("flat, along {towards}"), depth, 0.0);
    }
    let inverted = Aabb::new(DVec3::ONE, DVec3::new(2.0, 0.5, 2.0));
    let refused = inverted.is_err();
    margin.holds("an inverted box is refused", refused);
    let no_number = Aabb::new(DVec3::splat(f64::NAN), DVec3::ONE);
    margin.holds("a box that is no number is refused", no_number.is_err());
}

#[test]
fn g6_two_halves_are_the_whole() {
    let margin = &Margin;
    let sigma = 3.0;
    let whole = unit_box();
    let (mut left, mut right) = (whole, whole);
    // Both have the bits of the one number.
    (left.max.x, right.min.x) = (0.5, 0.5);
    let points = |seed| numbers(seed, 100_000).map(DVec3::from_array);
    for (index, (from, mut target)) in points(61).zip(points(62)).enumerate() {
        // From around the box to a point in it; of four rays one runs in the plane of the cut, and
        // one along an axis.
        let mut origin = from * 4.0 - 1.5;
        match index % 4 {
            0 => (origin.x, target.x) = (0.5, 0.5),
            1 => (target.y, target.z) = (origin.y, origin.z),
            _ => (),
        }
        let Some(ray) = Ray::new(origin, target - origin) else {
            continue;
        };
        let depth = |shape| optical_depth(sigma, chord(shape, &ray));
        let halves = depth(&left) + depth(&right);
        let exit = whole.span(&ray).map_or(0.0, |span| span.far);
        let what = format_args!("from {origin} to {target}");
        margin.within(what, halves, depth(&whole), 8.0 * U * sigma * exit);
    }
}

/// A soft ball of fog across a hard box of it, in the light of a lamp.
fn foggy(scale: f64) -> Radiative {
    let point_at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) * scale;
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
    let eye = point_at(0.5, 0.25, -4.0);
    scene.camera = Camera::new(eye, DVec3::ZERO, DVec3::Y, 0.5).expect("a view");
    scene.lights.push(Light::Point(Point {
        position: point_at(0.5, 2.0, -0.5),
        // Irradiance falls with the square of the distance.
        intensity: DVec3::splat(2.0 * scale * scale),
    }));
    scene
}

#[test]
fn g7_direction_of_any_length() {
    let margin = &Margin;
    let scene = foggy(1.0);
    // Entry, exit, and what is seen through the fog.
    let along = |scale: f64| {
        let ray = ray([0.3, 0.2, -5.0], DVec3::new(0.01, 0.02, 1.0) * scale);
        let [near, far] = ends(&unit_box(), &ray);
        [near, far, straight(&scene, &ray).x]
    };
    for (scale, share) in [
        (1_048_576.0, 0.0),
        (1.0 / 1_048_576.0, 0.0),
        (1e6, 1e-14),
        (1e-6, 1e-14),
    ] {
        for (found, right) in along(scale).into_iter().zip(along(1.0)) {
            let what = format_args!("direction times {scale}");
            margin.relative(what, found, right, share);
        }
    }
}

#[test]
fn g8_whole_scene_scaled() {
    let margin = &Margin;
    let fog = |scale| bits(&scene_of(foggy(scale), [8, 8]));
    let smoke = |scale| bits(&scene_of(plume(scale), [8, 8]));
    let large = f64::from(1 << 20) * f64::from(1 << 20);
    for scale in [large, 1.0 / large] {
        margin.same_picture(format_args!("fog times {scale:e}"), fog(scale), fog(1.0));
        let what = format_args!("smoke times {scale:e}");
        margin.same_picture(what, smoke(scale), smoke(1.0));
    }
}

#[test]
fn g9_far_from_the_origin() {
    let margin = &Margin;
    let sigma = 2.0;
    let near = ray([0.3, 0.35, -1.1], [0.1, 0.2, 1.0]);
    // Entry and exit of the box, the depth between them, and entry of a sphere.
    let seen = |offset: f64| {
        // Far away the numbers of the set-up themselves are rounded to the offset's last place.
        let origin = near.origin + offset;
        let ray = Ray { origin, ..near };
        let shape = cuboid(DVec3::splat(offset), DVec3::splat(offset + 1.0));
        let [entry, exit] = ends(&shape, &ray);
        let spans = ball(DVec3::splat(offset + 0.5), 0.75).spans(&ray);
        let sphere = spans.first().map_or(f64::NAN, |span| span.near);
        [entry, exit, optical_depth(sigma, exit - entry), sphere]
    };
    for power in [20, 30, 40] {
        let offset = (1_u64 << power) as f64;
        let allowed = 4.0 * (offset.next_up() - offset);
        let allowed = [allowed, allowed, sigma * allowed, allowed];
        let names = ["entry", "exit", "depth", "sphere"];
        for (index, name) in names.into_iter().enumerate() {
            let (found, right) = (seen(offset)[index], seen(0.0)[index]);
            let what = format_args!("{name}, moved by 2^{power}");
            margin.within(what, found, right, allowed[index]);
        }
    }
}

#[test]
fn g10_far_and_grazed_sphere() {
    let margin = &Margin;
    let unit = ball(DVec3::ZERO, 1.0);
    let distance = 1e8_f64;
    let ulp = distance.next_up() - distance;
    let far = ray([0.3, 0.0, -distance], DVec3::Z);
    let hit = unit.hit(&far, f64::INFINITY).map_or(f64::NAN, |hit| hit.t);
    margin.within("distance", hit, distance - 0.91_f64.sqrt(), 2.0 * ulp);
    // From the middle of the chord, for the ends of a span are numbers near 1 with their rounding.
    let grazed = unit.spans(&ray([1.0 - 4.0 * f64::EPSILON, 0.0, 0.0], DVec3::Z));
    let half = grazed.first().map_or(f64::NAN, |span| span.length());
    margin.relative("grazed chord", 2.0 * half, 8.429_369_702_178_8e-8, 1e-9);
    let beside = ray([1.0 + f64::EPSILON, 0.0, 0.0], DVec3::Z);
    margin.exact("beside", unit.spans(&beside).len(), 0);
}

#[test]
fn g11_leaving_a_surface() {
    let margin = &Margin;
    let turn = Transform::rotation(DVec3::new(1.0, 2.0, 3.0), 37.0).expect("an axis");
    for scale in [1e-6, 1.0, 1e6] {
        let centre = DVec3::new(5.0, -7.0, 11.0) * scale;
        let cube = cuboid(centre - scale, centre + scale);
        let shift = Transform::translation(centre).expect("finite");
        let unequal = Transform::scale(DVec3::new(scale, 3.0 * scale, 0.2 * scale)).expect("not 0");
        let ellipsoid = Placed::new(ball(DVec3::X, 1.0), unequal.then(&turn).then(&shift));
        let triangles = Mesh::cuboid(&cube).and_then(ClosedMesh::new);
        let shapes: [(&str, &dyn Solid); 5] = [
            ("sphere", &ball(centre, scale)),
            ("box", &cube),
            ("turned box", &Placed::new(cube, turn.then(&shift))),
            ("ellipsoid", &ellipsoid),
            ("box of triangles", &triangles.expect("closed")),
        ];
        for (name, shape) in shapes {
            let what = |which: &str| format!("{which}, {name} of size {scale:e}");
            let (hits, self_hits, leaks) = leave(shape);
            margin.holds(what("points are left"), hits >= 1000);
            margin.exact(what("self-hits"), self_hits, 0);
            margin.exact(what("leaks"), leaks, 0);
        }
        let floor = Rectangle::new(
            centre - (DVec3::X + DVec3::Z) * scale,
            DVec3::X * (2.0 * scale),
            DVec3::Z * (2.0 * scale),
        )
        .expect("edges");
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
    let first_hit = |ray: Ray| shape.hit(&ray, f64::INFINITY);
    let directions = |seed| numbers(seed, 2000).map(|[u, v, _]| sampling::sphere([u, v]));
    let ends = directions(113).zip(directions(114));
    for (index, ((from, to), any)) in ends.zip(directions(115)).enumerate() {
        let origin = centre + from * size * [1.0, 1e3, 0.0][index % 3];
        let target = centre + to * (0.1 * size);
        let Some(hit) = Ray::new(origin, target - origin).and_then(first_hit) else {
            continue;
        };
        hits += 1;
        let normal = hit.point.normal;
        let along = (*any - normal * any.cosine_to(normal)).normalize();
        let steepness = [1.0, 1e-3, 1e-8, 1e-12][index % 4];
        let outward = Direction::of(along + normal * steepness);
        let outward = outward.and_then(|outward| hit.point.leave(outward));
        self_hits += usize::from(outward.is_none_or(|ray| first_hit(ray).is_some()));
        let is_inward = any.cosine_to(normal) < 0.0;
        let inward = hit.point.leave(if is_inward { any } else { -any });
        let exit = inward.and_then(first_hit);
        leaks += usize::from(exit.is_none_or(|exit| exit.side != Side::Back));
    }
    (hits, self_hits, leaks)
}

#[test]
fn g12_grid_walk() {
    let margin = &Margin;
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
        let chord = bounds.span(&ray).unwrap_or(Span::new(0.0, f64::NAN));
        let visits = Walk::new([SIDE; 3], ray.origin, *ray.direction, chord);
        let lengths: Vec<_> = visits.map(|visit| visit.span.length()).collect();
        let what = format!("from {} along {}", ray.origin, *ray.direction);
        let is_few = lengths.len() <= MOST_CELLS;
        margin.holds(format_args!("{what}: few cells"), is_few);
        let forwards = lengths.iter().all(|&length| length >= 0.0);
        margin.holds(format_args!("{what}: no length below 0"), forwards);
        let sum = lengths.iter().sum();
        margin.within(what, sum, chord.length(), 8.0 * U * chord.far);
    }
    let endless = Span::new(0.0, f64::INFINITY);
    let walk = Walk::new([SIDE; 3], DVec3::splat(0.5), DVec3::X, endless);
    let few = walk.take(1000).count() <= MOST_CELLS;
    margin.holds("a walk without an end has few cells", few);
}
