//! E: exponentials and opacity.

use super::margin::Margin;
use super::scenes::*;
use crate::geometry::Span;
use crate::math::Sum;
use crate::optics::Layer;
use crate::optics::{opacity, optical_depth, transmittance};
use crate::render::classified::steps::Steps;
use crate::render::{Event, Plan};
use crate::scene::{Classified, Compositing};
use glam::DVec3;

#[test]
fn e5_media_without_a_boundary() {
    let margin = &Margin;
    for (sigma, right) in [(0.0, 1.0), (1e-9, 0.0)] {
        let mut endless = in_box(unit_box(), grey(sigma, 0.0, 0.0));
        endless.boundary = None;
        let seen = straight(&before_sky(vec![endless]), &middle()).x;
        margin.exact(format_args!("all space of {sigma:e}"), seen, right);
    }
}

#[test]
fn e8_any_number_of_steps() {
    let margin = &Margin;
    for sigma in [0.1, 1.0, 10.0] {
        // The first is a step longer than the box; of 0.15 the last is shorter.
        for length in [3.0, 1.0, 0.5, 0.15, 1.0 / 7.0, 1e-3, 1e-6] {
            let steps = Steps::over(Span::new(0.5, 1.5), length);
            let mut sum = Sum::default();
            let mut layers = Layer::EMPTY;
            for index in 0..steps.count() {
                let own = optical_depth(sigma, steps.sample(index).1);
                sum.add(own);
                layers = layers.over(Layer::sample(DVec3::ZERO, opacity(own)));
            }
            let (through, held) = (transmittance(sigma), opacity(sigma));
            for (how, found, right, share) in [
                ("sum", transmittance(sum.value()), through, 1e-12),
                ("product", layers.transparency, through, 1e-10),
                ("product of opacities", layers.opacity, held, 1e-10),
            ] {
                let what = format!("sigma {sigma}, {} steps, by the {how}", steps.count());
                margin.relative(what, found, right, share);
            }
        }
    }
}

#[test]
fn e9_early_termination() {
    let margin = &Margin;
    let (below, source) = (1e-3, 4.0);
    // Grey fog that lets e^(−1) through a unit, a bright red medium behind it, and a blue sky.
    let (fog, bright) = (DVec3::splat(0.1), DVec3::X * source);
    let points = [(0.0, fog), (0.5, fog), (0.5, bright), (1.0, bright)];
    let points = points.map(|(value, colour)| point(value, opacity(1.0), colour));
    let transfer_function = table(points.into(), 1.0);
    let volume = |compositing, fog: usize| {
        let layers = grid(
            [3, 3, 33],
            DVec3::ONE,
            |[.., k]| if k > fog { 1.0 } else { 0.25 },
        );
        let volume = Classified {
            compositing,
            background: DVec3::Z * 2.0,
            ..classified(layers, transfer_function.clone())
        };
        scene_of(volume, [3, 3])
    };
    for fog in [1, 3, 5, 6, 7, 8, 12] {
        let early = volume(Compositing::EarlyTermination(below), fog);
        let whole = rendered(&volume(Compositing::FrontToBack, fog));
        let (Ok(whole), Ok(ended)) = (whole, rendered(&early)) else {
            return margin.holds("both have a picture", false);
        };
        let approximations = Plan::new(&early.panels[0]).approximations;
        let stated = approximations.first().map_or(0.0, |early| early.bias);
        margin.exact("stated bias", stated, below * source);
        let pixels = ended.film.radiance().iter().zip(whole.film.radiance());
        for (&ended, &whole) in pixels.flat_map(|(a, b)| a.iter().zip(b)) {
            let what = format_args!("behind {fog}");
            margin.within(what, ended.into(), whole.into(), stated);
        }
        let saved = ended.work[0][Event::DensityLookup] < whole.work[0][Event::DensityLookup];
        margin.holds(format_args!("lookups are saved behind {fog}"), saved);
    }
    // Not asked for, nothing is left out.
    let all = volume(Compositing::FrontToBack, 8);
    let approximations = Plan::new(&all.panels[0]).approximations;
    margin.exact("not asked for", approximations.len(), 0);
}
