//! Laws of shapes, meshes and transforms. Names that begin with `g` are hard cases.

use crate::common;
use crate::common::direction;
use crate::meshes;
use crate::meshes::{closed, cuboid, icosphere, knot};
use glam::DVec3;
use proptest::prelude::*;
use volref::geometry::*;

/// Half a unit in the last place of 1.
const U: f64 = f64::EPSILON / 2.0;

fn config() -> ProptestConfig {
    common::failures_in("fixtures/proptest-regressions/geometry_laws.txt")
}

fn vector(size: f64) -> impl Strategy<Value = DVec3> {
    common::vector(-size..size)
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
    fn normals_stay_normal(map in transform(), a in direction(), b in direction()) {
        let Some(normal) = Direction::of(a.cross(b)) else { return Ok(()) };
        let tangent = map.vector(a);
        let cosine = map.normal(normal).dot(tangent / tangent.length());
        // `normal` itself is off by a few roundings over the sine of the angle between a and b.
        let sine = a.cross(b).length() / (a.length() * b.length());
        prop_assert!(cosine.abs() <= 75.0 * 64.0 * U / sine);
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
            let hit = mesh.crossing(&ray, f64::INFINITY)?;
            Some((hit.t, face, hit.uv))
        });
        let nearest = hits.reduce(|a, b| if b.0 < a.0 { b } else { a });
        let found = whole
            .crossing(&ray, f64::INFINITY)
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
