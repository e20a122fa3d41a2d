//! S: scattering and sampling.

use super::known::henyey_greenstein;
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
use crate::optics::{Asymmetry, Deflection, Light, Material, Point, Spot, opacity};
use crate::render::RenderError;
use crate::scene::{Body, Object, Radiative, Scattering};
use crate::volume::{GridDensity, Interpolation};
use glam::DVec3;
use std::f64::consts::TAU;

/// The least random number above 0.
const FIRST: f64 = U;

#[test]
fn s1_deflections_and_their_mirror() {
    let margin = &Margin;
    for size in [0.0, 1e-17, 1e-12, 1e-8, 1e-3, 0.5, 0.9, 0.999, 1.0 - 1e-12] {
        for g in [size, -size] {
            let turn = |u| henyey_greenstein(g).deflection(u);
            // Both ends, to the bit.
            let (back, ahead) = (turn(0.0), turn(1.0));
            let what = |which: &str| format!("g = {g:e}: {which}");
            let ends = [back.cos, back.one_plus_cos, ahead.cos, ahead.one_minus_cos];
            margin.exact(what("straight back and on"), ends, [-1.0, 0.0, 1.0, 0.0]);
            for u in [0.25, 0.75, FIRST, LAST] {
                margin.holds(what("a cosine"), (-1.0..=1.0).contains(&turn(u).cos));
                // The mirror of g is that of u.
                let mirror = henyey_greenstein(-g).deflection(1.0 - u).one_minus_cos;
                margin.exact(what("mirrored"), mirror, turn(u).one_plus_cos);
            }
        }
    }
    for g in [1.0, -1.0, f64::NAN] {
        let refused = Asymmetry::new(g).is_err();
        margin.holds(format_args!("g = {g} is refused"), refused);
    }
}

#[test]
fn s2_integral_and_mean_cosine() {
    let margin = &Margin;
    for g in [-0.999, -0.9, -0.3, 0.0, 1e-9, 0.5, 0.99, 0.999] {
        let phase = henyey_greenstein(g);
        // By the angle from the peak, in units in which the peak is as wide as the rest.
        let width = (1.0 - f64::abs(g)).max(1e-3);
        let over_sphere = |s: f64| {
            let rest = 1.0 - s;
            let near = 2.0 * width * width * s * s / (rest * rest);
            let slope = 4.0 * width * width * s / (rest * rest * rest);
            let far = 2.0 - near;
            let (cos, one_minus_cos, one_plus_cos) = match g >= 0.0 {
                true => (1.0 - near, near, far),
                false => (near - 1.0, far, near),
            };
            let deflection = Deflection {
                cos,
                one_minus_cos,
                one_plus_cos,
            };
            let density = TAU * phase.per_steradian(&deflection) * slope;
            DVec3::new(density, density * cos, 0.0)
        };
        let found = integrate(over_sphere, 0.0, 1.0 / (1.0 + width), 1e-15).value;
        margin.within(format_args!("integral, g = {g}"), found.x, 1.0, 1e-12);
        margin.within(format_args!("mean cosine, g = {g}"), found.y, g, 1e-12);
    }
}

/// Sampled deflections fill 64 classes of equal probability evenly: one sum in a thousand of 63
/// degrees of freedom is larger than the bound.
#[test]
fn s2_histogram() {
    let margin = &Margin;
    const BOUND: f64 = 103.442;
    let asymmetries = [-0.999, -0.5, 0.0, 1e-9, 0.9, 0.999];
    for (pixel, g) in (0..).zip(asymmetries) {
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
        margin.within(what, Sum::from_iter(squares).value(), 0.0, BOUND);
    }
}

#[test]
fn s3_orthonormal_frame() {
    let margin = &Margin;
    let mut directions = vec![
        Direction::Z,
        Direction::NEG_Z,
        Direction::X,
        Direction::NEG_Y,
        Direction::unit(DVec3::new(1.0, -0.0, -0.0)),
        Direction::unit(DVec3::new(-0.0, 1.0, -0.0)),
    ];
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

#[test]
fn s4_white_furnace() {
    let margin = &Margin;
    let in_cube = |sigma, g| in_box(cuboid([-1.0; 3], [1.0; 3]), grey(sigma, 1.0, g));
    let in_ball = |centre, sigma, g| in_ball(ball(centre, 1.0), grey(sigma, 1.0, g));
    let bumpy = grid([5, 6, 7], [0.5, 0.4, 1.0 / 3.0], |[i, j, k]| {
        ((3 * i + 5 * j + 7 * k) % 4) as f32
    });
    let bumpy = GridDensity::new(bumpy, Interpolation::Trilinear);
    let in_bumps = |g| in_grid(&bumpy, grey(3.0, 1.0, g));
    let overlapping = vec![
        in_cube(2.0, 0.3),
        in_ball(DVec3::X, 2.0, -0.5),
        in_bumps(0.0),
    ];
    // Where media overlap, one is chosen in the proportion of their densities there, which takes
    // four roundings; no path is scattered more than a thousand times.
    let media: [(&str, Vec<Body>, f64); 5] = [
        ("thin box", vec![in_cube(0.1, 0.0)], 0.0),
        (
            "dense ball, forward",
            vec![in_ball(DVec3::ZERO, 20.0, 0.9)],
            0.0,
        ),
        ("box, backward", vec![in_cube(4.0, -0.6)], 0.0),
        ("grid", vec![in_bumps(0.4)], 0.0),
        ("three that overlap", overlapping, 1e-12),
    ];
    for (name, media, allowed) in media {
        let scene = before_sky(media);
        for (sample, [u, v, w]) in (0..400).zip(numbers(34, 400)) {
            // From anywhere, inside and outside, into any direction.
            let origin = sphere([u, v]) * (3.0 * w);
            let seen = paths(&scene, None, ray(origin, *sphere([v, w])))(sample);
            for channel in seen.to_array() {
                margin.within(format_args!("{name}, path {sample}"), channel, 1.0, allowed);
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

#[test]
fn s6_conservative_thick_slab() {
    let margin = &Margin;
    const PATHS: u32 = 1500;
    // A black plane beyond one face hides the sky on that side: what a path brings back under the
    // one sky or the other is what is reflected or let through, of the same path.
    let dark = |height: f64| {
        let reach = 2.0 * REACH;
        let plane = Rectangle::new(
            DVec3::new(-reach, -reach, height),
            DVec3::X * (2.0 * reach),
            DVec3::Y * (2.0 * reach),
        );
        let mut scene = slab(50.0, 1.0);
        scene.objects.push(Object {
            shape: Shape::Rectangle(plane.expect("edges")),
            material: Material::Diffuse(DVec3::ZERO),
        });
        scene
    };
    let (above, below) = (dark(-1.0), dark(2.0));
    let mut reflected = paths(&above, None, down());
    let mut transmitted = paths(&below, None, down());
    let mut share = Moments::default();
    for sample in 0..PATHS {
        let (back, through) = (reflected(sample).x, transmitted(sample).x);
        margin.exact(format_args!("path {sample}: R + T"), back + through, 1.0);
        share.add(through);
    }
    // The asymptotic law of a beam that comes in along the normal, exact but for e^(−50): H(1)/√3 over the depth and two
    // extrapolation lengths (van de Hulst 1980, ch. 5), H(1) = 2.907810529.
    let right = 2.907_810_529 / (3.0_f64.sqrt() * (50.0 + 2.0 * 0.710_446_089_6));
    // Shares are 0 or 1: their spread is known beforehand.
    let variance = right * (1.0 - right) / f64::from(PATHS);
    margin.within("T", share.mean(), right, STANDARD_ERRORS * variance.sqrt());
}

#[test]
fn s8_light_near_the_ray() {
    let margin = &Margin;
    for (distance, right) in [
        (1.0, 1.892_546_881_191_539),
        (1e-3, 3_140.092_653_964_793),
        (1e-6, 3_141_591.153_589_793),
    ] {
        let angle = atan2(2.0, distance) + atan2(1.0, distance);
        margin.relative("what is known", angle / distance, right, 1e-12);
        // One sample is the integral, whichever it is.
        let Ok(light) = Equiangular::new(distance, -1.0, 2.0) else {
            margin.holds("a light beside the ray can be sampled", false);
            continue;
        };
        for u in [0.0, 0.1, 0.5, 0.9, LAST] {
            let t = light.sample(u);
            let estimate = 1.0 / (distance * distance + t * t) / light.pdf(t);
            let what = format_args!("u = {u}, {distance:e} beside");
            margin.relative(what, estimate, right, 1e-12);
        }
    }
}

#[test]
fn s8_light_on_the_ray() {
    let margin = &Margin;
    for on in [0.0, -0.0] {
        let light = Equiangular::new(on, -1.0, 2.0);
        margin.exact("on the ray", light, Err(LightOnRay));
        let bounds = cuboid(DVec3::NEG_ONE, DVec3::ONE);
        let mut scene = before_sky(vec![in_box(bounds, grey(1.0, 1.0, 0.0))]);
        scene.environment = DVec3::ZERO;
        scene.scattering = Scattering::Single;
        scene.lights.push(Light::Point(Point {
            position: DVec3::X * on,
            intensity: DVec3::ONE,
        }));
        let picture = rendered(&scene_of(scene, [1, 1]));
        let refused = matches!(picture, Err(RenderError::Divergent(_)));
        margin.holds("a picture of it is refused as infinitely bright", refused);
    }
}

#[test]
fn s9_spotlight_edge() {
    let margin = &Margin;
    // Degrees; the cosine of this cone is a half but for its last place.
    let angle = 60.0_f64;
    let spot = Spot::new(DVec3::ZERO, DVec3::Z, DVec3::ONE, [angle, angle]);
    let Ok(spot) = spot else {
        return margin.holds("a sharp edge is a spotlight", false);
    };
    let edge = spot.cos_outer;
    let towards = |sine, cosine| Direction::unit(DVec3::new(sine, 0.0, cosine));
    let on = towards((1.0 - edge * edge).sqrt(), edge);
    margin.exact("on the edge", spot.falloff(on), 0.0);
    let at = |angle: f64| towards(sin(angle.to_radians()), cos(angle.to_radians()));
    margin.exact("within", spot.falloff(at(angle - 1e-9)), 1.0);
    margin.exact("beyond", spot.falloff(at(angle + 1e-9)), 0.0);
}

#[test]
fn s9_warps_at_their_ends() {
    let margin = &Margin;
    let cone = Cone::of_half_angle(0.3).expect("an angle");
    let light = Equiangular::new(1e-6, 1.0, f64::INFINITY).expect("beside the ray");
    let phase = henyey_greenstein(0.9);
    let colliding = opacity(6.0);
    for (u, v) in [(0.0, 0.0), (0.0, LAST), (LAST, 0.0), (LAST, LAST)] {
        let hemisphere = cosine_hemisphere([u, v]);
        let depth = truncated_optical_distance(colliding, u);
        let flight = truncated_free_flight_pdf(2.0, depth, colliding);
        for (name, pdf) in [
            (
                "a hemisphere by cosine",
                cosine_hemisphere_pdf(hemisphere.z),
            ),
            ("a cone", cone.pdf()),
            ("a flight with an end", flight),
            ("a place before a light", light.pdf(light.sample(u))),
            ("a deflection", phase.per_steradian(&phase.deflection(u))),
        ] {
            let what = format_args!("density of {name}: {pdf}");
            margin.holds(what, pdf > 0.0 && pdf.is_finite());
        }
        for (name, direction) in [
            ("sphere", sphere([u, v])),
            ("hemisphere", hemisphere),
            ("cone", cone.direction([u, v])),
        ] {
            let what = format_args!("length, {name} at {u}, {v}");
            margin.within(what, direction.length(), 1.0, 8.0 * U);
        }
        // Its condition at the end is 67: see truncated_optical_distance.
        let in_range = (0.0..=6.0 * (1.0 + 204.0 * U)).contains(&depth);
        margin.holds(format_args!("flight with an end at {u}"), in_range);
    }
}

#[test]
fn s10_strongly_coloured_medium() {
    let margin = &Margin;
    let sigma_s = DVec3::new(1e-3, 1.0, 1e3);
    let medium = coloured(DVec3::ZERO, sigma_s, Asymmetry::ISOTROPIC);
    let scene = before_sky(vec![in_box(unit_box(), medium)]);
    // Not scattered at all: what gets through is all that is seen. A path is seen by all channels.
    let mut path = paths(&scene, Some(0), middle());
    let weights = (0..40_000).map(|sample| {
        let weight = path(sample);
        let bounded = weight.min_element() >= 0.0 && weight.max_element() <= 3.0;
        let what = format_args!("weight {weight} of path {sample} is in [0, 3]");
        margin.holds(what, bounded);
        weight
    });
    let by_tracking = by_channel(weights);
    let in_closed_form = straight(&scene, &middle());
    let right = [0.999_000_499_833_375, 0.367_879_441_171_442_3, 0.0];
    for (channel, right) in right.into_iter().enumerate() {
        let what = format_args!("channel {channel}, in closed form");
        margin.roundings(what, in_closed_form[channel], right, 8.0);
        let what = format_args!("channel {channel}, by tracking");
        margin.sampled(what, &by_tracking[channel], right);
    }
}
