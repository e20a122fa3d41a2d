//! Parts that a scene has to have for a formula, or must not have.

use crate::optics::{Coefficients, Homogeneous, Phase};
use crate::scene::{Body, Radiative, Scattering};
use glam::DVec3;

/// Fails with `message` unless `holds`.
pub fn require(holds: bool, message: &str) -> Result<(), String> {
    if holds {
        Ok(())
    } else {
        Err(message.to_owned())
    }
}

/// Neither surfaces nor lamps.
pub fn without_surfaces(scene: &Radiative) -> Result<(), String> {
    require(
        scene.objects.is_empty() && scene.area_lights.is_empty(),
        "it has surfaces, and the formula has none",
    )
}

/// No point, spot or directional light.
pub fn without_lights(scene: &Radiative) -> Result<(), String> {
    require(
        scene.lights.is_empty(),
        "it has a light, and the formula has none",
    )
}

/// The only medium.
pub fn only_medium(scene: &Radiative) -> Result<&Body, String> {
    match &scene.media[..] {
        [body] => Ok(body),
        media => Err(format!("it has {} media, not one", media.len())),
    }
}

/// A medium without a density of its own.
pub fn homogeneous(body: &Body) -> Result<&Homogeneous, String> {
    require(
        body.density.is_none(),
        "a medium has a density, and the formula is for homogeneous ones",
    )?;
    Ok(&body.medium)
}

/// The only medium, homogeneous, with its shape.
pub fn only_homogeneous(scene: &Radiative) -> Result<(&Body, &Homogeneous), String> {
    let body = only_medium(scene)?;
    Ok((body, homogeneous(body)?))
}

/// Light scattered any number of times.
pub fn any_order(scene: &Radiative) -> Result<(), String> {
    require(
        scene.scattering == Scattering::Multiple(None),
        "the formula is for light scattered any number of times: leave `scattering` and \
         `max_bounces` out",
    )
}

/// Light scattered once, out of darkness.
pub fn single_scattering(scene: &Radiative) -> Result<(), String> {
    require(
        scene.scattering == Scattering::Single,
        "the formula is for `scattering = \"single\"`",
    )?;
    require(
        scene.environment == DVec3::ZERO,
        "it has an environment, whose light would be scattered too",
    )
}

/// A medium that emits nothing.
pub fn dark(medium: &Homogeneous) -> Result<(), String> {
    require(medium.emission == DVec3::ZERO, "the medium emits light")
}

/// A medium that absorbs and does not scatter.
pub fn absorbing(coefficients: &Coefficients) -> Result<(), String> {
    require(
        coefficients.sigma_s() == DVec3::ZERO,
        "a medium scatters, and the formula is for absorption",
    )
}

/// The asymmetry of a Henyey–Greenstein phase function.
pub fn henyey_greenstein(phase: &Phase) -> Result<f64, String> {
    match phase {
        phase if phase.is_isotropic() => Ok(0.0),
        Phase::HenyeyGreenstein(phase) => Ok(phase.0.g()),
        _ => Err("the phase function is not that of Henyey and Greenstein".to_owned()),
    }
}
