//! E: exponentials and opacity.

use super::Row;
use super::margin::Margin;
use super::scenes::*;
use crate::geometry::Span;
use crate::math::Sum;
use crate::math::sampling::{free_flight, optical_distance};
use crate::media::emission::constant_emission;
use crate::media::{
    Appearance, Coefficients, TransferFunction, TransferPoint, TransferPoints, collision_weight,
    escape_weight, opacity, optical_depth, over_length, source_factor, transmittance,
};
use crate::render::classified::compositing::{CompositingOrder, FrontToBack, Layers};
use crate::render::classified::steps::Steps;
use crate::render::{Event, Plan};
use crate::scene::{Classified, Compositing, Model};
use glam::DVec3;

pub const ROWS: &[Row] = &[
    Row {
        id: "E1",
        what: "very thin media",
        tolerance: "4 u",
        remedy: "-expm1(-tau), which keeps the digits of a thin medium",
        file: "src/media/optical_depth.rs",
        check: e1_very_thin_media,
    },
    Row {
        id: "E2",
        what: "very thick media: nothing is divided by what they let through",
        tolerance: "1e-13 of the transmittance at depth 700; 2 u of the radiance",
        remedy: "optical depth is what is carried; nothing is divided by a transmittance",
        file: "src/media/optical_depth.rs",
        check: e2_very_thick_media,
    },
    Row {
        id: "E3",
        what: "the source factor (1 - e^-tau) / tau",
        tolerance: "4 u; exact at 0",
        remedy: "-expm1(-tau)/tau, and 1 at exactly 0",
        file: "src/media/optical_depth.rs",
        check: e3_source_factor,
    },
    Row {
        id: "E4",
        what: "opacity correction 1 - (1 - a)^r",
        tolerance: "4 u; exact at the ends",
        remedy: "-expm1(r ln1p(-a)), once, from a stated length",
        file: "src/media/opacity.rs",
        check: e4_opacity_correction,
    },
    Row {
        id: "E5",
        what: "opacity 1, and zero times infinity",
        tolerance: "exact",
        remedy: "exact zeros are tested before anything is multiplied",
        file: "src/media/optical_depth.rs",
        check: e5_opaque_and_zero_times_infinity,
    },
    Row {
        id: "E6",
        what: "free flight at the ends of the random range",
        tolerance: "4 u; exact at 0",
        remedy: "-ln1p(-u)/sigma, and no flight at all without extinction",
        file: "src/math/sampling/free_flight.rs",
        check: e6_free_flight_at_the_ends,
    },
    Row {
        id: "E7",
        what: "weights where the transmittance underflows",
        tolerance: "exact",
        remedy: "only ratios of transmittances are formed, by differences of depths",
        file: "src/media/coefficients.rs",
        check: e7_weights_where_transmittance_underflows,
    },
    Row {
        id: "E8",
        what: "a homogeneous medium by any number of steps",
        tolerance: "1e-12 by the sum of depths, 1e-10 by the product",
        remedy: "the last step is as long as what is left; transparency is carried beside opacity",
        file: "src/render/classified/compositing.rs",
        check: e8_any_number_of_steps,
    },
    Row {
        id: "E9",
        what: "early termination, where it is asked for",
        tolerance: "the bias that the plan states",
        remedy: "off unless the scene asks for it, and then with a bound in the plan",
        file: "src/render/classified/compositing.rs",
        check: e9_early_termination,
    },
];

fn e1_very_thin_media(margin: &mut Margin) {
    for (depth, right) in [
        (1e-12, 9.999_999_999_995e-13),
        (1e-16, 1e-16),
        (1e-300, 1e-300),
    ] {
        margin.roundings(format_args!("depth {depth:e}"), opacity(depth), right, 4.0);
    }
}

fn e2_very_thick_media(margin: &mut Margin) {
    let right = 9.859_676_543_759_77e-305;
    margin.within("depth 700", transmittance(700.0), right, 1e-13 * right);
    margin.exact("depth 745", transmittance(745.0), f64::from_bits(1));
    margin.exact("depth 746", transmittance(746.0), 0.0);
    margin.exact("depth 10^6", transmittance(1e6), 0.0);
    let source = 0.7;
    for depth in [700.0, 745.0, 746.0, 1e6, f64::INFINITY] {
        margin.roundings(
            format_args!("source, depth {depth:e}"),
            constant_emission(source, 1.0, depth),
            source,
            2.0,
        );
    }
    // Seen by the renderer: a body in equilibrium with that source, before a sky of another.
    for sigma in [700.0, 745.0, 746.0, 1e6] {
        let body = in_box(unit_box(), emissive(grey(sigma, 0.0, 0.0), source));
        let seen = straight(&before_sky(vec![body]), &ray([0.5, 0.5, -1.0], DVec3::Z)).x;
        // σ_a times the source is rounded, and divided by σ_a again.
        margin.roundings(format_args!("seen, sigma {sigma:e}"), seen, source, 2.0);
    }
}

fn e3_source_factor(margin: &mut Margin) {
    margin.exact("depth 0", source_factor(0.0), 1.0);
    for (depth, right) in [
        (1e-12, 0.999_999_999_999_5),
        (1e-5, 0.999_995_000_016_666_6),
        (1.0, 0.632_120_558_828_557_7),
        (50.0, 0.02),
    ] {
        margin.roundings(
            format_args!("depth {depth:e}"),
            source_factor(depth),
            right,
            4.0,
        );
    }
}

fn e4_opacity_correction(margin: &mut Margin) {
    for (a, r, right) in [
        (1e-12, 0.1, 1.000_000_000_000_45e-13),
        (1e-16, 0.25, 2.5e-17),
        // 1 − 2^(−1e-9), to more digits than the catalogue's fifteen.
        (0.5, 1e-9, 6.931_471_803_197_189e-10),
    ] {
        margin.roundings(
            format_args!("a = {a:e}, r = {r:e}"),
            over_length(a, r),
            right,
            4.0,
        );
    }
    margin.exact("a = 1", over_length(1.0, 0.5), 1.0);
    margin.exact("a = 0", over_length(0.0, 0.5), 0.0);
}

fn e5_opaque_and_zero_times_infinity(margin: &mut Margin) {
    let behind_layer =
        |opacity: f64| FrontToBack::add(Layers::default(), DVec3::ZERO, opacity).transparency;
    margin.exact(
        "opaque, over no length",
        behind_layer(over_length(1.0, 0.0)),
        1.0,
    );
    margin.exact(
        "opaque, over some",
        behind_layer(over_length(1.0, 2.0)),
        0.0,
    );
    margin.exact(
        "nothing, without an end",
        transmittance(optical_depth(0.0, f64::INFINITY)),
        1.0,
    );
    margin.exact(
        "something, without an end",
        transmittance(optical_depth(1e-9, f64::INFINITY)),
        0.0,
    );
    margin.exact(
        "infinitely dense, over no length",
        transmittance(optical_depth(f64::INFINITY, 0.0)),
        1.0,
    );
    // By the renderer: media without a boundary.
    for (sigma, right) in [(0.0, 1.0), (1e-9, 0.0)] {
        let mut endless = in_box(unit_box(), grey(sigma, 0.0, 0.0));
        endless.boundary = None;
        let seen = straight(&before_sky(vec![endless]), &ray([0.5, 0.5, -1.0], DVec3::Z)).x;
        margin.exact(format_args!("all space of {sigma:e}"), seen, right);
    }
}

fn e6_free_flight_at_the_ends(margin: &mut Margin) {
    for sigma in [0.25, 1.0, 3.0] {
        margin.exact(
            format_args!("sigma {sigma}, u = 0"),
            free_flight(sigma, 0.0),
            0.0,
        );
        let right = 36.736_800_569_677_1 / sigma;
        margin.roundings(
            format_args!("sigma {sigma}, the last u"),
            free_flight(sigma, LAST),
            right,
            4.0,
        );
    }
    for (nothing, u) in [(0.0, 0.5), (-0.0, 0.0)] {
        margin.exact(
            "nothing to collide with",
            free_flight(nothing, u),
            f64::INFINITY,
        );
        let collides = optical_distance(u) < optical_depth(nothing, f64::INFINITY);
        margin.holds(format_args!("no collision, sigma {nothing:?}"), !collides);
    }
    margin.roundings(
        "sigma 1e-300",
        free_flight(1e-300, 0.5),
        6.931_471_805_599_453e299,
        4.0,
    );
    margin.exact(
        "the least sigma",
        free_flight(f64::from_bits(1), LAST),
        f64::INFINITY,
    );
}

fn e7_weights_where_transmittance_underflows(margin: &mut Margin) {
    let sigma = |sigma: f64| {
        Coefficients::new(DVec3::ZERO, DVec3::splat(sigma))
            .expect("a coefficient")
            .sigma_t()
    };
    for (sigma_t, depth) in [
        (sigma(1.0), 800.0),
        (sigma(800.0), 800.0),
        (sigma(1e-300), 1e5),
    ] {
        let depth = DVec3::splat(depth);
        let collided = collision_weight(DVec3::ONE, sigma_t, depth, DVec3::ONE);
        margin.exact(
            format_args!("collided at depth {}", depth.x),
            collided,
            DVec3::ONE,
        );
        let escaped = escape_weight(DVec3::ONE, depth, DVec3::ONE);
        margin.exact(
            format_args!("escaped from depth {}", depth.x),
            escaped,
            DVec3::ONE,
        );
    }
}

fn e8_any_number_of_steps(margin: &mut Margin) {
    let inside = Span {
        near: 0.5,
        far: 1.5,
    };
    for sigma in [0.1, 1.0, 10.0] {
        let right = transmittance(sigma);
        // The first is a step longer than the box; of 0.15 the last is shorter.
        for length in [3.0, 1.0, 0.5, 0.15, 1.0 / 7.0, 1e-3, 1e-6] {
            let steps = Steps::over(inside, length);
            let mut sum = Sum::default();
            let mut layers = Layers::default();
            for index in 0..steps.count() {
                let own = optical_depth(sigma, steps.sample(index).1);
                sum.add(own);
                layers = FrontToBack::add(layers, DVec3::ZERO, opacity(own));
            }
            let what = |how: &str| format!("sigma {sigma}, {} steps, by the {how}", steps.count());
            margin.within(
                what("sum"),
                transmittance(sum.value()),
                right,
                1e-12 * right,
            );
            margin.within(what("product"), layers.transparency, right, 1e-10 * right);
            let held = opacity(sigma);
            margin.within(
                what("product of opacities"),
                layers.opacity,
                held,
                1e-10 * held,
            );
        }
    }
}

fn e9_early_termination(margin: &mut Margin) {
    let (below, source) = (1e-3, 4.0);
    // Grey fog that lets e^(−1) through a unit, a bright red medium behind it, and a blue sky.
    let colour = |value: f64| {
        if value > 0.5 {
            DVec3::X * source
        } else {
            DVec3::splat(0.1)
        }
    };
    let points = [0.0, 0.5, 0.5, 1.0].into_iter().zip([0.0, 0.0, 1.0, 1.0]);
    let points = points.map(|(value, bright)| TransferPoint {
        value,
        colour: colour(bright),
        opacity: opacity(1.0),
    });
    let transfer_function = TransferFunction {
        appearance: Appearance::Points(TransferPoints::new(points.collect()).expect("a table")),
        reference_length: 1.0,
    };
    let volume = |compositing, fog: usize| {
        let layers = grid(
            [3, 3, 33],
            DVec3::ONE,
            |[.., k]| if k > fog { 1.0 } else { 0.25 },
        );
        Classified {
            compositing,
            background: DVec3::Z * 2.0,
            ..classified(layers, transfer_function.clone())
        }
    };
    for fog in [1, 3, 5, 6, 7, 8, 12] {
        let plan = |compositing| {
            let scene = scene_of(
                Model::Classified(Box::new(volume(compositing, fog))),
                [3, 3],
            );
            let approximations = Plan::new(&scene.panels[0]).approximations;
            (rendered(&scene), approximations)
        };
        let (Ok(whole), _) = plan(Compositing::FrontToBack) else {
            return margin.holds("the whole has a picture", false);
        };
        let (Ok(ended), approximations) = plan(Compositing::EarlyTermination(below)) else {
            return margin.holds("the rest has a picture", false);
        };
        let stated = approximations.first().map_or(0.0, |early| early.bias);
        margin.exact("stated bias", stated, below * source);
        let pixels = ended.film.radiance().iter().zip(whole.film.radiance());
        for (ended, whole) in pixels.flat_map(|(a, b)| a.iter().zip(b)) {
            margin.within(
                format_args!("behind {fog}"),
                (*ended).into(),
                (*whole).into(),
                stated,
            );
        }
        let saved = ended.work[0][Event::DensityLookup] < whole.work[0][Event::DensityLookup];
        margin.holds(format_args!("look-ups are saved behind {fog}"), saved);
    }
    // Not asked for, nothing is left out.
    let all = scene_of(
        Model::Classified(Box::new(volume(Compositing::FrontToBack, 8))),
        [3, 3],
    );
    margin.exact(
        "not asked for",
        Plan::new(&all.panels[0]).approximations.len(),
        0,
    );
}
