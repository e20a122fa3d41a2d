//! Pixels at the silhouette of a volume's box.

use crate::compare::around;
use crate::geometry::{Surface as _, length_of};
use crate::optics::Field;
use crate::scene::{Model, Panel, Scene};
use crate::volume::PlacedBox;

/// Largest width of the border, in pixels.
const WIDEST: f64 = 8.0;

/// The pixels, row by row, as near to the silhouette of the only volume of `scene` as half a voxel looks at its centre;
/// nothing of several panels or volumes, and of what has no voxels.
pub(super) fn silhouette(scene: &Scene) -> Option<Vec<bool>> {
    let [panel] = &scene.panels[..] else {
        return None;
    };
    let Panel { width, height, .. } = *panel;
    let (camera, extent, voxel): (_, PlacedBox, f64) = match &panel.model {
        Model::Classified(volume) if !volume.has_objects() => {
            (&volume.camera, volume.extent(), volume.voxel())
        }
        Model::Radiative(scene) => {
            let mut grids = scene.media.iter().filter_map(|body| {
                let Field::Grid(grid) = body.density.as_ref()?.field() else {
                    return None;
                };
                let bounds = body.boundary.as_ref()?.bounds();
                let cells = grid.shared().lattice().nodes()[0].max(2) - 1;
                Some((bounds.into(), bounds.size().x / cells as f64))
            });
            let (extent, voxel) = grids.next().filter(|_| grids.next().is_none())?;
            (&scene.camera, extent, voxel)
        }
        _ => return None,
    };
    let centre = extent.world_bounds().centre();
    // The plane of the image is at distance 1 along its axis.
    let distance = match camera.is_orthographic() {
        true => 1.0,
        false => (centre - camera.eye()).dot(*camera.axis()),
    };
    let pixel = 2.0 * distance * length_of(camera.half_up()) / height as f64;
    let reach = (0.5 * voxel / pixel).ceil().clamp(1.0, WIDEST) as usize;
    let sees = |i: usize| {
        let ray = camera.ray([i % width, i / width], [width, height]);
        extent.span(&ray).is_some()
    };
    let sees: Vec<bool> = (0..width * height).map(sees).collect();
    let is_at_border =
        |i: usize| around(i, [width, height], reach).any(|other| sees[other] != sees[i]);
    (distance > 0.0).then(|| (0..width * height).map(is_at_border).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn the_silhouette_of_a_grid_is_a_frame_and_other_media_have_none() {
        let border = |name: &str| {
            let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/scenes");
            silhouette(&Scene::load(&fixtures.join(name)).unwrap())
        };
        let frame = border("sampled/trilinear-blocks.toml").unwrap();
        let share = frame.iter().filter(|&&is| is).count() as f64 / frame.len() as f64;
        assert!(share > 0.05 && share < 0.5, "{share}");
        assert!(!frame[0] && !frame[40 * 80 + 40]);
        assert!(border("procedural/absorbing-grid.toml").is_some());
        assert!(border("fog/forward.toml").is_none());
    }
}
