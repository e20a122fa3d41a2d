//! Grids of one to nine nodes along each axis, of any spacing: values, walks and integrals.

use super::exact::grids::{integral, integral_error};
use super::exact::{U, apart};
use super::{config, direction, dyadic, octaves, offset, scale, vector};
use glam::DVec3;
use proptest::prelude::*;
use std::sync::Arc;
use volref::geometry::{Aabb, Ray, Span};
use volref::optics::optical_depth;
use volref::volume::{
    Centring, DensityField, Grid, GridDensity, Interpolation, Lattice, Visit, Walk,
};

fn centring() -> impl Strategy<Value = Centring> {
    prop_oneof![Just(Centring::Nodes), Just(Centring::Cells)]
}

fn interpolation() -> impl Strategy<Value = Interpolation> {
    prop_oneof![Just(Interpolation::Nearest), Just(Interpolation::Trilinear)]
}

fn nodes() -> impl Strategy<Value = [usize; 3]> {
    prop::array::uniform3(1..=9_usize)
}

/// A field on a lattice, with nothing, little and spikes at the nodes.
fn field(lattice: impl Strategy<Value = Lattice>) -> impl Strategy<Value = GridDensity> {
    let value = prop_oneof![1 => Just(0.0_f32), 4 => 0.0..1.0_f32, 1 => 0.0..1e6_f32];
    let value = value.boxed();
    (lattice, centring(), interpolation()).prop_flat_map(move |(lattice, centring, between)| {
        let lattice = lattice.with_centring(centring).unwrap();
        prop::collection::vec(value.clone(), lattice.node_count()).prop_map(move |values| {
            GridDensity::new(Arc::new(Grid::new(lattice, values).unwrap()), between)
        })
    })
}

fn any_field() -> impl Strategy<Value = GridDensity> {
    field(
        (nodes(), vector(octaves(-7.0, 4.0)), vector(-10.0..10.0))
            .prop_map(|(nodes, spacing, first)| Lattice::new(nodes, spacing, first).unwrap()),
    )
}

/// Coordinates along one axis in shares of the box, and whether to take the next node instead.
type GridPoint = [(f64, bool); 3];

fn places(shares: std::ops::Range<f64>) -> impl Strategy<Value = GridPoint> {
    prop::array::uniform3((shares, any::<bool>()))
}

fn point(density: &GridDensity, place: GridPoint) -> DVec3 {
    let (lattice, bounds) = (density.grid().lattice(), density.bounds());
    let at = |axis: usize| {
        let (share, snapped) = place[axis];
        let coordinate = bounds.min[axis] + share * bounds.size()[axis];
        let (first, spacing) = (lattice.first()[axis], lattice.spacing()[axis]);
        // Onto a node, or halfway to the next.
        let halves = ((coordinate - first) / spacing * 2.0).round();
        if snapped {
            first + 0.5 * halves * spacing
        } else {
            coordinate
        }
    };
    DVec3::new(at(0), at(1), at(2))
}

/// A ray through a field, from outside or inside, often along axes and in planes of nodes.
#[derive(Clone, Debug)]
struct GridCase {
    density: GridDensity,
    ray: Ray,
    span: Span,
}

fn through(density: GridDensity, ray: Ray) -> Option<GridCase> {
    let span = density.bounds().span(&ray)?;
    (span.length() > 0.0).then_some(GridCase { density, ray, span })
}

fn case() -> impl Strategy<Value = GridCase> {
    rays_through(any_field(), |point| point)
}

/// A field and a ray between two points about it, which `snap` puts in their places.
fn rays_through(
    fields: impl Strategy<Value = GridDensity>,
    snap: fn(DVec3) -> DVec3,
) -> impl Strategy<Value = GridCase> {
    let parallel = prop::array::uniform3(prop::bool::weighted(0.25));
    (fields, places(-1.0..2.0), places(0.0..1.0), parallel).prop_filter_map(
        "a ray through the grid",
        move |(density, mut from, to, parallel)| {
            for axis in (0..3).filter(|&axis| parallel[axis]) {
                from[axis] = to[axis];
            }
            let (origin, target) = (snap(point(&density, from)), snap(point(&density, to)));
            through(density, Ray::new(origin, target - origin)?)
        },
    )
}

/// The same where the ray and the first node have coordinates that are multiples of 1/256.
fn dyadic_case() -> impl Strategy<Value = GridCase> {
    let lattice = (nodes(), vector(octaves(-4.0, 2.0)), vector(dyadic()))
        .prop_map(|(nodes, spacing, first)| Lattice::new(nodes, spacing, first).unwrap());
    rays_through(field(lattice), |point| (point * 256.0).round() / 256.0)
}

impl GridCase {
    fn integral(&self) -> f64 {
        self.integral_over(self.span)
    }

    fn integral_over(&self, span: Span) -> f64 {
        self.density.integral(&self.ray, span, &mut 0)
    }

    /// The bound on its rounding.
    fn error(&self) -> f64 {
        self.error_over(self.span)
    }

    fn error_over(&self, span: Span) -> f64 {
        integral_error(&self.density, self.ray.origin, *self.ray.direction, span)
    }

    /// The same values on another lattice, along a stretch of another ray.
    fn elsewhere(&self, spacing: DVec3, first: DVec3, ray: Ray, span: Span) -> GridCase {
        let old = self.density.grid();
        let lattice = Lattice::new(old.lattice().nodes(), spacing, first).unwrap();
        let lattice = lattice.with_centring(old.lattice().centring()).unwrap();
        let grid = Arc::new(Grid::new(lattice, old.values().to_vec()).unwrap());
        let density = GridDensity::new(grid, self.density.interpolation());
        GridCase { density, ray, span }
    }
}

/// A division of space into cells, and a ray through it: along axes, diagonals and anyhow, from
/// outside and inside, in and between its planes.
fn division() -> impl Strategy<Value = ([usize; 3], Ray, Span)> {
    let diagonal = vector(prop_oneof![Just(-1.0), Just(0.0), Just(1.0)]);
    let towards = prop_oneof![diagonal, direction(), vector(-1.0..1.0)];
    let back = prop_oneof![
        Just(0.0),
        (0..40_i32).prop_map(|n| f64::from(n) / 2.0),
        0.0..20.0
    ];
    (nodes(), places(0.0..1.0), towards, back).prop_filter_map(
        "a ray through the cells",
        |(cells, place, towards, back)| {
            let far = DVec3::from_array(cells.map(|count| count as f64));
            let target = DVec3::from_array([0, 1, 2].map(|axis| {
                let (share, snapped) = place[axis];
                let coordinate = share * far[axis];
                if snapped {
                    coordinate.floor()
                } else {
                    coordinate
                }
            }));
            let ray = Ray::new(target - back * towards, towards)?;
            let span = Aabb::new(DVec3::ZERO, far).unwrap().span(&ray)?;
            (span.length() > 0.0).then_some((cells, ray, span))
        },
    )
}

proptest! {
    #![proptest_config(config())]

    /// No piece of the ray is lost, none walked twice, and there are few.
    #[test]
    fn g12_pieces_follow_each_other_through_the_span(case in case()) {
        let GridCase { density, ray, span } = case;
        let [nx, ny, nz] = density.grid().lattice().nodes();
        let (mut at, mut count) = (span.near, 0);
        for piece in density.smooth_segments(&ray, span) {
            prop_assert_eq!(piece.near, at);
            prop_assert!(piece.length() > 0.0);
            (at, count) = (piece.far, count + 1);
        }
        prop_assert_eq!(at, span.far);
        prop_assert!(count <= nx + ny + nz + 1, "{count}");
    }

    /// Cells follow each other without a gap, each a neighbour of the one before or, where planes are
    /// crossed within a rounding of each other, of its neighbour; the middle of each visit is in its
    /// cell. A zero has no sign.
    #[test]
    fn g1_g12_visits_are_where_they_say((cells, ray, span) in division()) {
        let walk = |direction| Walk::new(cells, ray.origin, direction, span).collect::<Vec<_>>();
        let visits = walk(*ray.direction);
        let zeros_of = |zero| ray.direction.map(|x| if x == 0.0 { zero } else { x });
        prop_assert_eq!(&walk(zeros_of(0.0)), &visits);
        prop_assert_eq!(&walk(zeros_of(-0.0)), &visits);
        prop_assert!(visits.len() <= cells[0] + cells[1] + cells[2] - 2);
        prop_assert_eq!(visits.first().map(|visit| visit.span.near), Some(span.near));
        prop_assert_eq!(visits.last().map(|visit| visit.span.far), Some(span.far));
        for pair in visits.windows(2) {
            prop_assert_eq!(pair[0].span.far, pair[1].span.near);
            let apart = (0..3).map(|axis| pair[0].cell[axis].abs_diff(pair[1].cell[axis]));
            prop_assert!((1..=3).contains(&apart.sum::<usize>()));
        }
        for Visit { cell, span: Span { near, far } } in visits {
            prop_assert!(near < far);
            let middle = ray.at(0.5 * (near + far));
            for axis in 0..3 {
                // The ends of the visit are crossings, a difference and a quotient, so 2 of the
                // distance along the axis; their mean 1 more. The place takes a product and a sum.
                let along = (ray.direction[axis] * far).abs();
                let slack = U * (4.0 * along + 2.0 * middle[axis].abs());
                let low = cell[axis] as f64;
                prop_assert!(low - slack <= middle[axis] && middle[axis] <= low + 1.0 + slack);
            }
        }
    }

    /// One interpolation passes its nodes by two roundings of their difference at most: the
    /// difference itself, and, since rounding is monotone, that of the sum no farther. Three in a
    /// row, each over an interval wider by so much: 7. Below 0, not at all: the product is never
    /// larger than what it is taken from.
    #[test]
    fn d4_values_lie_between_those_of_the_nodes(
        density in any_field(), place in places(-0.5..1.5),
    ) {
        let (least, most) = density.grid().range();
        let found = density.density(point(&density, place));
        let slack = match density.interpolation() {
            Interpolation::Nearest => 0.0,
            Interpolation::Trilinear => 7.0 * U * (most - least),
        };
        prop_assert!(least - slack <= found && found <= most + slack && found >= 0.0, "{found:e}");
    }

    #[test]
    fn d2_d5_integrals_are_those_of_many_digits(case in case()) {
        let GridCase { density, ray, span } = &case;
        let exact = integral(density, ray.origin, *ray.direction, *span);
        let (found, bound) = (case.integral(), case.error());
        prop_assert!(apart(found, &exact) <= bound, "{found:e} {bound:e}");
    }

    /// Each of the three by its own error.
    #[test]
    fn integrals_add_up_where_the_span_is_cut(case in case(), cut in 0.0..1.0_f64) {
        let Span { near, far } = case.span;
        let at = (near + cut * (far - near)).min(far);
        let parts = [Span { near, far: at }, Span { near: at, far }];
        let sum: f64 = parts.iter().map(|&part| case.integral_over(part)).sum();
        let bound: f64 = parts.iter().map(|&part| case.error_over(part)).sum();
        let whole = case.integral();
        // One rounding more for the sum here, and the last of the whole.
        let bound = bound + case.error() + 2.0 * U * whole;
        prop_assert!((sum - whole).abs() <= bound, "{sum:e} {whole:e}");
    }

    /// Every length times `2^k`, every extinction over it: the same optical depth.
    #[test]
    fn g8_another_unit_of_length_moves_no_bit(
        case in case(), factor in scale(), sigma in 0.0..9.0_f64,
    ) {
        let lattice = *case.density.grid().lattice();
        let ray = Ray { origin: case.ray.origin * factor, ..case.ray };
        let span = Span { near: case.span.near * factor, far: case.span.far * factor };
        let other = case.elsewhere(lattice.spacing() * factor, lattice.first() * factor, ray, span);
        prop_assert_eq!(other.density.bounds().span(&ray), Some(span));
        let found = optical_depth(sigma / factor, other.integral());
        prop_assert_eq!(found.to_bits(), optical_depth(sigma, case.integral()).to_bits());
    }

    /// Where the far place can represent the ray and the first node, any spacing is the same there.
    #[test]
    fn g9_far_from_the_origin_no_bit_moves(case in dyadic_case(), offset in offset()) {
        let lattice = *case.density.grid().lattice();
        let there = Ray { origin: case.ray.origin + offset, ..case.ray };
        let far = case.elsewhere(lattice.spacing(), lattice.first() + offset, there, case.span);
        prop_assert_eq!(far.integral().to_bits(), case.integral().to_bits());
    }

}
