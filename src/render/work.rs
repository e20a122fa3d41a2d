//! Counting work, compiled in only when asked for.

use serde::Serialize;

/// Units of work a kernel can count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// Density of a field at a point.
    DensityLookup,
    /// Stored gradient at a point.
    GradientLookup,
    /// Gradient of a node, computed to be stored.
    GradientComputed,
    /// A cell or block of a grid asked whether it is empty.
    CellWalked,
    /// A ray towards a light, to see how much of it arrives.
    ShadowRay,
    /// Value of a phase function.
    PhaseEvaluation,
    /// A tentative collision of a flight with no matter.
    NullCollision,
    /// A ray tested against a surface.
    SurfaceTest,
    /// A random number.
    RandomDraw,
}

/// Something that is told of every unit of work. Kernels are compiled once for each
/// implementation: told to [`Uncounted`], they count nothing and spend nothing on it.
pub trait Work: Clone + Default + Send {
    /// That many units of work were done.
    fn count_times(&mut self, event: Event, times: u64);

    /// One unit of work was done.
    fn count(&mut self, event: Event) {
        self.count_times(event, 1);
    }

    /// The numbers of another row of pixels.
    fn add(&mut self, other: &Self);
}

/// No counting.
#[derive(Clone, Copy, Debug, Default)]
pub struct Uncounted;

impl Work for Uncounted {
    fn count_times(&mut self, _: Event, _: u64) {}
    fn add(&mut self, _: &Self) {}
}

/// How often each unit of work was done. The same on every run, for any number of threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counters {
    /// Densities looked up in a grid, shadow rays included.
    pub density_lookups: u64,
    /// Gradients looked up in a grid.
    pub gradient_lookups: u64,
    /// Gradients computed for the nodes of a grid.
    pub gradients_computed: u64,
    /// Blocks of a grid asked whether they are empty.
    pub cells_walked: u64,
    /// Rays towards a light, to see how much of it arrives.
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
    fn count_times(&mut self, event: Event, times: u64) {
        let counter = match event {
            Event::DensityLookup => &mut self.density_lookups,
            Event::GradientLookup => &mut self.gradient_lookups,
            Event::GradientComputed => &mut self.gradients_computed,
            Event::CellWalked => &mut self.cells_walked,
            Event::ShadowRay => &mut self.shadow_rays,
            Event::PhaseEvaluation => &mut self.phase_evaluations,
            Event::NullCollision => &mut self.null_collisions,
            Event::SurfaceTest => &mut self.surface_tests,
            Event::RandomDraw => &mut self.random_draws,
        };
        *counter += times;
    }

    fn add(&mut self, other: &Counters) {
        self.density_lookups += other.density_lookups;
        self.gradient_lookups += other.gradient_lookups;
        self.gradients_computed += other.gradients_computed;
        self.cells_walked += other.cells_walked;
        self.shadow_rays += other.shadow_rays;
        self.phase_evaluations += other.phase_evaluations;
        self.null_collisions += other.null_collisions;
        self.surface_tests += other.surface_tests;
        self.random_draws += other.random_draws;
    }
}
