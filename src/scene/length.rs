//! Lengths of a scene file.

use std::fmt::Display;

/// A length in a scene: absolute, or relative to the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// World units.
    World(f64),
    /// Multiples of the shortest edge of a cell of the grid in the world, however a map shears it; without a
    /// map that is the smallest node spacing.
    Voxels(f64),
}

impl Length {
    /// The length in world units, for a voxel of `voxel` world units. Fails if the product leaves
    /// the range of positive finite numbers.
    pub(crate) fn in_world_units(self, voxel: f64) -> Result<f64, String> {
        let length = match self {
            Length::World(length) => length,
            Length::Voxels(count) => count * voxel,
        };
        if length.is_finite() && length > 0.0 {
            Ok(length)
        } else {
            Err(format!(
                "{self} of {voxel:e} world units each is not a positive finite length"
            ))
        }
    }
}

impl std::str::FromStr for Length {
    type Err = String;

    /// `"0.01"` (world units), `"0.5 voxels"`, `"1 voxel"`; positive and finite.
    fn from_str(text: &str) -> Result<Length, String> {
        let trimmed = text.trim();
        let in_voxels = trimmed
            .strip_suffix("voxels")
            .or_else(|| trimmed.strip_suffix("voxel"));
        let number = in_voxels.unwrap_or(trimmed).trim();
        let value = number
            .parse()
            .ok()
            .filter(|it: &f64| it.is_finite() && *it > 0.0);
        let value = value.ok_or_else(|| {
            format!("expected a positive length such as 0.01 (world units) or \"0.5 voxels\", got {text:?}")
        })?;
        Ok(if in_voxels.is_some() {
            Length::Voxels(value)
        } else {
            Length::World(value)
        })
    }
}

impl Display for Length {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Length::World(length) => write!(f, "{length}"),
            Length::Voxels(1.0) => write!(f, "\"1 voxel\""),
            Length::Voxels(count) => write!(f, "\"{count} voxels\""),
        }
    }
}
