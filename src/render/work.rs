//! Counting work, compiled in only when asked for.

use serde::Serialize;

/// Units of work a kernel can count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// Density of a field at a point.
    DensityLookup,
    /// Stored gradient at a point.
    GradientLookup,
    /// A cell or block of a grid asked whether it is empty.
    CellWalked,
    /// A ray towards a light through the volume.
    ShadowRay,
}

/// Something that is told of every unit of work. Kernels are compiled once for each
/// implementation: told to [`Uncounted`], they count nothing and spend nothing on it.
pub trait Work: Clone + Default + Send {
    /// One unit of work was done.
    fn count(&mut self, event: Event);

    /// The numbers of another row of pixels.
    fn add(&mut self, other: &Self);
}

/// No counting.
#[derive(Clone, Copy, Debug, Default)]
pub struct Uncounted;

impl Work for Uncounted {
    fn count(&mut self, _: Event) {}
    fn add(&mut self, _: &Self) {}
}

/// How often each unit of work was done. The same on every run, for any number of threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counters {
    /// Densities looked up in a grid, shadow rays included.
    pub density_lookups: u64,
    /// Gradients looked up in a grid.
    pub gradient_lookups: u64,
    /// Blocks of a grid asked whether they are empty.
    pub cells_walked: u64,
    /// Rays towards a light through the volume.
    pub shadow_rays: u64,
    /// Values of a phase function.
    pub phase_evaluations: u64,
    /// Collisions of a tracking method with no matter.
    pub null_collisions: u64,
    /// Rays tested against a surface.
    pub surface_tests: u64,
    /// Random numbers drawn.
    pub random_draws: u64,
}

impl Work for Counters {
    fn count(&mut self, event: Event) {
        match event {
            Event::DensityLookup => self.density_lookups += 1,
            Event::GradientLookup => self.gradient_lookups += 1,
            Event::CellWalked => self.cells_walked += 1,
            Event::ShadowRay => self.shadow_rays += 1,
        }
    }

    fn add(&mut self, other: &Counters) {
        self.density_lookups += other.density_lookups;
        self.gradient_lookups += other.gradient_lookups;
        self.cells_walked += other.cells_walked;
        self.shadow_rays += other.shadow_rays;
        self.phase_evaluations += other.phase_evaluations;
        self.null_collisions += other.null_collisions;
        self.surface_tests += other.surface_tests;
        self.random_draws += other.random_draws;
    }
}
