//! Shading of samples by the gradient of the density.
//!
//! Source: Phong 1975, "Illumination for computer generated pictures"; Levoy 1988.

use super::field::ScalarField;
use crate::geometry::{Direction, Ray};
use crate::optics::Phong;
use crate::render::counters::Work;
use crate::volume::Grid;
use glam::DVec3;

/// Shading of samples.
pub trait Shading: Sync {
    /// The colour of a sample at world `point` and the `location` of this index in the field, of unshaded `colour`, as
    /// seen along `ray`.
    fn shade<F: ScalarField, const N: usize, W: Work>(
        &self,
        colour: DVec3,
        field: &F,
        location: (&F::Locations<N>, usize),
        point: DVec3,
        ray: &Ray,
        work: &mut W,
    ) -> DVec3;
}

/// No shading: the colour as it is, without a gradient lookup.
#[derive(Clone, Copy, Debug)]
pub struct Unshaded;

impl Shading for Unshaded {
    fn shade<F: ScalarField, const N: usize, W: Work>(
        &self,
        colour: DVec3,
        _: &F,
        _: (&F::Locations<N>, usize),
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
    /// Gradients at the nodes, of the world, in any unit: only directions matter.
    pub gradients: Grid<[f32; 3]>,
    /// World position of the light.
    pub light: DVec3,
}

impl Shading for Shaded {
    // Always: a call takes a twentieth of figure 3.
    #[inline(always)]
    fn shade<F: ScalarField, const N: usize, W: Work>(
        &self,
        colour: DVec3,
        field: &F,
        location: (&F::Locations<N>, usize),
        point: DVec3,
        ray: &Ray,
        work: &mut W,
    ) -> DVec3 {
        let (locations, index) = location;
        let gradient = field.gradient(&self.gradients, locations, index, work);
        let to_light = Direction::of(self.light - point);
        self.phong.shade(colour, gradient, to_light, -ray.direction)
    }
}
