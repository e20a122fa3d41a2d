//! Colours for densities.

use crate::math;
use crate::volume::Lerp;
use glam::DVec3;

/// A named table of linear RGB colours, evenly spaced over densities 0 to 1 and joined by
/// straight lines. Densities outside take the colour of the nearer end.
#[derive(Clone, Debug, PartialEq)]
pub struct Colormap {
    stops: Vec<DVec3>,
}

impl Colormap {
    /// Every name [`Colormap::named`] knows.
    pub const NAMES: &[&str] = &[
        "heat", "grey", "white", "viridis", "magma", "inferno", "plasma", "turbo",
    ];

    /// The map of that name: `heat` (blue, cyan, green, yellow, red), `grey` (black to white),
    /// `white` (constant), or one of the perceptual maps. The latter are published as display
    /// colours; they are decoded to linear light, so that a preview shows them as published.
    pub fn named(name: &str) -> Option<Colormap> {
        let stops = match name {
            "heat" => {
                let [cyan, yellow] = [DVec3::new(0.0, 1.0, 1.0), DVec3::new(1.0, 1.0, 0.0)];
                vec![DVec3::Z, cyan, DVec3::Y, yellow, DVec3::X]
            }
            "grey" => vec![DVec3::ZERO, DVec3::ONE],
            "white" => vec![DVec3::ONE],
            "viridis" => decoded(colorous::VIRIDIS),
            "magma" => decoded(colorous::MAGMA),
            "inferno" => decoded(colorous::INFERNO),
            "plasma" => decoded(colorous::PLASMA),
            "turbo" => decoded(colorous::TURBO),
            _ => return None,
        };
        Some(Colormap { stops })
    }

    /// The same colours in reverse.
    pub fn reversed(&self) -> Colormap {
        let stops = self.stops.iter().rev().copied().collect();
        Colormap { stops }
    }

    /// The colours, evenly spaced over densities 0 to 1; a single one holds everywhere.
    pub fn stops(&self) -> &[DVec3] {
        &self.stops
    }

    /// Colour at `density ≥ 0`.
    // Always: asked once a sample, a call would be no small part of its cost.
    #[inline(always)]
    pub fn at(&self, density: f64) -> DVec3 {
        let last = self.stops.len() - 1;
        let position = density.min(1.0) * last as f64;
        let index = position as usize;
        let next = (index + 1).min(last);
        DVec3::lerp_between(self.stops[index], self.stops[next], position - index as f64)
    }
}

/// Published display colours in linear light.
fn decoded(gradient: colorous::Gradient) -> Vec<DVec3> {
    let decode = |code: u8| math::srgb_to_linear(f64::from(code) / 255.0);
    let colours = (0..256).map(|i| gradient.eval_rational(i, 256));
    colours
        .map(|c| DVec3::new(decode(c.r), decode(c.g), decode(c.b)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heat_passes_through_its_stops() {
        let heat = Colormap::named("heat").unwrap();
        assert_eq!(heat.at(0.0), DVec3::new(0.0, 0.0, 1.0));
        assert_eq!(heat.at(0.25), DVec3::new(0.0, 1.0, 1.0));
        assert_eq!(heat.at(0.625), DVec3::new(0.5, 1.0, 0.0));
        assert_eq!(heat.at(1.0), DVec3::new(1.0, 0.0, 0.0));
        assert_eq!(heat.at(7.0), DVec3::new(1.0, 0.0, 0.0));
    }

    #[test]
    fn every_name_is_known_and_stays_in_gamut() {
        for name in Colormap::NAMES {
            let map = Colormap::named(name).unwrap();
            for i in 0..=1000 {
                let colour = map.at(f64::from(i) / 1000.0);
                assert!(
                    colour.min_element() >= 0.0 && colour.max_element() <= 1.0,
                    "{name}"
                );
            }
        }
        assert_eq!(Colormap::named("rainbow"), None);
    }
}
