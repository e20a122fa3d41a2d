//! The kernels of the ray caster: each feature of a plan picks a type, and the last call compiles
//! the ray caster for the types picked.

use super::compositing::{BackToFront, CompositingOrder, FrontToBack};
use super::empty_space::{EmptySpace, NoSkipping, Skipping};
use super::field::{ConstantField, GridField, ScalarField};
use super::ray_caster::RayCaster;
use super::shading::{Shaded, Shading, Unshaded};
use super::volume_shadow::{Unshadowed, Visibility, VolumeShadow};
use crate::render::counters::{Event, Work};
use crate::render::pixels::{Pixels, rows};
use crate::render::plan::{FieldKind, RayCasterFeatures};
use crate::scene::{Classified, Compositing};
use crate::volume::{Nearest, Node, Trilinear};
use std::marker::PhantomData;

/// A task for a ray caster of any types.
trait Task {
    /// The result.
    type Output;

    /// Does the task with `caster`.
    fn with<F: ScalarField, O: CompositingOrder + Sync, S: Shading, V: Visibility, E: Skipping>(
        self,
        caster: RayCaster<'_, F, O, S, V, E>,
    ) -> Self::Output;
}

/// The pixels of `scene` by the ray caster with `features`.
pub(in crate::render) fn cast<W: Work>(
    scene: &Classified,
    features: RayCasterFeatures,
    pixels: &Pixels<'_>,
) -> (Vec<[f32; 4]>, W) {
    let task = RenderTask {
        scene,
        pixels,
        work: PhantomData,
    };
    let (image, mut work): (_, W) = with_features(scene, features, task);
    if features.shading && scene.phong.is_some() {
        let nodes = scene.grid.lattice().node_count() as u64;
        work.count_times(Event::GradientComputed, nodes);
    }
    (image, work)
}

/// The image of a scene.
struct RenderTask<'p, W> {
    scene: &'p Classified,
    pixels: &'p Pixels<'p>,
    work: PhantomData<W>,
}

impl<W: Work> Task for RenderTask<'_, W> {
    type Output = (Vec<[f32; 4]>, W);

    fn with<F: ScalarField, O: CompositingOrder + Sync, S: Shading, V: Visibility, E: Skipping>(
        self,
        caster: RayCaster<'_, F, O, S, V, E>,
    ) -> Self::Output {
        let RenderTask { scene, pixels, .. } = self;
        let size = [pixels.width, pixels.height];
        rows(
            pixels,
            || (),
            |pixel, _, (), work: &mut W| {
                let layers = caster.layers(&scene.camera.ray(pixel, size), work);
                let radiance = layers.before(scene.background);
                [radiance.x, radiance.y, radiance.z, layers.opacity].map(|value| value as f32)
            },
        )
    }
}

/// The result of `task` with the ray caster of `scene` with `features`.
fn with_features<T: Task>(scene: &Classified, features: RayCasterFeatures, task: T) -> T::Output {
    let grid = &*scene.grid;
    match features.field {
        FieldKind::Trilinear => with_order(scene, features, task, GridField::new(grid, Trilinear)),
        FieldKind::Nearest => with_order(scene, features, task, GridField::new(grid, Nearest)),
        FieldKind::Constant => with_order(
            scene,
            features,
            task,
            ConstantField(grid.lattice(), grid.values()[0].value()),
        ),
    }
}

fn with_order<T: Task, F: ScalarField>(
    scene: &Classified,
    features: RayCasterFeatures,
    task: T,
    field: F,
) -> T::Output {
    match features.compositing {
        Compositing::FrontToBack => {
            with_shading(scene, features, task, field, FrontToBack::default())
        }
        Compositing::EarlyTermination(termination) => {
            with_shading(scene, features, task, field, FrontToBack { termination })
        }
        Compositing::BackToFront => with_shading(scene, features, task, field, BackToFront),
    }
}

fn with_shading<T: Task, F: ScalarField, O: CompositingOrder + Sync>(
    scene: &Classified,
    features: RayCasterFeatures,
    task: T,
    field: F,
    order: O,
) -> T::Output {
    match scene.phong.filter(|_| features.shading) {
        Some(phong) => {
            let gradients = scene.gradients();
            let shading = Shaded {
                phong,
                gradients,
                light: scene.light,
            };
            with_visibility(scene, features, task, field, order, shading)
        }
        None => with_visibility(scene, features, task, field, order, Unshaded),
    }
}

fn with_visibility<T: Task, F: ScalarField, O: CompositingOrder + Sync, S: Shading>(
    scene: &Classified,
    features: RayCasterFeatures,
    task: T,
    field: F,
    order: O,
    shading: S,
) -> T::Output {
    match scene.shadow.filter(|_| features.shadow) {
        Some(shadow) => {
            let visibility = VolumeShadow {
                shadow,
                light: scene.light,
                extent: scene.extent(),
                transfer_function: &scene.transfer_function,
            };
            with_space(scene, features, task, field, order, shading, visibility)
        }
        None => with_space(scene, features, task, field, order, shading, Unshadowed),
    }
}

fn with_space<T: Task, F: ScalarField, O: CompositingOrder + Sync, S: Shading, V: Visibility>(
    scene: &Classified,
    features: RayCasterFeatures,
    task: T,
    field: F,
    order: O,
    shading: S,
    visibility: V,
) -> T::Output {
    // A constant field is transparent as a whole, or nowhere.
    if features.skip_empty && !F::IS_CONSTANT {
        let skipping = EmptySpace::of(&*scene.grid, &scene.transfer_function);
        with_all(scene, task, field, order, shading, visibility, skipping)
    } else {
        with_all(scene, task, field, order, shading, visibility, NoSkipping)
    }
}

fn with_all<
    T: Task,
    F: ScalarField,
    O: CompositingOrder + Sync,
    S: Shading,
    V: Visibility,
    E: Skipping,
>(
    scene: &Classified,
    task: T,
    field: F,
    order: O,
    shading: S,
    visibility: V,
    skipping: E,
) -> T::Output {
    task.with(RayCaster {
        field,
        order,
        shading,
        visibility,
        skipping,
        transfer_function: &scene.transfer_function,
        step: scene.step,
        extent: scene.extent(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::documented_kernels;
    use crate::scene::{Model, Scene};
    use std::any::type_name_of_val;
    use std::collections::BTreeSet;
    use std::path::Path;

    /// The name of the type that is picked.
    struct Name;

    impl Task for Name {
        type Output = String;

        fn with<
            F: ScalarField,
            O: CompositingOrder + Sync,
            S: Shading,
            V: Visibility,
            E: Skipping,
        >(
            self,
            caster: RayCaster<'_, F, O, S, V, E>,
        ) -> String {
            type_name_of_val(&caster).to_owned()
        }
    }

    #[test]
    fn as_many_ray_casters_as_the_documentation_says() {
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/scenes/figures");
        let scene = Scene::load(&scene.join("figure-5.toml")).unwrap();
        let Model::Classified(classified) = &scene.panels.last().unwrap().model else {
            panic!("a classified volume");
        };
        assert!(classified.phong.is_some() && classified.shadow.is_some());
        let fields = [
            FieldKind::Trilinear,
            FieldKind::Nearest,
            FieldKind::Constant,
        ];
        let orders = [
            Compositing::FrontToBack,
            Compositing::BackToFront,
            Compositing::EarlyTermination(0.01),
        ];
        let mut kernels = BTreeSet::new();
        for field in fields {
            for compositing in orders {
                for switches in 0..8 {
                    let features = RayCasterFeatures {
                        field,
                        compositing,
                        shading: switches & 1 != 0,
                        shadow: switches & 2 != 0,
                        skip_empty: switches & 4 != 0,
                        placed: false,
                    };
                    kernels.insert(with_features(classified, features, Name));
                }
            }
        }
        assert_eq!(documented_kernels("ray caster"), kernels.len());
    }
}
