//! Shading of samples by the gradient of the density.
//!
//! Source: Phong 1975, "Illumination for computer generated pictures"; Levoy 1988.

use super::field::ScalarField;
use crate::geometry::{Direction, Ray};
use crate::media::Phong;
use crate::render::counters::Work;
use crate::volume::Grid;
use glam::DVec3;

/// Shading of samples.
pub trait Shading: Sync {
    /// The part of the location of a sample that is needed.
    type Location<F: ScalarField>;

    /// That part of `location`.
    fn location<F: ScalarField>(location: F::Location) -> Self::Location<F>;

    /// The colour of a sample at world `point`, of unshaded `colour`, as seen along `ray`.
    fn shade<F: ScalarField, W: Work>(
        &self,
        colour: DVec3,
        field: &F,
        location: &Self::Location<F>,
        point: DVec3,
        ray: &Ray,
        work: &mut W,
    ) -> DVec3;
}

/// No shading: the colour as it is, without a gradient lookup.
#[derive(Clone, Copy, Debug)]
pub struct Unshaded;

impl Shading for Unshaded {
    type Location<F: ScalarField> = ();

    fn location<F: ScalarField>(_: F::Location) {}

    fn shade<F: ScalarField, W: Work>(
        &self,
        colour: DVec3,
        _: &F,
        (): &(),
        _: DVec3,
        _: &Ray,
        _: &mut W,
    ) -> DVec3 {
        colour
    }
}

/// Phong shading by stored gradients.
#[derive(Clone, Debug)]
pub struct Shaded {
    /// Weights of the reflection model.
    pub phong: Phong,
    /// Gradients at the nodes, in any unit: only directions matter.
    pub gradients: Grid<[f32; 3]>,
    /// World position of the light.
    pub light: DVec3,
}

impl Shading for Shaded {
    type Location<F: ScalarField> = F::Location;

    #[inline(always)]
    fn location<F: ScalarField>(location: F::Location) -> F::Location {
        location
    }

    #[inline]
    fn shade<F: ScalarField, W: Work>(
        &self,
        colour: DVec3,
        field: &F,
        location: &F::Location,
        point: DVec3,
        ray: &Ray,
        work: &mut W,
    ) -> DVec3 {
        let gradient = field.gradient(&self.gradients, location, work);
        let to_light = Direction::of(self.light - point);
        self.phong.shade(colour, gradient, to_light, -ray.direction)
    }
}
