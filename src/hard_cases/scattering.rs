//! S: scattering and sampling.

use super::Row;
use super::margin::{Margin, STANDARD_ERRORS, U};
use super::scenes::*;
use crate::geometry::{Direction, Ray, Rectangle, Shape};
use crate::math::quadrature::integrate;
use crate::math::rng::{Purpose, Stream};
use crate::math::sampling::{
    Cone, Equiangular, LightOnRay, cosine_hemisphere, cosine_hemisphere_pdf, sphere,
    truncated_free_flight_pdf, truncated_optical_distance,
};
use crate::math::{Frame, Moments, Sum, atan2, cos, pow, sin};
use crate::media::{Asymmetry, Deflection, Field, HenyeyGreenstein, opacity};
use crate::optics::{Directional, Light, Material, Point, Spot};
use crate::render::RenderError;
use crate::render::radiative::line_of_sight::TOLERANCE;
use crate::scene::{Body, Model, Object, Radiative, Scattering};
use crate::volume::{GridDensity, Interpolation};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

pub const ROWS: &[Row] = &[
    Row {
        id: "S1",
        what: "Henyey-Greenstein sampling for every g, at both ends of u",
        tolerance: "8 u in 1 - cos and in 1 + cos",
        remedy: "two forms without cancellation; g below 0 is the mirror of g above",
        file: "src/media/henyey_greenstein.rs",
        check: s1_henyey_greenstein_sampling,
    },
    Row {
        id: "S2",
        what: "the Henyey-Greenstein value: integral, mean cosine, histogram",
        tolerance: "1e-12; chi-squared at 1e-3",
        remedy: "(1 - g)^2 + 2 g (1 - cos), from the end at which the peak is",
        file: "src/media/henyey_greenstein.rs",
        check: s2_henyey_greenstein_value,
    },
    Row {
        id: "S3",
        what: "orthonormal frames at and near the poles",
        tolerance: "8 u",
        remedy: "the sign keeps the denominator at least 1 on both hemispheres",
        file: "src/math/frame.rs",
        check: s3_orthonormal_frame,
    },
    Row {
        id: "S4",
        what: "the white furnace: nothing is seen in light from everywhere",
        tolerance: "exact, path by path; 1e-12 where media overlap whose density varies",
        remedy: "a path that nothing takes from is never cut, and its weights are ratios of equal numbers",
        file: "src/render/radiative/path_tracer.rs",
        check: s4_white_furnace,
    },
    Row {
        id: "S5",
        what: "plane albedo of a half-space",
        tolerance: "4 standard errors",
        remedy: "paths are cut with the probability that their weight is raised by",
        file: "src/render/radiative/path_tracer.rs",
        check: s5_half_space,
    },
    Row {
        id: "S6",
        what: "a thick slab that absorbs nothing",
        tolerance: "exact sum, path by path; no path cut; 4 standard errors",
        remedy: "no limit of bounces but the one the scene asks for; a path without an end is an error",
        file: "src/render/radiative/path_tracer.rs",
        check: s6_conservative_thick_slab,
    },
    Row {
        id: "S7",
        what: "a limit of one bounce: crossing a boundary is none",
        tolerance: "1e-10 by integrals, 4 standard errors by paths",
        remedy: "boundaries of media are places where a straight path is cut, not vertices",
        file: "src/render/radiative/segments.rs",
        check: s7_depth_limit,
    },
    Row {
        id: "S8",
        what: "a light on the viewing ray, and next to it",
        tolerance: "1e-12, by the integrals of images 6e-10; no variance",
        remedy: "equiangular sampling by a turn of the near end; on the light itself infinity",
        file: "src/math/sampling/equiangular.rs",
        check: s8_light_near_the_ray,
    },
    Row {
        id: "S9",
        what: "the edge of a spotlight, and every warp at its ends",
        tolerance: "exact; 8 u; 4e-11 and the rounding of places across the cone",
        remedy: "the edge itself is dark, by a strict comparison before any quotient",
        file: "src/optics/light.rs",
        check: s9_spotlight_edge_and_warps,
    },
    Row {
        id: "S10",
        what: "a strongly coloured medium",
        tolerance: "4 standard errors a channel, 8 u in closed form; weights at most 3",
        remedy: "one channel chooses the distance, and the weight is by the mixture of all three",
        file: "src/media/coefficients.rs",
        check: s10_strongly_coloured_medium,
    },
];

/// The least random number above 0.
const FIRST: f64 = U;

fn henyey_greenstein(g: f64) -> HenyeyGreenstein {
    HenyeyGreenstein(Asymmetry::new(g).expect("within ±1"))
}

/// g, u, and 1 − cos θ = 2(1−g)²(1−u)(1+gu)/D², 1 + cos θ = 2(1+g)²u(1−g+gu)/D², D = 1−g+2gu: by
/// rational arithmetic from the binary values of g and u, rounded once.
#[rustfmt::skip]
const DEFLECTIONS: &[(f64, f64, f64, f64)] = &[
    (0.0, 0.25, 1.5, 0.5),
    (0.0, 0.75, 0.5, 1.5),
    (0.0, LAST, 2.220446049250313e-16, 1.9999999999999998),
    (0.0, FIRST, 1.9999999999999998, 2.220446049250313e-16),
    (1e-17, 0.25, 1.5, 0.5),
    (1e-17, 0.75, 0.5, 1.5),
    (1e-17, LAST, 2.220446049250313e-16, 1.9999999999999998),
    (1e-17, FIRST, 1.9999999999999998, 2.220446049250313e-16),
    (-1e-17, 0.25, 1.5, 0.5),
    (-1e-17, 0.75, 0.5, 1.5),
    (-1e-17, LAST, 2.220446049250313e-16, 1.9999999999999998),
    (-1e-17, FIRST, 1.9999999999999998, 2.220446049250313e-16),
    (1e-12, 0.25, 1.499999999998875, 0.500000000001125),
    (1e-12, 0.75, 0.499999999998875, 1.500000000001125),
    (1e-12, LAST, 2.2204460492436516e-16, 1.9999999999999998),
    (1e-12, FIRST, 1.9999999999999998, 2.2204460492569745e-16),
    (-1e-12, 0.25, 1.500000000001125, 0.499999999998875),
    (-1e-12, 0.75, 0.500000000001125, 1.499999999998875),
    (-1e-12, LAST, 2.2204460492569745e-16, 1.9999999999999998),
    (-1e-12, FIRST, 1.9999999999999998, 2.2204460492436516e-16),
    (1e-8, 0.25, 1.49999998875, 0.50000001125),
    (1e-8, 0.75, 0.49999998875000007, 1.5000000112499998),
    (1e-8, LAST, 2.2204459826369325e-16, 1.9999999999999998),
    (1e-8, FIRST, 1.9999999999999998, 2.2204461158636956e-16),
    (-1e-8, 0.25, 1.5000000112499998, 0.49999998875000007),
    (-1e-8, 0.75, 0.50000001125, 1.49999998875),
    (-1e-8, LAST, 2.2204461158636956e-16, 1.9999999999999998),
    (-1e-8, FIRST, 1.9999999999999998, 2.2204459826369325e-16),
    (1e-3, 0.25, 1.4988742499063439, 0.5011257500936561),
    (1e-3, 0.75, 0.49887574990615635, 1.5011242500938435),
    (1e-3, LAST, 2.213793584013848e-16, 1.9999999999999998),
    (1e-3, FIRST, 1.9999999999999998, 2.227116278072936e-16),
    (-1e-3, 0.25, 1.5011242500938435, 0.49887574990615635),
    (-1e-3, 0.75, 0.5011257500936561, 1.4988742499063439),
    (-1e-3, LAST, 2.227116278072936e-16, 1.9999999999999998),
    (-1e-3, FIRST, 1.9999999999999998, 2.213793584013848e-16),
    (0.5, 0.25, 0.75, 1.25),
    (0.5, 0.75, 0.11, 1.89),
    (0.5, LAST, 3.700743415417189e-17, 2.0),
    (0.5, FIRST, 1.9999999999999991, 9.992007221626405e-16),
    (-0.5, 0.25, 1.89, 0.11),
    (-0.5, 0.75, 1.25, 0.75),
    (-0.5, LAST, 9.992007221626405e-16, 1.9999999999999991),
    (-0.5, FIRST, 2.0, 3.700743415417189e-17),
    (0.9, 0.25, 0.06074380165289254, 1.9392561983471075),
    (0.9, 0.75, 0.0039833531510107, 1.9960166468489893),
    (0.9, LAST, 1.1686558153949012e-18, 2.0),
    (0.9, FIRST, 1.999999999999992, 8.015810237793608e-15),
    (-0.9, 0.25, 1.9960166468489893, 0.0039833531510107),
    (-0.9, 0.75, 1.9392561983471075, 0.06074380165289254),
    (-0.9, LAST, 8.015810237793608e-15, 1.999999999999992),
    (-0.9, FIRST, 2.0, 1.1686558153949012e-18),
    (0.999, 0.25, 7.4835254655434605e-6, 1.9999925164745345),
    (0.999, 0.75, 3.889815000020576e-7, 1.9999996110185),
    (0.999, LAST, 1.1107784138320747e-22, 2.0),
    (0.999, FIRST, 1.9999999999991127, 8.87290463324734e-13),
    (-0.999, 0.25, 1.9999996110185, 3.889815000020576e-7),
    (-0.999, 0.75, 1.9999925164745345, 7.4835254655434605e-6),
    (-0.999, LAST, 8.87290463324734e-13, 1.9999999999991127),
    (-0.999, FIRST, 2.0, 1.1107784138320747e-22),
    (1.0 - 1e-12, 0.25, 7.499668177851957e-24, 2.0),
    (1.0 - 1e-12, 0.75, 3.888716832969755e-25, 2.0),
    (1.0 - 1e-12, LAST, 1.1101739050829758e-40, 2.0),
    (1.0 - 1e-12, FIRST, 1.999112097680197, 0.0008879023198028641),
    (-(1.0 - 1e-12), 0.25, 2.0, 3.888716832969755e-25),
    (-(1.0 - 1e-12), 0.75, 2.0, 7.499668177851957e-24),
    (-(1.0 - 1e-12), LAST, 0.0008879023198028641, 1.999112097680197),
    (-(1.0 - 1e-12), FIRST, 2.0, 1.1101739050829758e-40),
];

fn s1_henyey_greenstein_sampling(margin: &mut Margin) {
    for &(g, u, one_minus_cos, one_plus_cos) in DEFLECTIONS {
        let deflection = henyey_greenstein(g).deflection(u);
        let what = |end: &str| format!("g = {g:e}, u = {u:e}: {end}");
        margin.roundings(
            what("1 - cos"),
            deflection.one_minus_cos,
            one_minus_cos,
            8.0,
        );
        margin.roundings(what("1 + cos"), deflection.one_plus_cos, one_plus_cos, 8.0);
        margin.holds(what("a cosine"), (-1.0..=1.0).contains(&deflection.cos));
        // Both ends, to the bit.
        let [back, ahead] = [0.0, 1.0].map(|u| henyey_greenstein(g).deflection(u));
        margin.exact(
            what("straight back"),
            (back.cos, back.one_plus_cos),
            (-1.0, 0.0),
        );
        margin.exact(
            what("straight on"),
            (ahead.cos, ahead.one_minus_cos),
            (1.0, 0.0),
        );
        // The mirror of g is that of u.
        let mirror = henyey_greenstein(-g).deflection(1.0 - u);
        margin.exact(
            what("mirrored"),
            mirror.one_minus_cos,
            deflection.one_plus_cos,
        );
    }
    for g in [1.0, -1.0, f64::NAN] {
        margin.holds(
            format_args!("g = {g} is refused"),
            Asymmetry::new(g).is_err(),
        );
    }
}

fn s2_henyey_greenstein_value(margin: &mut Margin) {
    for g in [-0.999, -0.9, -0.3, 0.0, 1e-9, 0.5, 0.99, 0.999] {
        let phase = henyey_greenstein(g);
        // By the angle from the peak, in units in which the peak is as wide as the rest.
        let width = (1.0 - f64::abs(g)).max(1e-3);
        let upper = 1.0 / (1.0 + width);
        let over_sphere = |s: f64| {
            let rest = 1.0 - s;
            let from_peak = 2.0 * width * width * s * s / (rest * rest);
            let slope = 4.0 * width * width * s / (rest * rest * rest);
            let (near, far) = (from_peak, 2.0 - from_peak);
            let deflection = if g >= 0.0 {
                Deflection {
                    cos: 1.0 - near,
                    one_minus_cos: near,
                    one_plus_cos: far,
                }
            } else {
                Deflection {
                    cos: near - 1.0,
                    one_minus_cos: far,
                    one_plus_cos: near,
                }
            };
            let density = TAU * phase.per_steradian(&deflection) * slope;
            DVec3::new(density, density * deflection.cos, 0.0)
        };
        let found = integrate(over_sphere, 0.0, upper, 1e-15).value;
        margin.within(format_args!("integral, g = {g}"), found.x, 1.0, 1e-12);
        margin.within(format_args!("mean cosine, g = {g}"), found.y, g, 1e-12);
    }
    // Sampled deflections fill 64 classes of equal probability evenly: one sum in a thousand of 63 degrees
    // of freedom is larger than this.
    let bound = 103.442;
    for (pixel, g) in [
        (0, -0.999),
        (1, -0.5),
        (2, 0.0),
        (3, 1e-9),
        (4, 0.9),
        (5, 0.999),
    ] {
        let phase = henyey_greenstein(g);
        let stream = Stream::new(3, pixel, 0);
        let mut counts = [0_u32; 64];
        for i in 0..1 << 15 {
            let deflection = phase.deflection(stream.uniform(0, Purpose::PhaseDirection, i));
            counts[((phase.cdf(&deflection) * 64.0) as usize).min(63)] += 1;
        }
        let expected = f64::from(1 << 15) / 64.0;
        let squares = counts.map(|count| {
            let excess = f64::from(count) - expected;
            excess * excess / expected
        });
        let what = format_args!("chi-squared of the histogram, g = {g}");
        margin.within(what, Sum::from_iter(squares).value(), 0.0, bound);
    }
}

fn s3_orthonormal_frame(margin: &mut Margin) {
    let mut directions = vec![
        Direction::Z,
        Direction::NEG_Z,
        Direction::X,
        Direction::NEG_Y,
    ];
    directions.push(Direction::unit(DVec3::new(1.0, -0.0, -0.0)));
    directions.push(Direction::unit(DVec3::new(-0.0, 1.0, -0.0)));
    for tenths in -90..=-30 {
        let sine = pow(10.0, f64::from(tenths) / 10.0);
        for (a, b) in [(sine, 0.0), (0.0, -sine), (sine, sine), (-sine, -0.0)] {
            directions.extend(Direction::of(DVec3::new(a, b, -1.0)));
            directions.extend(Direction::of(DVec3::new(a, b, 1.0)));
        }
    }
    directions.extend(numbers(33, 1000).map(|[u, v, _]| sphere([u, v])));
    for around in directions {
        let frame = Frame::around(around);
        let Frame { x, y, z } = frame;
        let lengths = [x, y].map(|axis| axis.length_squared() - 1.0);
        let turned = (x.cross(*y) - *z).length();
        let angles = [x.cosine_to(y), y.cosine_to(z), z.cosine_to(x), turned];
        for error in lengths.into_iter().chain(angles) {
            margin.within(format_args!("around {}", *around), error, 0.0, 8.0 * U);
        }
        // That the z axis goes where it was to go, be its zeros of either sign.
        let up = (*frame.to_world(Direction::Z) - *around).length();
        margin.within(format_args!("up, around {}", *around), up, 0.0, 0.0);
    }
}

/// A set-up of S4.
const OVERLAP: &str = "three that overlap";

fn s4_white_furnace(margin: &mut Margin) {
    let cube = cuboid([-1.0; 3], [1.0; 3]);
    let bumpy = grid([5, 6, 7], [0.5, 0.4, 1.0 / 3.0], |[i, j, k]| {
        ((3 * i + 5 * j + 7 * k) % 4) as f32
    });
    let bumpy = GridDensity::new(bumpy, Interpolation::Trilinear);
    let in_grid = |g| {
        heterogeneous(
            bumpy.bounds(),
            Field::Grid(bumpy.clone()),
            grey(3.0, 1.0, g),
        )
    };
    let media: [(&str, Vec<Body>); 5] = [
        ("thin box", vec![in_box(cube, grey(0.1, 1.0, 0.0))]),
        (
            "dense ball, forward",
            vec![in_ball(ball(DVec3::ZERO, 1.0), grey(20.0, 1.0, 0.9))],
        ),
        ("box, backward", vec![in_box(cube, grey(4.0, 1.0, -0.6))]),
        ("grid", vec![in_grid(0.4)]),
        (
            OVERLAP,
            vec![
                in_box(cube, grey(2.0, 1.0, 0.3)),
                in_ball(ball(DVec3::X, 1.0), grey(2.0, 1.0, -0.5)),
                in_grid(0.0),
            ],
        ),
    ];
    for (name, media) in media {
        let scene = before_sky(media);
        for (sample, [u, v, w]) in (0..400).zip(numbers(34, 400)) {
            // From anywhere, inside and outside, into any direction.
            let origin = sphere([u, v]) * (3.0 * w);
            let seen = paths(&scene, None, ray(origin, *sphere([v, w])))(sample);
            let what = format_args!("{name}, path {sample}");
            // One of several media is chosen in the proportion of their densities there, which
            // takes four roundings; no path is scattered more than a thousand times.
            if name == OVERLAP {
                margin.within(what, (seen - 1.0).abs().max_element(), 0.0, 1e-12)
            } else {
                margin.exact(what, seen, DVec3::ONE)
            }
        }
    }
}

/// Where a slab leaves off, in thicknesses. Light that flies farther than that inside it must be
/// within 1e-6 of horizontal.
const REACH: f64 = 1e6;

/// A slab of thickness 1 between z = 0 and z = 1, below a sky of radiance 1.
fn slab(tau: f64, albedo: f64) -> Radiative {
    let bounds = cuboid([-REACH, -REACH, 0.0], [REACH, REACH, 1.0]);
    before_sky(vec![in_box(bounds, grey(tau, albedo, 0.0))])
}

/// Looks straight down on its upper face.
fn down() -> Ray {
    ray([0.0, 0.0, 1.0], DVec3::NEG_Z)
}

fn s5_half_space(margin: &mut Margin) {
    // By reciprocity the share of a beam that is reflected is the radiance seen along it under a
    // sky of 1. A slab of depth 10^4 lets nothing through: even of albedo 0.999 less than
    // e^(−0.054·10^4).
    for (albedo, right) in [
        (0.5, 0.115_225_878),
        (0.9, 0.414_947_479),
        (0.99, 0.752_720_717),
        (0.999, 0.912_845_335),
    ] {
        let [found, ..] = sampled(&slab(1e4, albedo), None, 8_000, down());
        // The catalogue's nine digits are better than any of these means.
        margin.sampled(format_args!("albedo {albedo}"), &found, right, 0.0);
    }
}

fn s6_conservative_thick_slab(margin: &mut Margin) {
    const PATHS: u32 = 1500;
    let open = slab(50.0, 1.0);
    // A black plane beyond one face hides the sky on that side: what a path brings back under the
    // one sky or the other is what is reflected or let through, of the same path.
    let dark = |height: f64| {
        let reach = 2.0 * REACH;
        let plane = Rectangle::centred(DVec3::Z * height, DVec3::X * reach, DVec3::Y * reach);
        let mut scene = open.clone();
        scene.objects.push(Object {
            shape: Shape::Rectangle(plane.expect("edges")),
            material: Material::Diffuse(DVec3::ZERO),
        });
        scene
    };
    let (above, below) = (dark(-1.0), dark(2.0));
    let (mut reflected, mut transmitted) =
        (paths(&above, None, down()), paths(&below, None, down()));
    let mut share = Moments::default();
    for sample in 0..PATHS {
        let (back, transmitted_share) = (reflected(sample).x, transmitted(sample).x);
        margin.exact(
            format_args!("path {sample}: R + T"),
            back + transmitted_share,
            1.0,
        );
        share.add(transmitted_share);
    }
    // The asymptotic law of a beam that comes in along the normal, exact but for e^(−50):
    // H(1)/√3 over the depth and two extrapolation lengths (van de Hulst 1980, ch. 5).
    let right = 2.907_810_529_078_606 / (3.0_f64.sqrt() * (50.0 + 2.0 * 0.710_446_089_6));
    // Shares are 0 or 1: their spread is known beforehand.
    let variance = right * (1.0 - right) / f64::from(PATHS);
    margin.within("T", share.mean(), right, STANDARD_ERRORS * variance.sqrt());
}

fn s7_depth_limit(margin: &mut Margin) {
    let right = 0.017_201_957_973_755_8;
    let mut scene = slab(1.0, 0.5);
    scene.environment = DVec3::ZERO;
    scene.lights.push(Light::Directional(Directional {
        direction: Direction::NEG_Z,
        irradiance: DVec3::ONE,
    }));
    // The same layer cut into ten has eighteen boundaries more.
    let mut layers = scene.clone();
    layers.media = (0..10)
        .map(|index| {
            let height = |index: i32| f64::from(index) / 10.0;
            let (low, high) = (
                [-REACH, -REACH, height(index)],
                [REACH, REACH, height(index + 1)],
            );
            in_box(cuboid(low, high), grey(1.0, 0.5, 0.0))
        })
        .collect();
    for (name, scene) in [("one slab", &scene), ("ten layers", &layers)] {
        let found = scattered_once(scene, &down()).x;
        margin.within(
            format_args!("{name}, by integrals"),
            found,
            right,
            1e-10 * right,
        );
        let [found, ..] = sampled(scene, Some(1), 40_000, down());
        margin.sampled(format_args!("{name}, by paths"), &found, right, 0.0);
    }
}

fn s8_light_near_the_ray(margin: &mut Margin) {
    // Takes away less than 3e-15 of the light.
    let sigma_s = 1e-15;
    let lamp_at = |distance: f64| {
        let bounds = cuboid([-9.0, -9.0, -1.0], [9.0, 9.0, 2.0]);
        let mut scene = before_sky(vec![in_box(bounds, grey(sigma_s, 1.0, 0.0))]);
        scene.environment = DVec3::ZERO;
        scene.lights.push(Light::Point(Point {
            position: DVec3::X * distance,
            intensity: DVec3::splat(4.0 * PI / sigma_s),
        }));
        scene
    };
    let view = ray(DVec3::NEG_Z, DVec3::Z);
    for (distance, right) in [
        (1.0, 1.892_546_881_191_539),
        (1e-3, 3_140.092_653_964_793),
        (1e-6, 3_141_591.153_589_793),
    ] {
        let angle = atan2(2.0, distance) + atan2(1.0, distance);
        margin.within("what is known", angle / distance, right, 1e-12 * right);
        // To the tolerance of images, and as far as the integrator goes.
        for tolerance in [TOLERANCE, 1e-14] {
            let found = scattered_once_within(tolerance, &lamp_at(distance), &view).x;
            let what = format_args!("by integrals to {tolerance:e}, {distance:e} beside");
            margin.within(what, found, right, tolerance.max(1e-12) * right);
        }
        // One sample is the integral, whichever it is.
        let Ok(light) = Equiangular::new(distance, -1.0, 2.0) else {
            margin.holds("a light beside the ray can be sampled", false);
            continue;
        };
        for u in [0.0, 0.1, 0.5, 0.9, LAST] {
            let t = light.sample(u);
            let estimate = 1.0 / (distance * distance + t * t) / light.pdf(t);
            margin.within(
                format_args!("u = {u}, {distance:e} beside"),
                estimate,
                right,
                1e-12 * right,
            );
        }
    }
    for on in [0.0, -0.0] {
        margin.exact(
            "on the ray",
            Equiangular::new(on, -1.0, 2.0),
            Err(LightOnRay),
        );
        let mut on_the_axis = lamp_at(on);
        on_the_axis.scattering = Scattering::Single;
        let scene = scene_of(Model::Radiative(Box::new(on_the_axis)), [1, 1]);
        let refused = matches!(rendered(&scene), Err(RenderError::Divergent { .. }));
        margin.holds("a picture of it is refused as infinitely bright", refused);
        margin.exact(
            "seen on the ray",
            scattered_once(&lamp_at(on), &view),
            DVec3::INFINITY,
        );
    }
}

fn s9_spotlight_edge_and_warps(margin: &mut Margin) {
    // Degrees; the cosine of this cone is a half but for its last place.
    let angle = 60.0_f64;
    match Spot::new(DVec3::ZERO, DVec3::Z, DVec3::ONE, [angle, angle]) {
        Ok(spot) => {
            let edge = spot.cos_outer();
            let towards = |sine, cosine| Direction::unit(DVec3::new(sine, 0.0, cosine));
            let on = towards((1.0 - edge * edge).sqrt(), edge);
            margin.exact("on the edge", spot.falloff(on), 0.0);
            let at = |angle: f64| towards(sin(angle.to_radians()), cos(angle.to_radians()));
            margin.exact("within", spot.falloff(at(angle - 1e-9)), 1.0);
            margin.exact("beyond", spot.falloff(at(angle + 1e-9)), 0.0);
        }
        Err(error) => margin.holds(format_args!("a sharp edge is a spotlight: {error}"), false),
    }
    // Light scattered once where a ray crosses the cone, near it and from far away: in thin isotropic
    // media the angle under which the light sees the lit segment, over the distance to the ray.
    let half_angle = 20.0_f64;
    for (eye, distance) in [(1.0, 1.0), (1e4, 0.05)] {
        let sigma_s = 1e-12;
        let bounds = cuboid([-9.0; 3], [9.0; 3]);
        let mut scene = before_sky(vec![in_box(bounds, grey(sigma_s, 1.0, 0.0))]);
        scene.environment = DVec3::ZERO;
        let intensity = DVec3::splat(4.0 * PI * distance / sigma_s);
        let light = Spot::new(
            DVec3::Y * distance,
            DVec3::NEG_Y,
            intensity,
            [half_angle; 2],
        );
        scene.lights.extend(light.map(Light::Spot));
        let found = scattered_once(&scene, &ray([-eye, 0.0, 0.0], DVec3::X)).x;
        let right = 2.0 * half_angle.to_radians();
        // Twenty per 10^12 are taken away; a place 10^4 away is rounded by 1e-12.
        let allowed = 4e-11 * right + 4.0 * 1e4 * U / distance;
        margin.within(
            format_args!("across the cone from {eye:e}"),
            found,
            right,
            allowed,
        );
    }

    let cone = Cone::of_half_angle(0.3).expect("an angle");
    let mut pdf = |name: &str, pdf: f64| {
        margin.holds(
            format_args!("density of {name}: {pdf}"),
            pdf > 0.0 && pdf.is_finite(),
        );
    };
    for (u, v) in [(0.0, 0.0), (0.0, LAST), (LAST, 0.0), (LAST, LAST)] {
        pdf(
            "a hemisphere by cosine",
            cosine_hemisphere_pdf(cosine_hemisphere([u, v]).z),
        );
        pdf("a cone", cone.pdf());
        let colliding = opacity(6.0);
        let depth = truncated_optical_distance(colliding, u);
        pdf(
            "a flight with an end",
            truncated_free_flight_pdf(2.0, depth, colliding),
        );
        let light = Equiangular::new(1e-6, 1.0, f64::INFINITY).expect("beside the ray");
        pdf("a place before a light", light.pdf(light.sample(u)));
        pdf(
            "a deflection",
            henyey_greenstein(0.9).per_steradian(&henyey_greenstein(0.9).deflection(u)),
        );
    }
    for (u, v) in [(0.0, 0.0), (0.0, LAST), (LAST, 0.0), (LAST, LAST)] {
        for (name, direction) in [
            ("sphere", sphere([u, v])),
            ("hemisphere", cosine_hemisphere([u, v])),
            ("cone", cone.direction([u, v])),
        ] {
            margin.within(
                format_args!("length, {name} at {u}, {v}"),
                direction.length(),
                1.0,
                8.0 * U,
            );
        }
        let depth = truncated_optical_distance(opacity(6.0), u);
        margin.holds(
            format_args!("flight with an end at {u}"),
            // Its condition at the end is 67: see truncated_optical_distance.
            (0.0..=6.0 * (1.0 + 204.0 * U)).contains(&depth),
        );
    }
}

fn s10_strongly_coloured_medium(margin: &mut Margin) {
    let sigma_s = DVec3::new(1e-3, 1.0, 1e3);
    let medium = coloured(DVec3::ZERO, sigma_s, Asymmetry::ISOTROPIC);
    let scene = before_sky(vec![in_box(unit_box(), medium)]);
    let view = ray([0.5, 0.5, -1.0], DVec3::Z);
    let right = [0.999_000_499_833_375, 0.367_879_441_171_442_3, 0.0];
    for (channel, (found, right)) in straight(&scene, &view)
        .to_array()
        .into_iter()
        .zip(right)
        .enumerate()
    {
        margin.roundings(
            format_args!("channel {channel}, in closed form"),
            found,
            right,
            8.0,
        );
    }
    // Not scattered at all: what gets through is all that is seen. A path is seen by all channels.
    let mut path = paths(&scene, Some(0), view);
    let mut moments = [Moments::default(); 3];
    for sample in 0..40_000 {
        let weight = path(sample);
        let bounded = weight.min_element() >= 0.0 && weight.max_element() <= 3.0;
        margin.holds(
            format_args!("weight {weight} of path {sample} is in [0, 3]"),
            bounded,
        );
        moments
            .iter_mut()
            .zip(weight.to_array())
            .for_each(|(m, channel)| m.add(channel));
    }
    for (channel, (found, right)) in moments.iter().zip(right).enumerate() {
        margin.sampled(
            format_args!("channel {channel}, by tracking"),
            found,
            right,
            0.0,
        );
    }
}
