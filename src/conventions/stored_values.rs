//! Values as a renderer stores them: in fewer bits than those of the grid.

use crate::scene::{Classified, StoredValues};
use crate::volume::Grid;
use half::f16;
use std::borrow::Cow;
use std::sync::Arc;

/// `scene` with the values that its conventions store.
///
/// Whole numbers of b bits stand for the range of the volume: n for low + n (high − low)/(2ᵇ − 1), the nearest.
pub fn as_stored(scene: &Classified) -> Cow<'_, Classified> {
    let (low, high) = scene.grid.range();
    let in_whole_numbers = |most: f64| {
        let unit = (high - low) / most;
        move |value: f64| match unit > 0.0 {
            true => low + ((value - low) / unit).round() * unit,
            false => value,
        }
    };
    let stored = match scene.conventions.stored_values {
        StoredValues::F32 => return Cow::Borrowed(scene),
        StoredValues::F16 => with(scene, |value| {
            let most = f64::from(f16::MAX);
            f16::from_f64(value.clamp(-most, most)).into()
        }),
        StoredValues::U16 => with(scene, in_whole_numbers(65535.0)),
        StoredValues::U8 => with(scene, in_whole_numbers(255.0)),
    };
    Cow::Owned(stored)
}

fn with(scene: &Classified, rounded: impl Fn(f64) -> f64) -> Classified {
    let values = scene.grid.values().iter();
    let values = values.map(|&value| rounded(value.into()) as f32).collect();
    let grid = Grid::new(*scene.grid.lattice(), values).expect("a value for each node");
    Classified {
        grid: Arc::new(grid),
        ..scene.clone()
    }
}
