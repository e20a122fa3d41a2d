//! Features of a picture that not every renderer has, by name: what its author refuses.

use super::inline_arrays::Json;
use crate::optics::Appearance;
use crate::scene::{Classified, Mode};
use crate::volume::Interpolation;

/// Features beside one volume along the axes, seen from one point, interpolated between the points of a table and composited,
/// each with the words for it.
pub(super) fn asks(scene: &Classified) -> Json {
    let volumes: Vec<Classified> = scene.each_alone().collect();
    let any = |is: &dyn Fn(&Classified) -> bool| volumes.iter().any(is);
    let several = format!("{} volumes", volumes.len());
    let mode = scene.mode.name().unwrap_or_default();
    let shown_as = format!("mode = \"{mode}\"");
    let is_formula = |it: &Classified| {
        let is = matches!(it.transfer_function.appearance, Appearance::Formula { .. });
        is && it.mode.uses_transfer_function()
    };
    let objects = &scene.objects;
    let shows_mode = scene.mode != Mode::Composited;
    let modulated = (0..volumes.len()).any(|index| scene.modulation_of(index).is_some());
    let parallel = scene.camera.orthographic_height().is_some();
    let placed = any(&|it| it.to_world.is_some());
    let nearest = any(&|it| it.interpolation == Interpolation::Nearest);
    let formula = any(&is_formula);
    let shadow = scene.shadow.is_some() || any(&|it| it.shadow.is_some());
    let features = [
        (mode, shows_mode, &*shown_as),
        ("several", volumes.len() > 1, &several),
        ("parallel", parallel, "parallel rays"),
        ("placed", placed, "a volume placed by a matrix"),
        ("sheared", any(&is_sheared), "a volume that is sheared"),
        ("nearest", nearest, "values of the nearest node"),
        ("formula", formula, "a transfer function by formulas"),
        ("shading", any(&|it| it.phong.is_some()), "shading"),
        ("shadow", shadow, "a shadow"),
        ("clips", !objects.clips.is_empty(), "clips"),
        ("surfaces", !objects.surfaces.is_empty(), "surfaces"),
        ("modulation", modulated, "opacities by a second number"),
    ];
    let asked = features.into_iter().filter(|(_, is_asked, _)| *is_asked);
    Json::Object(asked.map(|(name, _, words)| (name, words.into())).collect())
}

/// Edges of a cell are less perpendicular than the four decimals of a matrix make them: in the product of two unit vectors
/// that are rounded so. Along 256 voxels that is a twentieth of a voxel.
fn is_sheared(scene: &Classified) -> bool {
    const ROUNDED: f64 = 2e-4;
    let [x, y, z] = scene.cell_edges().map(|edge| edge.normalize_or_zero());
    [x.dot(y), y.dot(z), z.dot(x)]
        .iter()
        .any(|product| product.abs() > ROUNDED)
}
