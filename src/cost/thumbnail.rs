//! A smaller image of a scene, of the same shape, since costs are per pixel.

use crate::scene::{Model, Panel, Scene};

/// The size of a smaller image of the same shape, its larger side `most` pixels.
pub fn thumbnail([width, height]: [usize; 2], most: usize) -> [usize; 2] {
    let larger = width.max(height);
    if larger <= most {
        return [width, height];
    }
    [width, height].map(|side| (side * most).div_ceil(larger).max(1))
}

/// `panel` with another `model` as a scene of its own, of at most `most` pixels a side.
pub fn scene(panel: &Panel, model: Model, most: usize) -> Scene {
    Scene::of(Panel::of(
        model,
        thumbnail([panel.width, panel.height], most),
    ))
}
