//! Work of the ray caster.

/// Work of a ray and of the shadow rays of its samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayWork {
    /// Densities read from the grid, those of shadow rays and of differences included.
    pub density_lookups: u64,
    /// Stored gradients interpolated.
    pub gradient_lookups: u64,
    /// Samples with an opacity.
    pub attenuations: u64,
    /// Samples that emit light: with an opacity over their step.
    pub emission_terms: u64,
    /// Rays towards the light.
    pub shadow_rays: u64,
    /// Random numbers.
    pub random_draws: u64,
}

impl RayWork {
    /// Number of all of these.
    pub fn total(self) -> u64 {
        let of_density = self.density_lookups + self.gradient_lookups;
        let of_samples = self.attenuations + self.emission_terms;
        of_density + of_samples + self.shadow_rays + self.random_draws
    }
}
