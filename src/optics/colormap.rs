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
        "heat",
        "grey",
        "display-grey",
        "bone",
        "white",
        "viridis",
        "magma",
        "inferno",
        "plasma",
        "turbo",
    ];

    /// The map of that name: `heat` (blue, cyan, green, yellow, red), `grey` (black to white),
    /// `display-grey` (the same as codes of sRGB, as most viewers show values), `bone` (brown to ivory, for scans),
    /// `white` (constant), or one of the perceptual maps. The latter are published as display colours; they are
    /// decoded to linear light, so that a preview shows them as published.
    pub fn named(name: &str) -> Option<Colormap> {
        let stops = match name {
            "heat" => {
                let [cyan, yellow] = [DVec3::new(0.0, 1.0, 1.0), DVec3::new(1.0, 1.0, 0.0)];
                vec![DVec3::Z, cyan, DVec3::Y, yellow, DVec3::X]
            }
            "grey" => vec![DVec3::ZERO, DVec3::ONE],
            "display-grey" => decoded(|i| [i; 3]),
            "bone" => BONE.map(in_linear_light).to_vec(),
            "white" => vec![DVec3::ONE],
            "viridis" => published(colorous::VIRIDIS),
            "magma" => published(colorous::MAGMA),
            "inferno" => published(colorous::INFERNO),
            "plasma" => published(colorous::PLASMA),
            "turbo" => published(colorous::TURBO),
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
fn published(gradient: colorous::Gradient) -> Vec<DVec3> {
    decoded(|i| {
        let colour = gradient.eval_rational(i.into(), 256);
        [colour.r, colour.g, colour.b]
    })
}

/// 256 colours of sRGB in linear light.
fn decoded(codes: impl Fn(u8) -> [u8; 3]) -> Vec<DVec3> {
    (0..=u8::MAX).map(|i| in_linear_light(codes(i))).collect()
}

/// Codes of sRGB in linear light.
fn in_linear_light(codes: [u8; 3]) -> DVec3 {
    DVec3::from_array(codes.map(|code| math::srgb_to_linear(f64::from(code) / 255.0)))
}

/// Codes of sRGB of the map `bone`.
const BONE: [[u8; 3]; 5] = [
    [28, 16, 20],
    [107, 64, 53],
    [183, 117, 84],
    [230, 186, 144],
    [255, 250, 240],
];

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
    fn display_grey_is_the_code_of_the_display() {
        let grey = Colormap::named("display-grey").unwrap();
        for code in [0.0, 1.0, 50.0, 128.0, 255.0] {
            let code: f64 = code / 255.0;
            let expected = math::srgb_to_linear(code);
            assert!((grey.at(code).x - expected).abs() <= 2.0 * f64::EPSILON);
        }
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
