//! A smaller image of a scene, of the same shape, since costs are per pixel.

use crate::scene::{Model, Panel};

/// `panel` with another `model`, its larger side at most `most` pixels.
pub(super) fn thumbnail(panel: &Panel, model: Model, most: usize) -> Panel {
    let larger = panel.width.max(panel.height);
    let most = most.min(larger);
    let size = [panel.width, panel.height].map(|side| (side * most).div_ceil(larger).max(1));
    Panel::of(model, size)
}
