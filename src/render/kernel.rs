//! The one place where a plan becomes code: each choice picks a type, and the last call
//! compiles the ray caster for the types picked.

use super::compositing::{BackToFront, EarlyTermination, FrontToBack, Order};
use super::empty_space::{EmptySpace, Space, Unexplored};
use super::field::{Constant, Field, Sampled};
use super::image::{Pixels, rows};
use super::plan::FieldKind;
use super::ray_caster::{RayCaster, Shaded, Shading, Unshaded};
use super::volume_shadow::{Unshadowed, Visibility, VolumeShadow};
use super::work::{Event, Work};
use crate::scene::{Classified, Compositing};
use crate::volume::{Nearest, Node, Trilinear, relative_gradients};

/// The parts of a ray caster, as a plan names them.
#[derive(Clone, Copy)]
pub(super) struct Parts {
    pub field: FieldKind,
    pub compositing: Compositing,
    pub shading: bool,
    pub shadow: bool,
    pub skip_empty: bool,
}

/// Renders `scene` with the ray caster made of `parts`.
pub(super) fn cast<W: Work>(
    scene: &Classified,
    parts: Parts,
    pixels: &Pixels<'_>,
) -> (Vec<[f32; 4]>, W) {
    let grid = &*scene.grid;
    match parts.field {
        FieldKind::Trilinear => with_order(scene, parts, pixels, Sampled::new(grid, Trilinear)),
        FieldKind::Nearest => with_order(scene, parts, pixels, Sampled::new(grid, Nearest)),
        FieldKind::Constant => with_order(
            scene,
            parts,
            pixels,
            Constant(grid.lattice(), grid.values()[0].value()),
        ),
    }
}

fn with_order<F: Field, W: Work>(
    scene: &Classified,
    parts: Parts,
    pixels: &Pixels<'_>,
    field: F,
) -> (Vec<[f32; 4]>, W) {
    match parts.compositing {
        Compositing::FrontToBack => with_shading(scene, parts, pixels, field, FrontToBack),
        Compositing::BackToFront => with_shading(scene, parts, pixels, field, BackToFront),
        Compositing::EarlyTermination(below) => {
            with_shading(scene, parts, pixels, field, EarlyTermination { below })
        }
    }
}

fn with_shading<F: Field, O: Order + Sync, W: Work>(
    scene: &Classified,
    parts: Parts,
    pixels: &Pixels<'_>,
    field: F,
    order: O,
) -> (Vec<[f32; 4]>, W) {
    match scene.phong.filter(|_| parts.shading) {
        Some(phong) => {
            let gradients = relative_gradients(&*scene.grid);
            let shading = Shaded {
                phong,
                gradients,
                light: scene.light,
            };
            let nodes = scene.grid.lattice().node_count() as u64;
            let (image, mut work): (_, W) =
                with_visibility(scene, parts, pixels, field, order, shading);
            work.count_times(Event::GradientComputed, nodes);
            (image, work)
        }
        None => with_visibility(scene, parts, pixels, field, order, Unshaded),
    }
}

fn with_visibility<F: Field, O: Order + Sync, S: Shading, W: Work>(
    scene: &Classified,
    parts: Parts,
    pixels: &Pixels<'_>,
    field: F,
    order: O,
    shading: S,
) -> (Vec<[f32; 4]>, W) {
    match scene.shadow.filter(|_| parts.shadow) {
        Some(shadow) => {
            let bounds = scene.grid.lattice().bounds();
            let visibility = VolumeShadow {
                shadow,
                light: scene.light,
                bounds,
                transfer_function: &scene.transfer_function,
            };
            with_space(scene, parts, pixels, field, order, shading, visibility)
        }
        None => with_space(scene, parts, pixels, field, order, shading, Unshadowed),
    }
}

fn with_space<F: Field, O: Order + Sync, S: Shading, V: Visibility, W: Work>(
    scene: &Classified,
    parts: Parts,
    pixels: &Pixels<'_>,
    field: F,
    order: O,
    shading: S,
    visibility: V,
) -> (Vec<[f32; 4]>, W) {
    if parts.skip_empty {
        let space = EmptySpace::of(&*scene.grid, &scene.transfer_function);
        with_all(scene, pixels, field, order, shading, visibility, space)
    } else {
        with_all(scene, pixels, field, order, shading, visibility, Unexplored)
    }
}

fn with_all<F: Field, O: Order + Sync, S: Shading, V: Visibility, E: Space, W: Work>(
    scene: &Classified,
    pixels: &Pixels<'_>,
    field: F,
    order: O,
    shading: S,
    visibility: V,
    space: E,
) -> (Vec<[f32; 4]>, W) {
    let caster = RayCaster {
        field,
        order,
        shading,
        visibility,
        space,
        transfer_function: &scene.transfer_function,
        step: scene.step,
        bounds: scene.grid.lattice().bounds(),
    };
    let size = [pixels.width, pixels.height];
    rows(
        pixels,
        || (),
        |pixel, (), work: &mut W| {
            let layers = caster.layers(&scene.camera.ray(pixel, size), work);
            let radiance = layers.before(scene.background);
            [radiance.x, radiance.y, radiance.z, layers.opacity].map(|value| value as f32)
        },
    )
}
