//! Rows known in numbers, as the catalogue holds them: values of functions, and spans in a box.

use super::margin::{Margin, U};
use super::scenes::{ray, unit_box};
use crate::math::sampling::{free_flight, optical_distance};
use crate::optics::Layer;
use crate::optics::emission::constant_emission;
use crate::optics::{
    Asymmetry, Coefficients, HenyeyGreenstein, collision_weight, escape_weight, opacity,
    optical_depth, over_length, source_factor, transmittance,
};
use glam::DVec3;
use serde::Deserialize;

/// Values of a function.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// The function.
    of: String,
    /// Roundings by which a value may be off.
    #[serde(default)]
    roundings: f64,
    /// Relative error by which a value may be off.
    #[serde(default)]
    relative: f64,
    /// Each line: the arguments, then the values.
    known: Vec<Vec<f64>>,
}

impl Table {
    /// Compares all values with those of the code that renders.
    pub fn compare(&self, margin: &Margin) {
        for line in &self.known {
            for [found, right] in self.found_and_right(line) {
                let what = format_args!("{} of {line:?}", self.of);
                let share = self.relative + self.roundings * U;
                margin.relative(what, found, right, share);
            }
        }
    }

    /// The values found at the arguments of `line`, each with the right one; a line of the wrong
    /// length has none that is a number.
    fn found_and_right(&self, line: &[f64]) -> Vec<[f64; 2]> {
        match (self.of.as_str(), line) {
            ("opacity", &[depth, right]) => vec![[opacity(depth), right]],
            ("transmittance", &[depth, right]) => vec![[transmittance(depth), right]],
            ("source factor", &[depth, right]) => vec![[source_factor(depth), right]],
            ("opacity over a length", &[opacity, length, right]) => {
                vec![[over_length(opacity, length), right]]
            }
            ("transparency behind a layer", &[opacity, length, right]) => {
                let opacity = over_length(opacity, length);
                let layers = Layer::EMPTY.over(Layer::sample(DVec3::ZERO, opacity));
                vec![[layers.transparency, right]]
            }
            ("transmittance over a length", &[sigma, length, right]) => {
                vec![[transmittance(optical_depth(sigma, length)), right]]
            }
            ("free flight", &[sigma, u, right]) => vec![[free_flight(sigma, u), right]],
            ("collisions without an end", &[sigma, u, right]) => {
                let collides = optical_distance(u) < optical_depth(sigma, f64::INFINITY);
                vec![[f64::from(u8::from(collides)), right]]
            }
            ("radiance of a source", &[source, depth, right]) => {
                vec![[constant_emission(source, 1.0, depth), right]]
            }
            ("weight of a collision", &[sigma, depth, right]) => {
                let medium = Coefficients::new(DVec3::ZERO, DVec3::splat(sigma));
                let sigma_t = medium.map_or(DVec3::NAN, |medium| medium.sigma_t());
                let depth = DVec3::splat(depth);
                let weight = collision_weight(DVec3::ONE, sigma_t, depth, DVec3::ONE);
                weight.to_array().map(|found| [found, right]).into()
            }
            ("weight of an escape", &[depth, right]) => {
                let weight = escape_weight(DVec3::ONE, DVec3::splat(depth), DVec3::ONE);
                weight.to_array().map(|found| [found, right]).into()
            }
            ("distances of a Henyey-Greenstein cosine from 1 and -1", &[g, u, minus, plus]) => {
                let found = henyey_greenstein(g).deflection(u);
                vec![[found.one_minus_cos, minus], [found.one_plus_cos, plus]]
            }
            _ => vec![[f64::NAN; 2]],
        }
    }
}

pub fn henyey_greenstein(g: f64) -> HenyeyGreenstein {
    HenyeyGreenstein(Asymmetry::new(g).expect("within ±1"))
}

/// A ray, and from where to where it is inside the box from 0 to 1.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpanInBox {
    from: [f64; 3],
    along: [f64; 3],
    /// Both ends; empty for a miss.
    inside: Vec<f64>,
}

impl SpanInBox {
    /// Compares the span with that of the code that renders.
    pub fn compare(&self, margin: &Margin) {
        let found = unit_box().span(&ray(self.from, self.along));
        let found = found.map_or(vec![], |span| vec![span.near, span.far]);
        let what = format_args!("from {:?} along {:?}", self.from, self.along);
        margin.exact(what, &found, &self.inside);
    }
}
