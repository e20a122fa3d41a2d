//! The canonical text of a plan, which goldens hash.
//!
//! Goldens hold a hash of it, so its words never change, even where the code has renamed things;
//! and a feature newer than the first goldens is named only where it is on.

use super::{Kernel, Plan, RadiativeFeatures, RayCasterFeatures};
use crate::scene::Classified;
use crate::volume::Interpolation;

impl Plan<'_> {
    /// The plan as text that changes with anything it covers: the kernel and the state of every
    /// effect. Goldens store its hash, so none can silently stand for other physics.
    pub fn canonical_text(&self) -> String {
        let mut text = of_kernel(&self.kernel);
        text.push('\n');
        for decision in &self.decisions {
            text.push_str(&format!("{} {}\n", decision.effect, decision.state));
        }
        text
    }
}

fn of_kernel(kernel: &Kernel<'_>) -> String {
    match kernel {
        Kernel::Curve(_) => "Curve".to_owned(),
        Kernel::Background(_) => "Background".to_owned(),
        Kernel::RayCaster { scene, features } => of_ray_caster(scene, *features, ""),
        Kernel::Conventional(scene) => {
            of_ray_caster(scene, RayCasterFeatures::asked_for(scene), ", plain: true")
        }
        Kernel::Several(scene) => {
            format!("Several {{ {} }}", scene.counted_objects())
        }
        Kernel::Integral(_) => "Integral".to_owned(),
        Kernel::Field(scene) => format!(
            "Field {{ mode: {}, exact: {}, shading: {} }}",
            scene.mode.name().unwrap_or_default(),
            scene.is_exact(),
            scene.phong.is_some()
        ),
        Kernel::LineOfSight {
            features, scatters, ..
        } => {
            let features = of_radiative(features);
            format!("LineOfSight {{ parts: {features}, turned: {scatters} }}")
        }
        Kernel::PathTracer {
            features,
            max_order,
            ..
        } => {
            let features = of_radiative(features);
            format!("PathTracer {{ parts: {features}, limit: {max_order:?} }}")
        }
    }
}

fn of_ray_caster(scene: &Classified, features: RayCasterFeatures, newer: &str) -> String {
    let RayCasterFeatures {
        constant,
        shading,
        shadow,
        skip_empty,
    } = features;
    let field = match scene.interpolation {
        _ if constant => "Constant",
        Interpolation::Nearest => "Nearest",
        Interpolation::Trilinear => "Trilinear",
    };
    let compositing = scene.compositing;
    let placed = ["", ", placed: true"][usize::from(scene.to_world.is_some())];
    format!(
        "RayCaster {{ field: {field}, compositing: {compositing:?}, shading: {shading}, \
         shadow: {shadow}, skip_empty: {skip_empty}{placed}{newer} }}"
    )
}

fn of_radiative(features: &RadiativeFeatures) -> String {
    let RadiativeFeatures {
        media,
        vacuum_media,
        surfaces,
        emission,
        chromatic,
        anisotropic,
        heterogeneous,
    } = features;
    let heterogeneous = ["", ", heterogeneous: true"][usize::from(*heterogeneous)];
    format!(
        "Parts {{ media: {media}, null_media: {vacuum_media}, surfaces: {surfaces}, \
         emission: {emission}, chromatic: {chromatic}, anisotropic: {anisotropic}{heterogeneous} }}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::plans;
    use crate::scene::Scene;
    use std::path::Path;

    /// The texts whose hashes goldens hold.
    #[test]
    fn kernels_are_called_as_in_the_goldens() {
        let kernel = |name: &str| {
            let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/scenes");
            let scene = Scene::load(&root.join(name)).unwrap();
            of_kernel(&plans(&scene).pop().unwrap().kernel)
        };
        for (name, text) in [
            ("figures/figure-2.toml", "Curve"),
            (
                "figures/figure-5.toml",
                "RayCaster { field: Trilinear, compositing: FrontToBack, shading: true, \
                 shadow: true, skip_empty: true }",
            ),
            (
                "procedural/absorbing-grid.toml",
                "LineOfSight { parts: Parts { media: true, null_media: false, surfaces: false, \
                 emission: false, chromatic: true, anisotropic: false, heterogeneous: true }, \
                 turned: false }",
            ),
            (
                "smoke/cornell.toml",
                "PathTracer { parts: Parts { media: true, null_media: false, surfaces: true, \
                 emission: false, chromatic: false, anisotropic: false }, limit: None }",
            ),
        ] {
            assert_eq!(kernel(name), text, "{name}");
        }
    }
}
