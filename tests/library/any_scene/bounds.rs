//! How much work a scene can make, by its numbers.

use super::check::SIDE;
use volref::geometry::{Surface, length_of};
use volref::optics::Material;
use volref::scene::{Body, Classified, Model, Panel, Radiative, Scattering};

/// Rays from the eye.
const RAYS: f64 = (SIDE * SIDE) as f64;

/// Samples of all rays of a picture, shadow rays included, up to which it is rendered here. The
/// loader accepts up to 1e8 on a ray, of which each may have a shadow ray of as many: a picture
/// that somebody with patience may ask for, and a test cannot.
const MOST_SAMPLES: f64 = 4e6;

/// Turns of a path up to which a scene is rendered here, where nothing takes light away. The
/// format accepts 2^26 − 1, and any number where there is no limit.
const MOST_TURNS: f64 = 64.0;

/// Optical depth of what varies up to which it is rendered here. The loader accepts 2^24.
const DEEPEST: f64 = 64.0;

/// Whether a scene may take longer than a test has time for.
pub fn too_long(panel: &Panel) -> bool {
    match &panel.model {
        Model::Curve(_) => false,
        Model::Classified(scene) => {
            let (samples, to_light) = steps(scene);
            RAYS * samples * (1.0 + to_light) > MOST_SAMPLES
        }
        Model::Radiative(scene) => most_turns(scene) > 1e4 || deepest(scene) > DEEPEST,
    }
}

/// Steps on a ray, and on a shadow ray: as many as cross the volume, one for each of its two ends,
/// which may be of any length, and what roundings of the distances to both add: less than a step
/// each by the loader's demand, in each of the up to four roundings of a distance.
fn steps(scene: &Classified) -> (f64, f64) {
    let across = length_of(scene.grid.lattice().bounds().size());
    let over = |step: f64| (across / step).ceil() + 10.0;
    (
        over(scene.step),
        scene.shadow.map_or(0.0, |shadow| over(shadow.step)),
    )
}

/// Turns of a path, at most: by the limit of the scene; or, where every turn takes away a tenth of
/// the light, by roulette. Below a half of what it began with, a path survives a turn with a
/// probability of 0.9 at most, so it is turned 512 times with one of 0.9^500 = 1e-23: not in all
/// runs of this test together.
fn most_turns(scene: &Radiative) -> f64 {
    let limit = match scene.scattering {
        Scattering::None => 0.0,
        Scattering::Single => 1.0,
        Scattering::Multiple(Some(limit)) => f64::from(limit),
        Scattering::Multiple(None) => f64::INFINITY,
    };
    let losing = scene.objects.iter().all(|object| match object.material {
        Material::Diffuse(share) | Material::Mirror(share) => share.max_element() <= 0.9,
        Material::Glass(_) => false,
    }) && scene.media.iter().all(|body| {
        let coefficients = body.medium.coefficients;
        coefficients
            .sigma_s()
            .cmple(coefficients.sigma_t() * 0.9)
            .all()
    });
    if limit <= MOST_TURNS {
        limit
    } else if losing {
        limit.min(512.0)
    } else {
        f64::INFINITY
    }
}

/// Bound on the tentative collisions along any line, on average: the optical depth of what varies,
/// and, of what is the same everywhere, by how much that of its channels differs.
fn deepest(scene: &Radiative) -> f64 {
    if scene.media.iter().all(|body| body.density.is_none()) {
        return 0.0;
    }
    let depth = |body: &Body| {
        let sigma_t = body.medium.coefficients.sigma_t();
        let spread = sigma_t.max_element() - sigma_t.min_element();
        let across = body
            .boundary
            .as_ref()
            .map_or(f64::MAX, |boundary| length_of(boundary.bounds().size()));
        match &body.density {
            Some(density) => sigma_t.max_element() * (density.blocks().range().high * across),
            None => spread * across,
        }
    };
    scene.media.iter().map(depth).sum()
}
