//! Laws of shapes, meshes and transforms. Names that begin with `g` are hard cases.

use crate::common;
use crate::common::direction;
use crate::meshes;
use crate::meshes::{closed, cuboid, icosphere, knot};
use glam::{DMat3, DVec3};
use proptest::prelude::*;
use volref::geometry::*;

/// Half a unit in the last place of 1.
const U: f64 = f64::EPSILON / 2.0;

fn config() -> ProptestConfig {
    common::failures_in("fixtures/proptest-regressions/geometry_laws.txt")
}

fn vector(size: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-size..size).prop_map(DVec3::from_array)
}

fn ray() -> impl Strategy<Value = Ray> {
    (vector(3.0), direction()).prop_map(|(origin, towards)| Ray::new(origin, towards).unwrap())
}

/// A ray aimed so that it often meets what lies around the origin, with coordinates that often
/// are those of corners.
fn aimed_ray() -> impl Strategy<Value = Ray> {
    let snapped = || {
        (vector(1.0), any::<[bool; 3]>()).prop_map(|(v, snap)| {
            let pick = |k: usize| if snap[k] { v[k].signum() } else { v[k] };
            DVec3::new(pick(0), pick(1), pick(2))
        })
    };
    let straight = (snapped(), 0..3_usize)
        .prop_map(|(target, axis)| (target - DVec3::AXES[axis] * 3.0, target));
    prop_oneof![(vector(3.0), snapped()), (snapped(), snapped()), straight]
        .prop_filter_map("a direction", |(from, to)| Ray::new(from, to - from))
}

fn transform() -> impl Strategy<Value = Transform> {
    let factors = prop::array::uniform3(prop_oneof![0.2..5.0, -5.0..-0.2]);
    (vector(1.0), -720.0..720.0, factors, vector(10.0)).prop_filter_map(
        "an axis",
        |(axis, degrees, factors, offset)| {
            let turn = Transform::rotation(axis, degrees).ok()?;
            let scale = Transform::scale(factors.into()).unwrap();
            let shift = Transform::translation(offset).unwrap();
            Some(scale.then(&turn).then(&shift))
        },
    )
}

fn same_spans(a: &[Span], b: &[Span], tolerance: f64) -> bool {
    // Stretches shorter than the tolerance may be there or not.
    let long = |spans: &[Span]| -> Vec<Span> {
        spans
            .iter()
            .copied()
            .filter(|span| span.length() > tolerance)
            .collect()
    };
    let (a, b) = (long(a), long(b));
    a.len() == b.len()
        && a.iter().zip(&b).all(|(a, b)| {
            (a.near - b.near).abs() <= tolerance && (a.far - b.far).abs() <= tolerance
        })
}

fn unit_box() -> Aabb {
    Aabb::new(DVec3::NEG_ONE, DVec3::ONE).unwrap()
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn a_transform_and_its_inverse_cancel(map in transform(), p in vector(10.0)) {
        // Condition up to 25·3, coordinates up to 100: generous, but no more than a few
        // hundred roundings.
        let there_and_back = map.inverse().point(map.point(p));
        prop_assert!((there_and_back - p).length() <= 75.0 * 100.0 * 16.0 * U);
        let n = map.then(&map.inverse());
        prop_assert!((n.point(p) - p).length() <= 75.0 * 100.0 * 32.0 * U);
    }

    #[test]
    fn composition_is_one_after_the_other(a in transform(), b in transform(), p in vector(10.0)) {
        let (at_once, in_turn) = (a.then(&b).point(p), b.point(a.point(p)));
        prop_assert!((at_once - in_turn).length() <= 5000.0 * 32.0 * U);
    }

    #[test]
    fn normals_stay_normal(map in transform(), a in direction(), b in direction()) {
        let Some(normal) = Direction::of(a.cross(b)) else { return Ok(()) };
        let tangent = map.vector(a);
        let cosine = map.normal(normal).dot(tangent / tangent.length());
        // `normal` itself is off by a few roundings over the sine of the angle between a and b.
        let sine = a.cross(b).length() / (a.length() * b.length());
        prop_assert!(cosine.abs() <= 75.0 * 64.0 * U / sine);
    }

    #[test]
    fn a_matrix_and_its_factors_agree(map in transform(), p in vector(1.0)) {
        let column = |v: DVec3| map.vector(v);
        let matrix = DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z));
        let again = Transform::from_matrix(matrix, map.point(DVec3::ZERO)).unwrap();
        let q = map.point(p);
        let difference = again.inverse().point(q) - map.inverse().point(q);
        prop_assert!(difference.length() <= 625.0 * 20.0 * 64.0 * U);
    }

    #[test]
    fn placed_hits_are_at_world_distances(map in transform(), ray in ray()) {
        let sphere = Placed::new(Sphere::new(DVec3::ZERO, 1.0).unwrap(), map);
        if let Some(hit) = sphere.hit(&ray, f64::INFINITY) {
            // On a grazed ellipsoid the distance is as good as the root of the error.
            prop_assert!((ray.at(hit.t) - hit.point.position).length() <= 1e-5);
            let facing = hit.point.normal.cosine_to(ray.direction);
            prop_assert!((facing < 1e-6) == (hit.side == Side::Front) || facing.abs() < 1e-6);
        }
    }

    #[test]
    fn the_first_hit_is_where_the_spans_say(ray in ray(), aimed in aimed_ray()) {
        let (sphere, cube) = (Sphere::new(DVec3::ZERO, 1.0).unwrap(), unit_box());
        let knot = closed(knot(24, 8));
        let shapes: [&dyn Solid; 3] = [&sphere, &cube, &knot];
        for (shape, ray) in shapes.into_iter().flat_map(|shape| [(shape, &ray), (shape, &aimed)]) {
            let spans = shape.spans(ray);
            prop_assert!(spans.iter().all(|span| 0.0 <= span.near && span.near <= span.far));
            prop_assert!(spans.windows(2).all(|pair| pair[0].far <= pair[1].near));
            let ends = spans.iter().flat_map(|span| [span.near, span.far]);
            let first = ends.filter(|&t| t > 0.0).reduce(f64::min);
            if let (Some(first), Some(hit)) = (first, shape.hit(ray, f64::INFINITY)) {
                prop_assert!((first - hit.t).abs() <= 64.0 * U * (first + 3.0), "{first} {hit:?}");
            } else {
                // A ray that only touches may be told either way.
                let inside: f64 = spans.iter().map(Span::length).sum();
                prop_assert!(inside == 0.0, "{spans:?}");
            }
        }
    }

    /// The faces of the mesh are off by 30uS each way; what that moves along the ray is more by
    /// the cosine, and 1/16 of a box's diagonal is the least a tested ray is inside.
    #[test]
    fn a_box_of_triangles_is_a_box(ray in aimed_ray()) {
        let (min, max) = (DVec3::NEG_ONE, DVec3::ONE);
        let mesh = closed(cuboid(min, max)).spans(&ray);
        let cosine = ray.direction.abs().to_array().into_iter().filter(|&c| c > 0.0);
        let tolerance = 64.0 * U * 5.0 / cosine.fold(1.0, f64::min);
        let same = same_spans(&mesh, &unit_box().spans(&ray), tolerance);
        // In a face the box belongs to its minimum only; the mesh may see either.
        let in_a_face = (0..3).any(|k| ray.direction[k] == 0.0 && ray.origin[k].abs() == 1.0);
        prop_assert!(same || in_a_face, "{mesh:?} {:?}", unit_box().spans(&ray));
    }

    #[test]
    fn g8_scaling_by_powers_of_two_moves_no_bit(ray in aimed_ray()) {
        let (vertices, faces) = icosphere(1);
        for scale in [1_u64 << 40, 1 << 20].into_iter().flat_map(|k| [k as f64, 1.0 / k as f64]) {
            let scaled = Ray { origin: ray.origin * scale, ..ray };
            let larger = vertices.iter().map(|&v| v * scale).collect();
            let pairs: [(Box<dyn Solid>, Box<dyn Solid>); 3] = [
                (Box::new(unit_box()), Box::new(Aabb::new(DVec3::splat(-scale), DVec3::splat(scale)).unwrap())),
                (Box::new(Sphere::new(DVec3::X, 1.5).unwrap()), Box::new(Sphere::new(DVec3::X * scale, 1.5 * scale).unwrap())),
                (Box::new(closed((vertices.clone(), faces.clone()))), Box::new(closed((larger, faces.clone())))),
            ];
            for (one, other) in &pairs {
                let grown: Vec<Span> = one.spans(&ray).iter()
                    .map(|span| Span { near: span.near * scale, far: span.far * scale })
                    .collect();
                prop_assert_eq!(grown, other.spans(&scaled));
                let (a, b) = (one.hit(&ray, f64::INFINITY), other.hit(&scaled, f64::INFINITY));
                prop_assert_eq!(a.is_some(), b.is_some());
                if let (Some(a), Some(b)) = (a, b) {
                    prop_assert_eq!(a.t * scale, b.t);
                    prop_assert_eq!(a.point.position * scale, b.point.position);
                    prop_assert_eq!(a.point.clearance * scale, b.point.clearance);
                    prop_assert_eq!((a.face, a.side, a.uv), (b.face, b.side, b.uv));
                }
            }
        }
    }

    /// On a lattice that the far place can represent, moving is exact and so is everything else.
    #[test]
    fn g9_far_from_the_origin(
        from in prop::array::uniform3(-1024..1024_i32),
        towards in direction(),
        power in prop_oneof![Just(20), Just(30), Just(40)],
    ) {
        let ray = Ray::new(DVec3::from_array(from.map(|k| f64::from(k) / 256.0)), towards).unwrap();
        let offset = DVec3::splat((1_u64 << power) as f64);
        let far = Ray { origin: ray.origin + offset, ..ray };
        let (near_box, far_box) = (cuboid(DVec3::NEG_ONE, DVec3::ONE), cuboid(offset - 1.0, offset + 1.0));
        prop_assert_eq!(closed(near_box).spans(&ray), closed(far_box).spans(&far));
        let sphere = |centre| Sphere::new(centre, 1.25).unwrap();
        prop_assert_eq!(sphere(DVec3::ZERO).spans(&ray), sphere(offset).spans(&far));
        prop_assert_eq!(unit_box().spans(&ray), Aabb::new(offset - 1.0, offset + 1.0).unwrap().spans(&far));
    }

    #[test]
    fn mutated_files_never_panic(edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4_u8), 1..12)) {
        let parts = cuboid(DVec3::ZERO, DVec3::ONE);
        let mut text = meshes::obj("mutated", &parts).into_bytes();
        let pieces: [&[u8]; 8] = [b"-", b"nan", b"1e999", b"\nf 1 2\n", b"\nf -9999999999999999999 1 2 3\n", b"/", b"\no x\n", b"4294967296"];
        for (place, byte, kind) in edits {
            if text.is_empty() { break; }
            let at = place.index(text.len());
            match kind {
                0 => text[at] = byte,
                1 => { text.remove(at); }
                2 => { text.splice(at..at, pieces[byte as usize % 8].iter().copied()); }
                _ => text.truncate(at.max(1)),
            }
        }
        if let Ok(mesh) = Mesh::from_obj(&text) {
            let ray = Ray::new(DVec3::new(0.3, 0.4, -2.0), DVec3::Z).unwrap();
            mesh.hit(&ray, f64::INFINITY);
            let _ = ClosedMesh::new(mesh).map(|solid| solid.spans(&ray));
        }
    }
}

/// Numbers in [0, 1) without pattern.
fn spread(index: usize, dimension: usize) -> f64 {
    let steps = [
        0.819_172_513_396_164_4,
        0.671_043_606_703_789_2,
        0.549_700_477_901_970_5,
    ];
    (index as f64 * steps[dimension % 3] + 0.37 * dimension as f64).fract()
}

fn sphere_direction(index: usize) -> Direction {
    let unit = Sphere::new(DVec3::ZERO, 1.0).unwrap();
    unit.sample([spread(index, 0), spread(index, 1)]).normal
}

#[test]
fn the_hierarchy_changes_no_bit() {
    let (vertices, faces) = knot(24, 8);
    let whole = Mesh::new(vertices.clone(), faces.clone()).unwrap();
    let single = |face: &[usize; 3]| Mesh::new(vertices.clone(), vec![*face]).unwrap();
    let singles: Vec<Mesh> = faces.iter().map(single).collect();
    for index in 0..4000 {
        let target = vertices[index % vertices.len()];
        let mut origin = sphere_direction(index) * 2.0;
        if index % 3 == 0 {
            origin = target + DVec3::AXES[index % 9 / 3] * 2.0;
        }
        let aim = if index % 2 == 0 {
            target
        } else {
            sphere_direction(index + 7) * 0.8
        };
        let ray = Ray::new(origin, aim - origin).unwrap();
        let hits = singles.iter().enumerate().filter_map(|(face, mesh)| {
            let hit = mesh.hit(&ray, f64::INFINITY)?;
            Some((hit.t, face, hit.uv))
        });
        let nearest = hits.reduce(|a, b| if b.0 < a.0 { b } else { a });
        let found = whole
            .hit(&ray, f64::INFINITY)
            .map(|hit| (hit.t, hit.face, hit.uv));
        assert_eq!(found, nearest, "{ray:?}");
    }
}

#[test]
fn finer_meshes_approach_the_sphere_in_second_order() {
    let sphere = Sphere::new(DVec3::ZERO, 1.0).unwrap();
    let error = |levels| {
        let mesh = closed(icosphere(levels));
        let rays = (0..500).map(|index| {
            let origin = sphere_direction(index) * 3.0;
            Ray::new(origin, sphere_direction(index + 999) * 0.7 - origin).unwrap()
        });
        let chord = |spans: Vec<Span>| spans.iter().map(Span::length).sum::<f64>();
        let errors = rays.map(|ray| (chord(mesh.spans(&ray)) - chord(sphere.spans(&ray))).abs());
        errors.sum::<f64>() / 500.0
    };
    let (coarse, fine) = (error(2), error(3));
    assert!((3.5..4.5).contains(&(coarse / fine)), "{coarse} {fine}");
    let area = closed(icosphere(4)).mesh().area();
    assert!((area / sphere.area() - 1.0).abs() < 2e-3);
}

#[test]
fn g7_scaled_instances_keep_world_distances() {
    let ray = Ray::new(DVec3::new(0.3, 0.2, -5.0), DVec3::new(0.01, 0.02, 1.0)).unwrap();
    let expected = unit_box().spans(&ray)[0];
    for scale in [1048576.0, 1.0 / 1048576.0, 1e6, 1e-6] {
        let grow = Transform::scale(DVec3::splat(scale)).unwrap();
        let small = Aabb::new(DVec3::splat(-1.0 / scale), DVec3::splat(1.0 / scale)).unwrap();
        let span = Placed::new(small, grow).spans(&ray)[0];
        let tolerance = if scale.log2_is_whole() { 0.0 } else { 1e-14 };
        assert!(
            (span.near - expected.near).abs() <= tolerance * expected.near,
            "{scale}"
        );
        assert!(
            (span.far - expected.far).abs() <= tolerance * expected.far,
            "{scale}"
        );
    }
}

trait PowerOfTwo {
    fn log2_is_whole(self) -> bool;
}

impl PowerOfTwo for f64 {
    fn log2_is_whole(self) -> bool {
        self.to_bits() << 12 == 0
    }
}

#[test]
fn the_smoke_boxes_of_the_source() {
    // 165 × 330 × 165, turned by 15° about y, moved to (265, 0, 295).
    let cuboid = Aabb::new(DVec3::ZERO, DVec3::new(165.0, 330.0, 165.0)).unwrap();
    let turn = Transform::rotation(DVec3::Y, 15.0).unwrap();
    let shift = Transform::translation(DVec3::new(265.0, 0.0, 295.0)).unwrap();
    let placed = Placed::new(cuboid, turn.then(&shift));
    // Straight down through its middle: all of its height, and the floor it stands on.
    let top = placed.to_world().point(DVec3::new(82.5, 500.0, 82.5));
    let span = placed.spans(&Ray::new(top, DVec3::NEG_Y).unwrap())[0];
    assert!((span.near - 170.0).abs() < 1e-12 && (span.far - 500.0).abs() < 1e-12);
    // Across, along its own x axis, and as a mesh.
    let along = placed.to_world().vector(DVec3::X);
    let ray = Ray::new(
        placed.to_world().point(DVec3::new(-10.0, 99.0, 40.0)),
        along,
    )
    .unwrap();
    let as_mesh = closed(meshes::cuboid(cuboid.min, cuboid.max));
    let as_mesh = as_mesh.mesh().transformed(placed.to_world()).unwrap();
    let as_mesh = ClosedMesh::new(as_mesh).unwrap();
    for span in [placed.spans(&ray)[0], as_mesh.spans(&ray)[0]] {
        assert!((span.near - 10.0).abs() < 1e-12 && (span.far - 175.0).abs() < 1e-12);
    }
}

/// Leaves `shape` from many points, to either side and at every angle down to 1e-12 of a right
/// one. Counts self-hits (outward from a convex shape) and leaks (inward without an exit).
fn g11_leave(shape: &dyn Solid, convex: bool) -> (usize, usize) {
    let (centre, size) = (shape.bounds().centre(), shape.bounds().size().length());
    let (mut self_hits, mut leaks) = (0, 0);
    for index in 0..3000 {
        let origin = centre + sphere_direction(index) * size * [1.0, 1e3, 0.0][index % 3];
        let inside = centre + sphere_direction(index + 5) * (0.3 * size);
        let hit = Ray::new(origin, inside - origin).and_then(|ray| shape.hit(&ray, f64::INFINITY));
        let Some(hit) = hit else { continue };
        let normal = hit.point.normal;
        let any = sphere_direction(3 * index + 1);
        let along = (*any - normal * any.cosine_to(normal)).normalize();
        let steepness = [1.0, 1e-3, 1e-8, 1e-12][index % 4];
        let outward = Direction::of(along + normal * steepness).unwrap();
        let outward = hit.point.leave(outward).unwrap();
        if convex && shape.hit(&outward, f64::INFINITY).is_some() {
            self_hits += 1;
        }
        let is_inward = any.cosine_to(normal) < 0.0;
        let inward = hit.point.leave(if is_inward { any } else { -any }).unwrap();
        match shape.hit(&inward, f64::INFINITY) {
            Some(exit) if exit.side == Side::Back => {}
            _ => leaks += 1,
        }
    }
    (self_hits, leaks)
}

#[test]
fn g11_no_self_hit_and_no_leak_at_any_size() {
    let turn = Transform::rotation(DVec3::new(1.0, 2.0, 3.0), 37.0).unwrap();
    for scale in [
        1.0,
        1e6,
        1e-6,
        1_099_511_627_776.0,
        1.0 / 1_099_511_627_776.0,
    ] {
        for centre in [DVec3::ZERO, DVec3::new(5.0, -7.0, 11.0) * scale] {
            let grown = |(vertices, faces): meshes::Parts| {
                closed((
                    vertices.iter().map(|&v| centre + v * scale).collect(),
                    faces,
                ))
            };
            let cube = Aabb::new(centre - scale, centre + scale).unwrap();
            let shift = Transform::translation(centre * 3.0).unwrap();
            let unequal = Transform::scale(DVec3::new(scale, 3.0 * scale, 0.2 * scale)).unwrap();
            let shapes: [(&str, Box<dyn Solid>, bool); 7] = [
                (
                    "sphere",
                    Box::new(Sphere::new(centre, scale).unwrap()),
                    true,
                ),
                ("box", Box::new(cube), true),
                (
                    "turned box",
                    Box::new(Placed::new(cube, turn.then(&shift))),
                    true,
                ),
                (
                    "ellipsoid",
                    Box::new(Placed::new(
                        Sphere::new(DVec3::X, 1.0).unwrap(),
                        unequal.then(&turn).then(&shift),
                    )),
                    true,
                ),
                (
                    "box of triangles",
                    Box::new(grown(cuboid(DVec3::NEG_ONE, DVec3::ONE))),
                    true,
                ),
                ("icosphere", Box::new(grown(icosphere(1))), true),
                ("knot", Box::new(grown(knot(24, 8))), false),
            ];
            for (name, shape, convex) in &shapes {
                assert_eq!(
                    g11_leave(shape.as_ref(), *convex),
                    (0, 0),
                    "{name} {scale} {centre}"
                );
            }
        }
    }
}

#[test]
fn g11_shadow_rays_meet_neither_end() {
    for scale in [1.0, 1e6, 1e-6] {
        let floor = Rectangle::new(
            DVec3::ZERO,
            DVec3::Z * 555.0 * scale,
            DVec3::X * 555.0 * scale,
        )
        .unwrap();
        let light = Rectangle::new(
            DVec3::new(113.0, 554.0, 127.0) * scale,
            DVec3::X * 330.0 * scale,
            DVec3::Z * 305.0 * scale,
        )
        .unwrap();
        let ball = Sphere::new(DVec3::new(100.0, 90.0, 400.0) * scale, 90.0 * scale).unwrap();
        for index in 0..5000 {
            let place = |k: usize| [spread(index + k, 0), spread(index + k, 1)];
            let at_light = light.sample(place(0));
            let (ray, limit) = floor.sample(place(77)).towards_surface(&at_light).unwrap();
            assert!(floor.hit(&ray, limit).is_none() && light.hit(&ray, limit).is_none());
            let at_ball = ball.sample(place(3));
            let (ray, limit) = at_ball.towards_surface(&at_light).unwrap();
            let facing = at_ball.normal.cosine_to(ray.direction) > 0.0;
            assert_eq!(ball.hit(&ray, limit).is_none(), facing);
        }
    }
}

#[test]
fn samples_are_uniform_and_on_the_surface() {
    let sphere = Sphere::new(DVec3::new(1.0, 2.0, 3.0), 2.0).unwrap();
    let mesh = closed(icosphere(2)).mesh().clone();
    let mean = |emitter: &dyn Emitter| {
        let at = |index| {
            emitter
                .sample([spread(index, 0), spread(index, 1)])
                .position
        };
        (0..20_000).map(at).sum::<DVec3>() / 20_000.0
    };
    assert!((mean(&sphere) - sphere.centre()).length() < 2e-3);
    // The first number also chooses the face, which leaves no more than chance: the standard
    // error of a mean of unit vectors is √(1/20 000) = 0.007.
    assert!(mean(&mesh).length() < 0.02);
    for uv in [[0.0, 0.0], [1.0 - U, 1.0 - U], [0.0, 1.0 - U], [0.3, 0.9]] {
        let point = sphere.sample(uv);
        assert!(((point.position - sphere.centre()).length() - 2.0).abs() < 1e-15 * 8.0);
        assert!((0.93..=1.0 + U).contains(&mesh.sample(uv).position.length()));
    }
    assert_eq!(sphere.pdf() * sphere.area(), 1.0);
}

#[test]
fn meshes_that_bound_nothing_are_refused_by_name() {
    let (vertices, faces) = cuboid(DVec3::ZERO, DVec3::ONE);
    let refused = |faces: &[[usize; 3]]| {
        ClosedMesh::new(Mesh::new(vertices.clone(), faces.to_vec()).unwrap()).unwrap_err()
    };
    let open = refused(&faces[1..]);
    assert!(matches!(open, MeshError::Open { .. }), "{open}");
    let mut turned = faces.clone();
    turned[4].swap(0, 1);
    let error = refused(&turned);
    assert!(matches!(error, MeshError::Orientation { .. }), "{error}");
    let mut doubled = faces.clone();
    doubled.push(faces[0]);
    assert!(matches!(
        refused(&doubled),
        MeshError::Branching { count: 3, .. }
    ));
    let inside_out: Vec<_> = faces.iter().map(|&[a, b, c]| [a, c, b]).collect();
    assert!(matches!(refused(&inside_out), MeshError::InsideOut { .. }));
}

#[test]
fn files_that_hold_no_mesh_are_refused() {
    let missing = Mesh::load("fixtures/meshes/no-such.obj".as_ref()).unwrap_err();
    assert!(missing.to_string().contains("no-such.obj"), "{missing}");
    let read = |text: &str| Mesh::from_obj(text.as_bytes()).unwrap_err();
    assert!(matches!(
        read("v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
        MeshError::Empty
    ));
    assert!(matches!(read("v 0 0 0\nf 1 2 3\n"), MeshError::Format(_)));
    assert!(matches!(
        read("v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        MeshError::Format(_)
    ));
    assert!(matches!(read("\u{0}\u{1}garbage\n"), MeshError::Format(_)));
}

#[test]
fn objects_of_a_file_that_share_vertices_are_one_surface() {
    let text = meshes::obj("two objects", &cuboid(DVec3::ZERO, DVec3::ONE));
    let half = text.match_indices("f ").nth(6).unwrap().0;
    let split = format!("{}o other\n{}", &text[..half], &text[half..]);
    assert!(ClosedMesh::new(Mesh::from_obj(split.as_bytes()).unwrap()).is_ok());
}

/// The fixtures are what the formulas make; `VOLREF_WRITE_MESHES=1` writes them.
#[test]
fn the_fixtures_are_what_their_formulas_make() {
    let files = [
        (
            "knot.obj",
            meshes::obj(
                "A trefoil knot, closed; made by tests/meshes",
                &knot(160, 16),
            ),
        ),
        (
            "gem.obj",
            meshes::obj(
                "A cut stone, closed; made by tests/meshes",
                &meshes::gem(12),
            ),
        ),
        (
            "ball.obj",
            meshes::obj(
                "A sphere of 1280 triangles, closed; made by tests/meshes",
                &icosphere(3),
            ),
        ),
    ];
    for (name, text) in files {
        let path = std::path::Path::new("fixtures/meshes").join(name);
        if std::env::var_os("VOLREF_WRITE_MESHES").is_some() {
            std::fs::write(&path, &text).unwrap();
        }
        assert_eq!(std::fs::read_to_string(&path).unwrap(), text, "{name}");
        assert!(text.len() < 300_000);
        let solid = ClosedMesh::new(Mesh::load(&path).unwrap()).unwrap();
        assert!(solid.bounds().reach() < 1.5);
    }
}
