//! Spheres: rays from anywhere, through the middle, grazing, leaving.

use super::exact::shapes::chord;
use super::exact::{U, apart, big, rounded};
use super::{config, direction, dyadic, octaves, offset, scale, scaled, scales_exactly, vector};
use glam::DVec3;
use proptest::prelude::*;
use volref::geometry::{Direction, Ray, Solid, Span, Sphere};

fn span(sphere: &Sphere, ray: &Ray) -> Option<Span> {
    sphere.spans(ray).first().copied()
}

fn any_sphere() -> impl Strategy<Value = Sphere> {
    let centre = prop_oneof![vector(-4.0..4.0), vector(dyadic()), Just(DVec3::ZERO)];
    (centre, octaves(-20.0, 4.0)).prop_map(|(centre, radius)| Sphere::new(centre, radius).unwrap())
}

/// Where a ray starts and ends, from the centre, in radii: inside, on the sphere, near by, far.
fn away() -> impl Strategy<Value = DVec3> {
    let to_surface = |v: DVec3| v.normalize_or(DVec3::X);
    prop_oneof![
        3 => vector(-1.0..1.0),
        2 => direction().prop_map(to_surface),
        1 => (0..3_usize).prop_map(|axis| DVec3::AXES[axis]),
        2 => vector(-3.0..3.0),
        2 => (direction(), octaves(0.0, 30.0)).prop_map(move |(v, far)| to_surface(v) * far),
        1 => Just(DVec3::ZERO),
    ]
}

/// Past the sphere along an axis, at a radius from the centre and a few last places beside.
fn grazing(sphere: &Sphere, (axis, places, back): (usize, i32, f64)) -> Ray {
    let beside = sphere.radius() * (1.0 + f64::from(places) * 2.0 * U);
    let foot = sphere.centre() + DVec3::AXES[(axis + 1) % 3] * beside;
    Ray {
        origin: foot - DVec3::AXES[axis] * (back * sphere.radius()),
        direction: Direction::unit(DVec3::AXES[axis]),
    }
}

fn case() -> impl Strategy<Value = (Sphere, Ray)> {
    #[derive(Clone, Debug)]
    enum Aim {
        At(DVec3),
        Along(DVec3),
        Grazing((usize, i32, f64)),
    }
    let aim = prop_oneof![
        4 => away().prop_map(Aim::At),
        2 => direction().prop_map(Aim::Along),
        1 => (0..3_usize, -4..=4_i32, -2.0..4.0_f64).prop_map(Aim::Grazing),
    ];
    (any_sphere(), away(), aim).prop_filter_map("a direction", |(sphere, from, aim)| {
        let origin = sphere.centre() + from * sphere.radius();
        let ray = match aim {
            Aim::At(to) => Ray::new(origin, sphere.centre() + to * sphere.radius() - origin)?,
            Aim::Along(direction) => Ray::new(origin, direction)?,
            Aim::Grazing(how) => grazing(&sphere, how),
        };
        Some((sphere, ray))
    })
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn g10_spans_are_one_stretch_of_the_ray((sphere, ray) in case()) {
        prop_assert!(sphere.spans(&ray).len() <= 1);
        if let Some(Span { near, far }) = span(&sphere, &ray) {
            prop_assert!(0.0 <= near && near <= far && far.is_finite());
        }
    }

    /// Hits and misses are right but where the line passes the outline closer than its distance
    /// from the centre is known, 17u of the distance of the centre; both ends are, by the bound of
    /// [`chord`], but where that exceeds a quarter of half the chord.
    #[test]
    fn g10_spans_are_those_of_many_digits((sphere, ray) in case()) {
        let found = span(&sphere, &ray);
        let doubt = 17.0 * U * (1.0 + 1e-12) * (sphere.centre() - ray.origin).length();
        let of_radius = |radius| {
            let sphere = Sphere::new(sphere.centre(), radius).ok()?;
            chord(&sphere, &ray)
        };
        if of_radius(sphere.radius() + doubt).is_none() {
            prop_assert_eq!(found, None);
        }
        let Some(exact) = chord(&sphere, &ray) else { return Ok(()) };
        if exact.error > exact.half / 4.0 {
            return Ok(());
        }
        match found {
            Some(span) => {
                prop_assert!(apart(span.near, &exact.near.max(big(0.0))) <= exact.error);
                prop_assert!(apart(span.far, &exact.far) <= exact.error);
            }
            None => {
                let certain = of_radius(sphere.radius() - doubt).is_some();
                prop_assert!(!certain || rounded(&exact.far) <= exact.error);
            }
        }
    }

    /// Only exponents change.
    #[test]
    fn g8_another_unit_of_length_moves_no_bit((sphere, ray) in case(), factor in scale()) {
        prop_assume!([sphere.centre(), ray.origin, *ray.direction].into_iter().all(scales_exactly));
        let other = Sphere::new(sphere.centre() * factor, sphere.radius() * factor).unwrap();
        let found = span(&other, &Ray { origin: ray.origin * factor, ..ray });
        prop_assert_eq!(found, scaled(span(&sphere, &ray), factor));
    }

    #[test]
    fn g9_far_from_the_origin_no_bit_moves(
        centre in vector(dyadic()), radius in 2..1024_i32, origin in vector(dyadic()),
        direction in direction(), offset in offset(),
    ) {
        // Beyond 2^-44 of the distance, where spheres are too small for their place.
        let radius = f64::from(radius) / 16.0;
        let ray = Ray::new(origin, direction).unwrap();
        let sphere = Sphere::new(centre, radius).unwrap();
        let far = Sphere::new(centre + offset, radius).unwrap();
        let there = Ray { origin: origin + offset, ..ray };
        prop_assert_eq!(span(&far, &there), span(&sphere, &ray));
    }

    /// Squares do not see a sign, and rounding is the same for either.
    #[test]
    fn mirror_images_have_the_same_bits(
        (sphere, ray) in case(), signs in prop::array::uniform3(any::<bool>()),
    ) {
        let sign = DVec3::from_array(signs.map(|turned| if turned { -1.0 } else { 1.0 }));
        let mirrored = Sphere::new(sphere.centre() * sign, sphere.radius()).unwrap();
        let image = Ray {
            origin: ray.origin * sign,
            direction: Direction::unit(*ray.direction * sign),
        };
        prop_assert_eq!(span(&mirrored, &image), span(&sphere, &ray));
    }
}
