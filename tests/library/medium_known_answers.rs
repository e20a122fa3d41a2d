//! Phase function, transmittance, emission and free flights against numbers from outside.
//!
//! Every number of the four files is asked of the library, but these:
//!
//! - `free_flight` p008 and p009: the variances are predictions here; the mean number of
//!   tentative collisions and the variances as measured belong to the trackers' own tests.

use crate::common::entries::{Entry, numbers};
use crate::common::estimators::*;
use crate::common::quadrature::integral;
use glam::DVec3;
use std::f64::consts::TAU;
use volref::geometry::{Aabb, Boundary, Camera, Direction, Line, Ray, Solid, Sphere};
use volref::math::quadrature::cubic_integral;
use volref::math::rng::{Purpose, Stream};
use volref::math::sampling::*;
use volref::math::{Sum, exp};
use volref::optics::profiles::*;
use volref::optics::*;
use volref::render::counters::Counters;
use volref::render::plan::RadiativeFeatures;
use volref::render::radiative::context::Scratch;
use volref::render::radiative::line_of_sight::LineOfSight;
use volref::render::radiative::scene_context::SceneContext;
use volref::scene::{Body, Radiative, Scattering};
use volref::volume::{Cell, Grid, Lattice, LinearRamp};

/// The largest relative error of one rounding.
const U: f64 = f64::EPSILON / 2.0;

// Phase function.

fn phase_entries() -> Vec<(Entry, HenyeyGreenstein)> {
    let entries = Entry::all(include_str!("../../fixtures/known-answers/phase_hg.json"));
    assert_eq!(entries.len(), 15);
    let phase = |entry: &Entry| HenyeyGreenstein(Asymmetry::new(entry.input("g")).unwrap());
    let with_phase = entries.into_iter().map(|entry| {
        let phase = phase(&entry);
        (entry, phase)
    });
    with_phase.collect()
}

#[test]
fn phase_values_and_distribution() {
    for (entry, phase) in phase_entries() {
        let turns = || entry.inputs("mu").into_iter().map(Deflection::from_cos);
        entry.are("pdf_sr", turns().map(|turn| phase.per_steradian(&turn)));
        let of_cosine = |turn| TAU * phase.per_steradian(&turn);
        entry.are("pdf_mu", turns().map(of_cosine));
        entry.are("cdf", turns().map(|turn| phase.cdf(&turn)));
    }
}

#[test]
fn phase_inverse_distribution() {
    for (entry, phase) in phase_entries() {
        let turns = || entry.inputs("xi").into_iter().map(|u| phase.deflection(u));
        entry.are("one_minus_mu_of_xi", turns().map(|turn| turn.one_minus_cos));
        entry.are("one_plus_mu_of_xi", turns().map(|turn| turn.one_plus_cos));
        // The cosine is 2u − 1 plus a shift by g. Where they cancel the relative error grows by
        // shift/cosine, the condition of the sum; the absolute one stays at 8 roundings of the
        // shift.
        let expected = numbers(&entry.0["expected"]["mu_of_xi"]);
        for ((u, turn), cosine) in entry.inputs("xi").into_iter().zip(turns()).zip(expected) {
            let shift = (cosine - (2.0 * u - 1.0)).abs();
            entry.compare("mu_of_xi", turn.cos, cosine, 8.0 * U * shift);
        }
    }
}

/// Integral over the sphere of the phase function times a function of the cosine, in panels that
/// double in width away from the peak.
fn over_sphere(phase: HenyeyGreenstein, function: impl Fn(f64) -> f64) -> f64 {
    from_peak(phase.0, 2.0, |turn| {
        phase.per_steradian(turn) * function(turn.cos)
    })
}

/// Integral of a density per steradian, which peaks as that of Henyey and Greenstein with parameter
/// `g` does, over the cosines up to `end` from the peak.
fn from_peak(g: Asymmetry, end: f64, density: impl Fn(&Deflection) -> f64) -> f64 {
    let g = g.g();
    // Over this distance of the cosine from the peak the bracket doubles.
    let width = (1.0 - g.abs()) * (1.0 - g.abs()) / (2.0 * g.abs());
    let mut panels = Sum::default();
    let (mut from, mut to) = (0.0_f64, width.min(end));
    while from < end {
        panels.add(integral(from, to, 16, |from_peak| {
            let (near, far) = (from_peak, 2.0 - from_peak);
            let [one_minus_cos, one_plus_cos] = if g >= 0.0 { [near, far] } else { [far, near] };
            let turn = Deflection {
                cos: if g >= 0.0 { 1.0 - near } else { near - 1.0 },
                one_minus_cos,
                one_plus_cos,
            };
            TAU * density(&turn)
        }));
        (from, to) = (to, (2.0 * to).min(end));
    }
    panels.value()
}

fn asymmetry(g: f64) -> Asymmetry {
    Asymmetry::new(g).unwrap()
}

/// Parameters of Draine's function: all signs and sharpnesses, Henyey and Greenstein's, Cornette and
/// Shanks', those of droplets, and next to cos² alone.
fn draine_functions() -> impl Iterator<Item = Draine> {
    let each = [-0.95, -0.3, 0.0, 0.5, 0.9].into_iter();
    each.flat_map(|g| {
        let alphas = [0.0, 0.25, 1.0, 30.0, 1e6].into_iter();
        alphas.map(move |alpha| Draine::new(asymmetry(g), alpha).unwrap())
    })
}

#[test]
fn draine_is_normalised_with_its_mean_cosine() {
    for phase in draine_functions() {
        let mean = |function: &dyn Fn(f64) -> f64| {
            from_peak(phase.asymmetry(), 2.0, |turn| {
                phase.per_steradian(turn) * function(turn.cos)
            })
        };
        // 24 of the function, 6 of the quadrature; 8 of the formula.
        let norm = mean(&|_| 1.0);
        assert!((norm - 1.0).abs() <= 30.0 * U, "{phase:?}: {norm}");
        let (found, expected) = (mean(&|cosine| cosine), phase.mean_cosine());
        let error = (found - expected).abs();
        assert!(error <= 38.0 * U, "{phase:?}: {found} {expected}");
    }
}

/// A share `u` of the light is scattered below the cosine for `u`.
#[test]
fn draine_deflections_invert_the_distribution() {
    for phase in draine_functions() {
        let g = phase.asymmetry();
        for step in 0..=200 {
            let u = f64::from(step) / 200.0;
            let turn = phase.deflection(u);
            let forward = g.g() >= 0.0;
            let end = if forward {
                turn.one_minus_cos
            } else {
                turn.one_plus_cos
            };
            let share = from_peak(g, end.min(2.0), |turn| phase.per_steradian(turn));
            let expected = if forward { 1.0 - u } else { u };
            // 30 of the integral; the terms of the polynomial add up to at most 13 times their sum,
            // each to 10 roundings; and those of the deflection.
            let error = (share - expected).abs();
            assert!(error <= 200.0 * U, "{phase:?} at {u}: {}", error / U);
        }
    }
}

/// The lobes of fog: integral, mean cosine, and samples in 32 classes of the cosine by Pearson's
/// test. For `k` degrees of freedom a sum above `k + 2√(kx) + 2x` has a probability below e^(−x)
/// (Laurent & Massart 2000, lemma 1); x = 6.9 makes that 1e-3, of a seed that is fixed.
#[test]
fn droplets_are_sampled_by_their_density() {
    for diameter in [5.0, 12.0, 50.0] {
        let phase = Droplets::new(diameter).unwrap();
        // The sharper of the two lobes, in both of which panels are narrow enough.
        let peak = asymmetry(volref::math::exp(-0.099_056_7 / (diameter - 1.671_54)));
        let share = |from: f64, to: f64| {
            let below = |end| from_peak(peak, end, |turn| phase.per_steradian(turn));
            below(1.0 - from) - below(1.0 - to)
        };
        assert!((share(-1.0, 1.0) - 1.0).abs() <= 40.0 * U);
        let mean = from_peak(peak, 2.0, |turn| phase.per_steradian(turn) * turn.cos);
        assert!((mean - phase.mean_cosine()).abs() <= 48.0 * U, "{mean}");

        const CLASSES: usize = 32;
        const SAMPLES: u32 = 1 << 16;
        // Classes are narrower towards the peak: by powers of the distance from it.
        let edge = |class: usize| match class {
            0 => -1.0,
            class => 1.0 - 2.0 * volref::math::exp2(-(class as f64) / 2.0),
        };
        let mut counts = [0_u32; CLASSES];
        let stream = Stream::new(23, 0, 0);
        for sample in 0..SAMPLES {
            let turn = phase.deflection(stream.uniform(0, Purpose::PhaseDirection, sample));
            let class = (1..CLASSES)
                .take_while(|&class| turn.cos >= edge(class))
                .count();
            counts[class] += 1;
        }
        let terms = counts.iter().enumerate().map(|(class, &count)| {
            let to = if class + 1 == CLASSES {
                1.0
            } else {
                edge(class + 1)
            };
            let expected = f64::from(SAMPLES) * share(edge(class), to);
            (f64::from(count) - expected) * (f64::from(count) - expected) / expected
        });
        let found = Sum::from_iter(terms).value();
        let (k, x) = ((CLASSES - 1) as f64, 6.9_f64);
        let bound = k + 2.0 * (k * x).sqrt() + 2.0 * x;
        assert!(found <= bound, "{diameter}: {found} exceeds {bound}");
    }
}

#[test]
fn phase_moments() {
    for (entry, phase) in phase_entries() {
        // The phase function to 10 roundings, node and weight of the quadrature to 3 and 1, all
        // against ∫|…| p ≤ 1: no digit of a mean cosine of 1e-15 can come out of an integral.
        let roundings = 16.0 * U;
        entry.is_within("norm", over_sphere(phase, |_| 1.0), roundings);
        entry.is_within("mean_mu", over_sphere(phase, |mu| mu), roundings);
        entry.is_within(
            "mean_mu_squared",
            over_sphere(phase, |mu| mu * mu),
            roundings,
        );
    }
}

// Transmittance.

/// Optical depth and what follows from it. The rounding of a depth is amplified by the depth in
/// the exponential.
#[track_caller]
fn crosses(entry: &Entry, depth: f64) {
    entry.is("optical_depth", depth);
    let (crossing, held) = (entry.expected("transmittance"), entry.expected("opacity"));
    let amplified = entry.digits() * entry.expected("optical_depth") * crossing;
    entry.compare(
        "transmittance",
        transmittance(depth),
        crossing,
        amplified + entry.digits() * crossing,
    );
    entry.compare("opacity", opacity(depth), held, amplified);
}

/// Length of the ray in a solid.
fn length_in(solid: &impl Solid, entry: &Entry) -> f64 {
    let towards = entry.vector("direction_unnormalised");
    let ray = Ray::new(entry.vector("origin"), towards).unwrap();
    let spans = solid.spans(&ray);
    assert!(spans.len() <= 1);
    let length = spans.first().map_or(0.0, |span| span.length());
    // A length is the difference of two distances of three roundings each.
    let roundings = spans.first().map_or(0.0, |span| 6.0 * U * span.far);
    entry.is_within("path_length", length, roundings);
    length
}

fn linear_depth(entry: &Entry) -> f64 {
    let line = Line {
        origin: entry.vector("origin"),
        direction: *Direction::of(entry.vector("direction_unnormalised")).unwrap(),
    };
    let ramp = linear(1.0, entry.vector("gradient"));
    let (unit, sigma0) = (LinearProfile::along(&line, &ramp), entry.input("sigma0"));
    let profile = LinearProfile {
        start: sigma0 * unit.start,
        slope: sigma0 * unit.slope,
    };
    profile.optical_depth(entry.input("t_min"), entry.input("t_max"))
}

fn exponential_depth(entry: &Entry) -> f64 {
    let scale_height = entry.input("scale_height");
    let profile = ExponentialProfile {
        start: entry.input("sigma0") * exp(-entry.input("z0") / scale_height),
        rate: entry.input("dz") / scale_height,
    };
    profile.optical_depth(0.0, entry.input("length"))
}

fn gaussian_depth(entry: &Entry) -> f64 {
    let direction = Direction::of(entry.vector("direction_unnormalised")).unwrap();
    let (origin, width) = (entry.vector("origin"), entry.input("width"));
    let centre = -origin.dot(*direction);
    let closest = origin + direction * centre;
    let profile = GaussianProfile {
        peak: entry.input("sigma0") * exp(-closest.length_squared() / (2.0 * width * width)),
        centre,
        width,
    };
    profile.optical_depth(entry.input("t_min"), entry.input("t_max"))
}

fn layers_depth(entry: &Entry) -> f64 {
    let layers = entry.0["inputs"]["layers_sigma_length"].as_array().unwrap();
    let depths = layers.iter().map(numbers);
    Sum::from_iter(depths.map(|layer| optical_depth(layer[0], layer[1]))).value()
}

fn cell_depth(entry: &Entry) -> f64 {
    let lattice = Lattice::new([2; 3], DVec3::ONE, DVec3::ZERO).unwrap();
    let grid = Grid::new(lattice, entry.inputs("corners")).unwrap();
    let (from, to) = (entry.vector("from"), entry.vector("to"));
    let ray = Ray::new(from, to - from).unwrap();
    let density = |t: f64| Cell::around(&lattice, lattice.to_nodes(ray.at(t))).trilinear(&grid);
    entry.input("sigma_scale") * cubic_integral(density, 0.0, (to - from).length())
}

#[test]
fn transmittance_along_rays() {
    let entries = Entry::all(include_str!(
        "../../fixtures/known-answers/transmittance.json"
    ));
    assert_eq!(entries.len(), 31);
    for entry in &entries {
        let homogeneous = |length| optical_depth(entry.input("sigma_t"), length);
        let depth = match entry.case() {
            "homogeneous" => homogeneous(entry.input("length")),
            "box" => {
                let (min, max) = (entry.vector("box_min"), entry.vector("box_max"));
                homogeneous(length_in(&Aabb { min, max }, entry))
            }
            "sphere" => {
                let sphere = Sphere::new(entry.vector("center"), entry.input("radius")).unwrap();
                homogeneous(length_in(&sphere, entry))
            }
            "linear" => linear_depth(entry),
            "exponential" => exponential_depth(entry),
            "gaussian" => gaussian_depth(entry),
            "layers" => layers_depth(entry),
            "trilinear cell" => cell_depth(entry),
            unknown => panic!("{unknown}"),
        };
        crosses(entry, depth);
    }
}

// Emission and absorption.

#[test]
fn emission_and_absorption() {
    let text = include_str!("../../fixtures/known-answers/emission_absorption.json");
    let entries = Entry::all(text);
    assert_eq!(entries.len(), 11);
    for entry in &entries {
        match entry.case() {
            "two layers" => two_layers(entry),
            "linear density" => linear_density(entry),
            _ => one_layer(entry),
        }
    }
}

/// A ramp that has this density at the origin.
fn linear(density: f64, gradient: DVec3) -> LinearRamp {
    let origin = DVec3::ZERO;
    LinearRamp {
        density,
        origin,
        gradient,
    }
}

/// Radiance along the x axis through `media`, each from where to where, before a background: by
/// the renderer's integrals, to a relative 1e-14.
fn seen(media: &[(f64, f64, Homogeneous, Option<LinearRamp>)], background: f64) -> f64 {
    let body = |&(near, far, medium, ramp): &(f64, f64, Homogeneous, Option<LinearRamp>)| {
        let bounds = Aabb {
            min: DVec3::new(near, -1.0, -1.0),
            max: DVec3::new(far, 1.0, 1.0),
        };
        Body {
            boundary: Some(Boundary::Box(bounds)),
            medium,
            density: ramp.map(|ramp| Density::new(Field::Linear(ramp), bounds, None)),
        }
    };
    let scene = Radiative {
        scattering: Scattering::None,
        objects: vec![],
        area_lights: vec![],
        media: media.iter().map(body).collect(),
        lights: vec![],
        environment: DVec3::splat(background),
        camera: Camera::new(DVec3::ZERO, DVec3::X, DVec3::Y, 0.5).unwrap(),
        samples: 1,
        seed: 0,
    };
    let renderer = LineOfSight {
        scene: SceneContext::for_integrals(&scene, RadiativeFeatures::ALL),
        scattering: false,
        tolerance: 1e-14,
    };
    let ray = Ray::new(DVec3::ZERO, DVec3::X).unwrap();
    let radiance = renderer.radiance(&ray, &mut Scratch::default(), &mut Counters::default());
    radiance.x
}

/// A medium that absorbs and emits alone.
fn absorbing(sigma_a: f64, emission: f64) -> Homogeneous {
    Homogeneous {
        coefficients: Coefficients::new(DVec3::splat(sigma_a), DVec3::ZERO).unwrap(),
        emission: DVec3::splat(emission),
        phase: Phase::ISOTROPIC,
    }
}

fn one_layer(entry: &Entry) {
    let (sigma_t, length) = (entry.input("sigma_t"), entry.input("length"));
    let [j0, j1] = match entry.case() {
        "constant emission" => [entry.input("j"), 0.0],
        "linear emission" => [entry.input("j0"), entry.input("j1")],
        "linear source function" => ["S0", "S1"].map(|name| sigma_t * entry.input(name)),
        unknown => panic!("{unknown}"),
    };
    let constant = (0.0, length, absorbing(sigma_t, j0), None);
    let media = if j1 == 0.0 {
        vec![constant]
    } else {
        // Extinction of its own, and an emission of density j0 + j1 t.
        let ramp = linear(j0, DVec3::X * j1);
        vec![
            (0.0, length, absorbing(sigma_t, 0.0), None),
            (0.0, length, absorbing(0.0, 1.0), Some(ramp)),
        ]
    };
    // The quadrature's own tolerance, and a dozen roundings.
    let quadrature = if j1 == 0.0 { 0.0 } else { 1e-14 + 12.0 * U };
    let emitted = seen(&media, 0.0);
    entry.is_within("L_emitted", emitted, quadrature * emitted);
    let depth = optical_depth(sigma_t, length);
    entry.is("transmittance", transmittance(depth));
    let total = seen(&media, entry.input("L_background"));
    entry.is_within("L_total", total, quadrature * total);
}

fn two_layers(entry: &Entry) {
    let layer = |name: &str, near: f64| {
        let [sigma, length, source] =
            ["sigma", "length", "S"].map(|what| entry.input(&format!("{name}_{what}")));
        (near, near + length, absorbing(sigma, sigma * source), None)
    };
    let background = entry.input("L_background");
    for (answer, [first, second]) in [
        ("L_total", ["near", "far"]),
        ("L_total_if_order_is_wrongly_reversed", ["far", "near"]),
    ] {
        let first = layer(first, 0.0);
        let found = seen(&[first, layer(second, first.1)], background);
        // An emission of σ S over σ: 4 roundings of each layer.
        entry.is_within(answer, found, 8.0 * U * found);
    }
}

fn linear_density(entry: &Entry) {
    let (sigma0, a, source) = (entry.input("sigma0"), entry.input("a"), entry.input("S0"));
    let length = entry.input("length");
    let ramp = linear(1.0, DVec3::X * a);
    let medium = absorbing(sigma0, sigma0 * source);
    let found = seen(&[(0.0, length, medium, Some(ramp))], 0.0);
    entry.is_within("L_isothermal", found, 8.0 * U * found);
    let profile = LinearProfile {
        start: sigma0,
        slope: sigma0 * a,
    };
    let squared = integral(0.0, length, 256, |t| {
        let density = 1.0 + a * t;
        let seen = transmittance(profile.optical_depth(0.0, t));
        source * sigma0 * density * density * seen
    });
    entry.is("L_emission_density_squared", squared);
}

// Free flights.

#[test]
fn free_flights() {
    let entries = Entry::all(include_str!(
        "../../fixtures/known-answers/free_flight.json"
    ));
    assert_eq!(entries.len(), 10);
    for entry in &entries {
        match entry.case() {
            "exponential" => exponential_flight(entry),
            "truncated to [0,d]" => truncated_flight(entry),
            "linear density" => flight_in_linear_density(entry),
            "exponential density" => flight_in_exponential_density(entry),
            "null-collision tracking" => null_collisions(entry),
            "expected sample sizes" => sample_sizes(entry),
            unknown => panic!("{unknown}"),
        }
    }
}

fn exponential_flight(entry: &Entry) {
    let sigma_t = entry.input("sigma_t");
    let distances = entry.inputs("xi").into_iter();
    entry.are("t_of_xi", distances.map(|u| free_flight(sigma_t, u)));
    entry.is("median", free_flight(sigma_t, 0.5));
    // Beyond 60 mean free paths lies e^(-60) · 60³ = 2e-21 of the third moment.
    let mean_of = |function: &dyn Fn(f64) -> f64| {
        let density = |t| truncated_free_flight_pdf(sigma_t, sigma_t * t, 1.0) * function(t);
        integral(0.0, 60.0 / sigma_t, 600, density)
    };
    let mean = mean_of(&|t| t);
    entry.is("mean", mean);
    entry.is("variance", mean_of(&|t| (t - mean) * (t - mean)));
    // Of the integral of |t − mean|³ a part cancels: 2.4 stand against 2.
    let cubed = mean_of(&|t| (t - mean) * (t - mean) * (t - mean));
    let roundings = 16.0 * U * entry.expected("third_central_moment");
    entry.is_within("third_central_moment", cubed, roundings);
}

fn truncated_flight(entry: &Entry) {
    let (sigma_t, length) = (entry.input("sigma_t"), entry.input("d"));
    let depth = optical_depth(sigma_t, length);
    entry.is("p_interaction", opacity(depth));
    entry.is("mean_min_t_d", length * source_factor(depth));
    let mean_of = |function: &dyn Fn(f64) -> f64| {
        let density =
            |t| truncated_free_flight_pdf(sigma_t, sigma_t * t, opacity(depth)) * function(t);
        integral(0.0, length, 256, density)
    };
    let mean = mean_of(&|t| t);
    entry.is("mean_given_interaction", mean);
    let variance = mean_of(&|t| (t - mean) * (t - mean));
    entry.is("variance_given_interaction", variance);
}

/// The optical depth at the distance of each answer is the optical distance of its number.
fn flights(entry: &Entry, depth_to: impl Fn(f64) -> f64) {
    let shares = entry.inputs("xi");
    let distances = entry.answers("t_of_xi");
    assert_eq!(shares.len(), distances.len());
    for (u, t) in shares.into_iter().zip(distances) {
        // A rounding of the distance is at most one of the depth here, where the extinction grows
        // at most linearly: 2; and 4 of the formula.
        let found = depth_to(t);
        entry.compare("t_of_xi", found, optical_distance(u), 6.0 * U * found);
    }
}

fn flight_in_linear_density(entry: &Entry) {
    let (sigma0, a) = (entry.input("sigma0"), entry.input("a"));
    let profile = LinearProfile {
        start: sigma0,
        slope: sigma0 * a,
    };
    flights(entry, |t| profile.optical_depth(0.0, t));
    // At 16 the optical depth is 59.
    let mean = integral(0.0, 16.0, 256, |t| {
        transmittance(profile.optical_depth(0.0, t))
    });
    entry.is("mean", mean);
}

fn flight_in_exponential_density(entry: &Entry) {
    let profile = ExponentialProfile {
        start: entry.input("sigma0"),
        rate: 1.0 / entry.input("scale_height"),
    };
    let everything = profile.optical_depth(0.0, f64::INFINITY);
    entry.is("p_interaction", opacity(everything));
    flights(entry, |t| profile.optical_depth(0.0, t));
}

fn null_collisions(entry: &Entry) {
    let (sigma_t, majorant) = (entry.input("sigma_t"), entry.input("majorant"));
    let length = entry.input("length");
    let depth = optical_depth(sigma_t, length);
    entry.is("transmittance", transmittance(depth));
    let squared = optical_depth(sigma_t * sigma_t / majorant, length);
    entry.is(
        "variance_ratio_tracking",
        ratio_tracking_variance(depth, squared),
    );
    entry.is(
        "variance_delta_tracking_survival",
        delta_tracking_variance(depth),
    );
}

fn sample_sizes(entry: &Entry) {
    let depth = optical_depth(entry.input("sigma_t"), entry.input("length"));
    let mean = transmittance(depth);
    entry.is("transmittance", mean);
    // n samples of relative variance v have the relative standard error √(v/n).
    let relative_variance = delta_tracking_variance(depth) / (mean * mean);
    entry.is(
        "samples_for_rel_std_err_1e-3_by_survival_counting",
        relative_variance / (1e-3 * 1e-3),
    );
}
