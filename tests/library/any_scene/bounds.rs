//! How much work a scene can make, counted beforehand from its numbers.

use super::check::{SAMPLES, SIDE};
use volref::geometry::{Surface, length_of};
use volref::optics::Material;
use volref::render::{Counters, Event};
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

/// Bounds on the work of a picture; nothing else that has a counter here is done.
pub struct Bounds(Vec<(Event, f64)>);

impl Bounds {
    /// Refuses work beyond the bounds.
    pub fn check(&self, work: &Counters) -> Result<(), String> {
        const BOUNDED: [Event; 9] = [
            Event::DensityLookup,
            Event::GradientLookup,
            Event::GradientComputed,
            Event::CellWalked,
            Event::ShadowRay,
            Event::PhaseEvaluation,
            Event::NullCollision,
            Event::SurfaceTest,
            Event::RandomDraw,
        ];
        for event in BOUNDED {
            let bound = self.0.iter().find(|(of, _)| *of == event);
            let bound = bound.map_or(0.0, |(_, bound)| *bound);
            if work[event] as f64 > bound {
                let (done, what) = (work[event], event.key());
                return Err(format!("{done} {what}, where {bound} are the most"));
            }
        }
        Ok(())
    }
}

/// Bounds on the work of a picture, by what its loops run over.
pub fn most_work(panel: &Panel) -> Bounds {
    match &panel.model {
        Model::Curve(_) => Bounds(Vec::new()),
        Model::Classified(scene) => of_ray_caster(scene),
        Model::Radiative(scene) => of_paths(scene),
    }
}

/// At every sample a block is asked, a value and a gradient are looked up, and a shadow ray is
/// sent, at whose samples a block is asked and a value looked up.
fn of_ray_caster(scene: &Classified) -> Bounds {
    let (steps, to_light) = steps(scene);
    // Without samples, the cells that a ray enters.
    let cells = scene.grid.lattice().nodes().iter().sum::<usize>() as f64 + 4.0;
    let samples = RAYS * if scene.is_continuous() { cells } else { steps };
    let all = samples * (1.0 + to_light);
    let nodes = scene.grid.lattice().node_count() as f64;
    Bounds(vec![
        (Event::DensityLookup, all),
        (Event::GradientLookup, samples),
        (Event::GradientComputed, nodes),
        (Event::CellWalked, all),
        (Event::ShadowRay, samples),
    ])
}

/// Per turn of a path there is one ray on; per light with a position one place on it, two places
/// that the light shines on and a connection; and a connection for every other light.
fn of_paths(scene: &Radiative) -> Bounds {
    let (lights, lamps) = (scene.lights.len() as f64, scene.area_lights.len() as f64);
    let media = scene.media.len() as f64;
    let surfaces = scene.objects.len() as f64 + lamps;
    let rays = RAYS * f64::from(SAMPLES) * (most_turns(scene) + 1.0);
    // By quadrature along the line of sight instead: five pieces of every stretch of a ray, in 16
    // pieces each, of which one becomes up to 1000 by cuts in two, each of which looks 30 times.
    // A ray has a stretch between each two of its up to 8 crossings of every medium.
    let integrals = 5.0 * 16.0 * (8.0 * media + 1.0) * 30_000.0 * RAYS;
    let connections = rays * (4.0 * lights + lamps) + integrals * lights;
    let lines = rays * (2.0 + 2.0 * lights) + 2.0 * connections;
    // Tentative collisions on a line are Poisson distributed around its depth, to which emission
    // stretches add 4 each: more than twice as many and 200 have a probability below 1e-80.
    let collisions = 2.0 * (deepest(scene) + 4.0 * (8.0 * media + 1.0)) + 200.0;
    // A walk through a density passes as many blocks as it has along all axes together, and a
    // gap before and after.
    let blocks = (3.0 * 33.0 + 3.0) * (8.0 * media + 1.0);
    let lookups = lines * media * (collisions + 2.0 * blocks + 2.0);
    Bounds(vec![
        (Event::DensityLookup, lookups),
        (Event::CellWalked, lines * media * blocks),
        (Event::ShadowRay, connections),
        (Event::PhaseEvaluation, (rays + 2.0 * connections) * media),
        (Event::NullCollision, lines * collisions),
        (Event::SurfaceTest, surfaces * (lines + connections)),
        (Event::RandomDraw, lines * 2.0 * (collisions + 8.0)),
    ])
}
