//! Mistakes about densities: grids and noise.

use super::grids::{GridValues, mapped};
use super::{Edit, Mistake, any, replaced};
use crate::optics::Field;
use crate::scene::Radiative;
use crate::volume::{FractalDensity, FractalParameters, GridDensity, Interpolation};

pub(super) const MISTAKES: &[Mistake] = mistakes! {
    "interpolation-nearest" => Radiative(|scene| {
        grids(scene, |grid, old| (old == Interpolation::Trilinear).then(|| (grid.clone(), Interpolation::Nearest)))
    }),
        "densities are those of the nearest node: interpolate between the eight nodes around the sample";
    "density-uniform" => Radiative(|scene| any(&mut scene.media, |body| body.density.take().is_some())),
        "the density is the same everywhere: look it up at each place and multiply the coefficients by it";
    "density-squared" => MediumGrids(|grid| mapped(grid, |value| value * value)),
        "the density counts twice: it multiplies the coefficients once";
    "noise-of-one-octave" => Radiative(|scene| noises(scene, |noise| noise.octaves = 1)),
        "the noise has one octave only: the sum runs over all of them, each of another frequency and amplitude";
    "noise-gain-from-lacunarity" => Radiative(|scene| noises(scene, |noise| noise.gain = 1.0 / noise.lacunarity)),
        "the weights of octaves are 1 / lacunarity in place of gain: both are given";
    "noise-lacunarity-two" => Radiative(|scene| noises(scene, |noise| noise.lacunarity = 2.0)),
        "frequencies of octaves double: they grow by the lacunarity that is given";
    "noise-scale-inverted" => Radiative(|scene| noises(scene, |noise| noise.scale = noise.scale.recip())),
        "the noise is stretched where it should be squeezed: places are multiplied by the scale, not divided";
    "noise-threshold-left-out" => Radiative(|scene| noises(scene, |noise| noise.threshold = 0.0)),
        "the noise is not cut: densities up to the threshold count as 0";
    "noise-half-a-cell-off" => Radiative(|scene| noises(scene, |noise| noise.offset += 0.5)),
        "the noise is shifted by half a cell: its lattice points lie at whole numbers";
};

/// Edits the grids of media; whether any changed.
pub(super) fn grids(
    scene: &mut Radiative,
    edit: impl Fn(&GridValues, Interpolation) -> Option<(GridValues, Interpolation)>,
) -> bool {
    with_fields(scene, |field| {
        let Field::Grid(field) = field else {
            return None;
        };
        let (grid, interpolation) = edit(field.grid(), field.interpolation())?;
        Some(Field::Grid(GridDensity::new(grid, interpolation)))
    })
}

fn noises(scene: &mut Radiative, edit: fn(&mut FractalParameters)) -> bool {
    with_fields(scene, |field| {
        let Field::Noise(noise) = field else {
            return None;
        };
        let mut parameters = *noise.parameters();
        edit(&mut parameters);
        let is_new = parameters != *noise.parameters() && parameters.scale.is_finite();
        let noise = is_new.then(|| FractalDensity::new(parameters).ok());
        noise.flatten().map(Field::Noise)
    })
}

/// Gives media other fields of density where `other` has one; whether it has any.
fn with_fields(scene: &mut Radiative, other: impl Fn(&Field) -> Option<Field>) -> bool {
    let densities = scene.media.iter_mut().flat_map(|body| &mut body.density);
    any(densities, |density| {
        let new = other(density.field()).map(|field| density.with_field(field));
        replaced(density, new)
    })
}
