//! A plan as the text by which goldens know it.
//!
//! Goldens hold a hash of it, so its words stay as they are, whatever the code calls a thing today;
//! and a feature that goldens of old know nothing of is named only where it is on.

use super::{Kernel, Parts, Plan, RayCasterFeatures};

impl Plan<'_> {
    /// The plan as text that changes with anything it covers: the kernel and the state of every
    /// effect. Goldens keep its hash, so none can silently come to cover other physics.
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
        Kernel::RayCaster { features, .. } => {
            let RayCasterFeatures {
                field,
                compositing,
                shading,
                shadow,
                skip_empty,
            } = features;
            format!(
                "RayCaster {{ field: {field:?}, compositing: {compositing:?}, shading: {shading}, \
                 shadow: {shadow}, skip_empty: {skip_empty} }}"
            )
        }
        Kernel::LineOfSight { parts, turned, .. } => {
            let parts = of_parts(parts);
            format!("LineOfSight {{ parts: {parts}, turned: {turned} }}")
        }
        Kernel::PathTracer { parts, limit, .. } => {
            let parts = of_parts(parts);
            format!("PathTracer {{ parts: {parts}, limit: {limit:?} }}")
        }
    }
}

fn of_parts(parts: &Parts) -> String {
    let Parts {
        media,
        null_media,
        surfaces,
        emission,
        chromatic,
        anisotropic,
        heterogeneous,
    } = parts;
    let heterogeneous = if *heterogeneous {
        ", heterogeneous: true"
    } else {
        ""
    };
    format!(
        "Parts {{ media: {media}, null_media: {null_media}, surfaces: {surfaces}, \
         emission: {emission}, chromatic: {chromatic}, anisotropic: {anisotropic}{heterogeneous} }}"
    )
}
