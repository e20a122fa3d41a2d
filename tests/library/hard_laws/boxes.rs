//! Boxes: rays from anywhere, in and along faces, through edges and corners.

use super::exact::shapes::{FACE, line_in_box};
use super::exact::{apart, big, rounded};
use super::{
    config, direction, dyadic, octaves, offset, permuted, scale, scaled, scales_exactly, vector,
};
use glam::DVec3;
use proptest::prelude::*;
use volref::geometry::{Aabb, Direction, Ray, Span};

fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -4.0..4.0_f64,
        2 => dyadic(),
        1 => Just(0.0),
        1 => (octaves(-60.0, 20.0), any::<bool>())
            .prop_map(|(size, negative)| if negative { -size } else { size }),
    ]
}

/// Edges of every length, none included.
fn edge() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => 0.0..4.0_f64,
        2 => dyadic().prop_map(f64::abs),
        1 => Just(0.0),
        1 => octaves(-60.0, 10.0),
    ]
}

fn any_box() -> impl Strategy<Value = Aabb> {
    (vector(coordinate()), vector(edge()))
        .prop_map(|(min, edges)| Aabb::new(min, min + edges).unwrap())
}

/// A coordinate beside, on and in a box: from a kind of place and a share.
fn place(shape: &Aabb, axis: usize, (kind, share): (u8, f64)) -> f64 {
    let (min, max) = (shape.min[axis], shape.max[axis]);
    match kind {
        0 | 1 => (min + share * (max - min)).min(max),
        2 => min,
        3 => max,
        4 => min - 8.0 * share,
        5 => max + 8.0 * share,
        6 => min.next_down(),
        7 => max.next_down(),
        8 => min.next_up(),
        _ => max.next_up(),
    }
}

fn places() -> impl Strategy<Value = [(u8, f64); 3]> {
    prop::array::uniform3((0..10_u8, 0.0..1.0_f64))
}

/// A box, and a ray from somewhere about it to somewhere about it, or in any direction.
fn case() -> impl Strategy<Value = (Aabb, Ray)> {
    let towards = prop_oneof![
        places().prop_map(Ok),
        direction().prop_map(Err::<[(u8, f64); 3], DVec3>),
    ];
    (any_box(), places(), towards).prop_filter_map("a direction", |(shape, from, towards)| {
        let point = |places: [(u8, f64); 3]| {
            DVec3::from_array([0, 1, 2].map(|axis| place(&shape, axis, places[axis])))
        };
        let origin = point(from);
        let direction = match towards {
            Ok(to) => point(to) - origin,
            Err(direction) => direction,
        };
        Some((shape, Ray::new(origin, direction)?))
    })
}

/// Whether the ray runs in a face.
fn in_a_face(shape: &Aabb, ray: &Ray) -> bool {
    (0..3).any(|axis| {
        let origin = ray.origin[axis];
        ray.direction[axis] == 0.0 && (origin == shape.min[axis] || origin == shape.max[axis])
    })
}

/// `v` with all its zeros of one sign.
fn with_zeros(v: DVec3, zero: f64) -> DVec3 {
    v.map(|component| if component == 0.0 { zero } else { component })
}

fn bits(span: Option<Span>) -> Option<[u64; 2]> {
    span.map(|span| [span.near, span.far].map(f64::to_bits))
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn g3_g4_spans_are_stretches_of_the_ray((shape, ray) in case()) {
        if let Some(Span { near, far }) = shape.span(&ray) {
            prop_assert!(0.0 <= near && near <= far && far.is_finite());
        }
    }

    /// Zeros of the ray change no bit; those of the box no number.
    #[test]
    fn g1_g2_the_sign_of_a_zero_changes_nothing((shape, ray) in case()) {
        let shape_with = |zero| Aabb {
            min: with_zeros(shape.min, zero),
            max: with_zeros(shape.max, zero),
        };
        let ray_with = |in_origin, in_direction| Ray {
            origin: with_zeros(ray.origin, in_origin),
            direction: Direction::unit(with_zeros(*ray.direction, in_direction)),
        };
        let expected = shape_with(0.0).span(&ray_with(0.0, 0.0));
        for (in_origin, in_direction) in [(0.0, -0.0), (-0.0, 0.0), (-0.0, -0.0)] {
            let ray = ray_with(in_origin, in_direction);
            prop_assert_eq!(bits(shape_with(0.0).span(&ray)), bits(expected));
            prop_assert_eq!(shape_with(-0.0).span(&ray), expected);
        }
    }

    /// A difference and a quotient: relative to each end. Only where the exact stretch is shorter
    /// than both errors, one way or the other, may it be missed or found by mistake. Which side of
    /// the origin a face is on, and which of a slab a parallel ray, is never mistaken.
    #[test]
    fn g1_to_g4_spans_are_those_of_many_digits((shape, ray) in case()) {
        let found = shape.span(&ray);
        let Some([near, far]) = line_in_box(&shape, &ray) else {
            prop_assert_eq!(found, None);
            return Ok(());
        };
        let size = rounded(&near).abs() + rounded(&far).abs();
        let excess = rounded(&(&far - &near));
        match found {
            Some(span) => {
                // What is below the normal numbers is off by one more of the smallest.
                let bound = |exact: &_| FACE * rounded(exact).abs() + f64::from_bits(1);
                let near = near.max(big(0.0));
                prop_assert!(apart(span.near, &near) <= bound(&near));
                prop_assert!(apart(span.far, &far) <= bound(&far));
                prop_assert!(excess >= -FACE * size);
            }
            None => prop_assert!(far < big(0.0) || excess <= FACE * size),
        }
    }

    /// Two boxes that touch share the bits of where the ray goes over, and a ray along their
    /// common face belongs to one of them.
    #[test]
    fn g2_g6_touching_boxes_divide_the_ray(
        (shape, ray) in case(), axis in 0..3_usize, at in (0..4_u8, 0.0..1.0_f64), at_ray: bool,
    ) {
        let (min, max) = (shape.min[axis], shape.max[axis]);
        // Where the ray runs along an axis, this puts it in the common face.
        let at = if at_ray { ray.origin[axis] } else { place(&shape, axis, at) };
        let at = at.clamp(min, max);
        let (mut left, mut right) = (shape, shape);
        (left.max[axis], right.min[axis]) = (at, at);
        let whole = shape.span(&ray);
        match (left.span(&ray), right.span(&ray)) {
            (Some(left), Some(right)) => {
                let along = ray.direction[axis];
                prop_assert!(along != 0.0);
                let (first, second) = if along > 0.0 { (left, right) } else { (right, left) };
                prop_assert_eq!(first.far, second.near);
                prop_assert_eq!(Some(Span { near: first.near, far: second.far }), whole);
            }
            (part, None) | (None, part) => prop_assert_eq!(part, whole),
        }
    }

    /// Only exponents change.
    #[test]
    fn g8_another_unit_of_length_moves_no_bit((shape, ray) in case(), factor in scale()) {
        prop_assume!([shape.min, shape.max, ray.origin].into_iter().all(scales_exactly));
        let other = Aabb { min: shape.min * factor, max: shape.max * factor };
        let found = other.span(&Ray { origin: ray.origin * factor, ..ray });
        prop_assert_eq!(bits(found), bits(scaled(shape.span(&ray), factor)));
    }

    #[test]
    fn g9_far_from_the_origin_no_bit_moves(
        min in vector(dyadic()), edges in vector(dyadic()), origin in vector(dyadic()),
        direction in direction(), offset in offset(),
    ) {
        let shape = Aabb::new(min, min + edges.abs()).unwrap();
        let ray = Ray::new(origin, direction).unwrap();
        let far = Aabb { min: shape.min + offset, max: shape.max + offset };
        let there = Ray { origin: origin + offset, ..ray };
        prop_assert_eq!(bits(far.span(&there)), bits(shape.span(&ray)));
    }

    #[test]
    fn no_axis_is_special((shape, ray) in case(), order in Just([0, 1, 2]).prop_shuffle()) {
        let turned = Aabb { min: permuted(shape.min, order), max: permuted(shape.max, order) };
        let along = Ray {
            origin: permuted(ray.origin, order),
            direction: Direction::unit(permuted(*ray.direction, order)),
        };
        // As numbers: which of two zeros is first depends on the order.
        prop_assert_eq!(turned.span(&along), shape.span(&ray));
    }

    /// In a face the half-open box and its mirror image part ways, and only there.
    #[test]
    fn g2_mirrored_boxes_differ_in_their_faces_only(
        (shape, ray) in case(), signs in prop::array::uniform3(any::<bool>()),
    ) {
        let sign = DVec3::from_array(signs.map(|turned| if turned { -1.0 } else { 1.0 }));
        let (a, b) = (shape.min * sign, shape.max * sign);
        let mirrored = Aabb { min: a.min(b), max: a.max(b) };
        let image = Ray {
            origin: ray.origin * sign,
            direction: Direction::unit(*ray.direction * sign),
        };
        let (found, expected) = (mirrored.span(&image), shape.span(&ray));
        prop_assert!(found == expected || in_a_face(&shape, &ray), "{found:?} {expected:?}");
    }
}
