//! Mixtures: several media at one place.

use crate::optics::{Homogeneous, Phase, albedo};
use glam::DVec3;

/// Homogeneous media that add up.
pub(super) struct Mixture {
    /// Absorption by channel.
    pub sigma_a: DVec3,
    /// Scattering by channel.
    pub sigma_s: DVec3,
    /// Radiance emitted per length, by channel.
    pub emission: DVec3,
    /// Scattering by channel, by phase function.
    pub parts: Vec<(Phase, DVec3)>,
}

impl Mixture {
    /// All `layers` together.
    pub(super) fn of<'m>(layers: impl Iterator<Item = &'m Homogeneous>) -> Mixture {
        let mut mixture = Mixture {
            sigma_a: DVec3::ZERO,
            sigma_s: DVec3::ZERO,
            emission: DVec3::ZERO,
            parts: Vec::new(),
        };
        for layer in layers {
            let coefficients = &layer.coefficients;
            let scattering = coefficients.sigma_s();
            mixture.sigma_a += coefficients.sigma_a();
            mixture.sigma_s += scattering;
            mixture.emission += layer.emission;
            if scattering == DVec3::ZERO {
                continue;
            }
            let phase = layer.phase;
            match mixture.parts.iter_mut().find(|(other, _)| *other == phase) {
                Some((_, sum)) => *sum += scattering,
                None => mixture.parts.push((phase, scattering)),
            }
        }
        mixture
    }

    /// Extinction by channel.
    pub(super) fn sigma_t(&self) -> DVec3 {
        self.sigma_a + self.sigma_s
    }

    /// The share of extinction that scatters, by channel; 0 where there is no extinction.
    pub(super) fn albedo(&self) -> DVec3 {
        albedo(self.sigma_s, self.sigma_t())
    }

    /// The share of every part in the scattering of a channel; all 0 where nothing scatters.
    pub(super) fn weights_of(&self, channel: usize) -> Vec<f64> {
        let all = self.sigma_s[channel];
        let share = |part: &DVec3| if all > 0.0 { part[channel] / all } else { 0.0 };
        self.parts.iter().map(|(_, part)| share(part)).collect()
    }

    /// The shares, if they are those of every channel in which anything scatters: to the
    /// accuracy of the 32-bit numbers that they become.
    pub(super) fn weights(&self) -> Option<Vec<f64>> {
        let mut channels = (0..3).filter(|&channel| self.sigma_s[channel] > 0.0);
        let Some(first) = channels.next() else {
            return Some(Vec::new());
        };
        let weights = self.weights_of(first);
        let alike = |channel: usize| {
            let others = self.weights_of(channel);
            let mut pairs = weights.iter().zip(others);
            pairs.all(|(one, other)| (one - other).abs() <= f64::from(f32::EPSILON))
        };
        channels.all(alike).then_some(weights)
    }
}
