//! The volume of a scene as its pixels see it: their size in voxels, and the silhouette of its box.

use crate::geometry::{Camera, Ray, Span, Surface as _, length_of};
use crate::optics::{Density, Field};
use crate::scene::{Model, Panel, Scene};
use crate::volume::{Lattice, PlacedBox};
use glam::DVec3;

/// Largest width of the border, in pixels.
const WIDEST: usize = 8;

/// The only volume with voxels of a scene of one panel.
pub(super) struct VolumeInView<'s> {
    camera: &'s Camera,
    size: [usize; 2],
    /// The box of a classified volume, wherever it is, or of a medium.
    extent: PlacedBox,
    lattice: &'s Lattice,
    /// Place of the grid of a medium in the world.
    density: Option<&'s Density>,
}

impl<'s> VolumeInView<'s> {
    pub fn of(scene: &'s Scene) -> Option<VolumeInView<'s>> {
        let [panel] = &scene.panels[..] else {
            return None;
        };
        let Panel { width, height, .. } = *panel;
        let size = [width, height];
        match &panel.model {
            Model::Classified(volume) if volume.has_objects() => None,
            Model::Classified(volume) => Some(VolumeInView {
                camera: &volume.camera,
                size,
                extent: volume.extent(),
                lattice: volume.grid.lattice(),
                density: None,
            }),
            Model::Radiative(scene) => {
                let mut grids = scene.media.iter().filter_map(|body| {
                    let density = body.density.as_ref()?;
                    let Field::Grid(grid) = density.field() else {
                        return None;
                    };
                    Some(VolumeInView {
                        camera: &scene.camera,
                        size,
                        extent: body.boundary.as_ref()?.bounds().into(),
                        lattice: grid.shared().lattice(),
                        density: Some(density),
                    })
                });
                let only = grids.next();
                only.filter(|_| grids.next().is_none())
            }
            Model::Curve(_) => None,
        }
    }

    /// Width of a pixel at the centre of the volume, to the right and down, in voxels along the axes of
    /// the grid; none where the centre lies behind the eye.
    pub fn voxels(&self) -> Option<[[f64; 3]; 2]> {
        let centre = self.extent.world_bounds().centre();
        let (right, up) = (self.camera.half_right(), self.camera.half_up());
        let distance = if self.camera.is_orthographic() {
            1.0
        } else {
            // The plane of the image is at distance 1 along the ray through its centre.
            let normal = right.cross(up);
            (centre - self.camera.eye()).dot(normal) / self.camera.forward().dot(normal)
        };
        let pixel = 2.0 * distance / self.size[1] as f64;
        let [right, down] = [right, -up].map(|half| self.in_voxels(centre, half * pixel));
        let found = [right?, down?];
        (distance > 0.0).then_some(found)
    }

    /// A short way in the world, at the centre of the volume, in voxels.
    fn in_voxels(&self, centre: DVec3, way: DVec3) -> Option<[f64; 3]> {
        let way = match self.density {
            None => self.extent.vector_to_volume(way),
            Some(density) => {
                let length = length_of(way);
                let ray = Ray::new(centre, way)?;
                let (line, _) = density.along(&ray, Span::new(0.0, length))?;
                line.direction * length
            }
        };
        Some((way / self.lattice.spacing()).to_array())
    }

    /// Pixels as near to the silhouette of the box as half a voxel looks at its centre.
    pub fn border(&self) -> Option<Vec<bool>> {
        let [right, _] = self.voxels()?;
        let pixel = DVec3::from_array(right).length();
        let reach = ((0.5 / pixel).ceil() as usize).clamp(1, WIDEST);
        let [width, height] = self.size;
        let sees = |i: usize| {
            let ray = self.camera.ray([i % width, i / width], self.size);
            self.extent.span(&ray).is_some()
        };
        let sees: Vec<bool> = (0..width * height).map(sees).collect();
        let around =
            |at: usize, count: usize| at.saturating_sub(reach)..(at + reach + 1).min(count);
        let is_at_border = |i: usize| {
            let mut rows = around(i / width, height);
            rows.any(|row| {
                around(i % width, width).any(|column| sees[row * width + column] != sees[i])
            })
        };
        Some((0..width * height).map(is_at_border).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn scene(name: &str) -> Scene {
        let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/scenes");
        Scene::load(&fixtures.join(name)).unwrap()
    }

    /// The grid moved by voxels looks as though the image had moved by so many pixels.
    #[test]
    fn pixels_of_voxels() {
        let scene = scene("sampled/trilinear-blocks.toml");
        let view = VolumeInView::of(&scene).unwrap();
        let [right, down] = view.voxels().unwrap();
        // 80 rows of a field of 38 degrees; voxels of 0.25.
        let distance = DVec3::new(1.7, 1.5, -2.3).length();
        let pixel = 2.0 * crate::math::tan(19_f64.to_radians()) * distance / 80.0;
        for along in [right, down] {
            let size = DVec3::from_array(along).length() * 0.25;
            assert!((size / pixel - 1.0).abs() < 1e-3, "{size} {pixel}");
        }
        assert!(down[1] < 0.0 && right[1].abs() < 1e-9);
        let border = view.border().unwrap();
        let share = border.iter().filter(|&&is| is).count() as f64 / border.len() as f64;
        assert!(share > 0.05 && share < 0.5, "{share}");
        assert!(!border[0] && !border[40 * 80 + 40]);
    }

    #[test]
    fn grids_of_media_have_voxels_and_other_media_none() {
        let view = |name| VolumeInView::of(&scene(name)).map(|view| view.voxels());
        assert!(matches!(
            view("procedural/absorbing-grid.toml"),
            Some(Some(_))
        ));
        assert!(view("fog/forward.toml").is_none());
    }
}
