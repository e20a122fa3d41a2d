//! Parameters of participating media.

use super::{Number, along, of_each};
use crate::geometry::{Boundary, Surface, Transform};
use crate::optics::{Asymmetry, Coefficients};
use crate::scene::{Body, Radiative};
use glam::DVec3;

/// Parameters of every medium alone, and before them those of all media together where there are several.
pub(super) fn numbers(scene: &Radiative) -> Vec<Number> {
    let count = scene.media.len();
    let mut numbers = Vec::new();
    if count > 1 {
        numbers = of_matter(scene, None);
    }
    numbers.extend(of_each(count, |at| {
        let mut numbers = of_matter(scene, Some(at));
        numbers.extend(of_boundary(&scene.media[at], at));
        numbers
    }));
    numbers
}

/// Parameters of the coefficients, phase function and emission of the medium `at`, or of all.
fn of_matter(scene: &Radiative, at: Option<usize>) -> Vec<Number> {
    let bodies: Vec<&Body> = match at {
        Some(at) => vec![&scene.media[at]],
        None => scene.media.iter().collect(),
    };
    let number = |name, words, step, edit: fn(&mut Body, f64) -> Option<()>| {
        let names = [name, words, "medium"];
        Number::radiative(names, step, move |scene, change| match at {
            Some(at) => edit(scene.media.get_mut(at)?, change),
            None => {
                let mut bodies = scene.media.iter_mut();
                bodies.try_for_each(|body| edit(body, change))
            }
        })
    };
    let any = |has: fn(&Body) -> bool| bodies.iter().any(|body| has(body));
    let mut numbers = Vec::new();
    let absorbs = any(|body| body.sigma_a() != DVec3::ZERO);
    let scatters = any(|body| body.sigma_s() != DVec3::ZERO);
    if absorbs || scatters {
        numbers.push(number("density", "density", 0.1, |body, change| {
            body.medium = body.at_density(1.0 + change)?;
            Some(())
        }));
    }
    if absorbs && scatters {
        numbers.push(number("sigma_a", "sigma_a", 0.1, |body, change| {
            coefficients(body, body.sigma_a() * (1.0 + change), body.sigma_s())
        }));
        numbers.push(number("sigma_s", "sigma_s", 0.1, |body, change| {
            coefficients(body, body.sigma_a(), body.sigma_s() * (1.0 + change))
        }));
    } else if scatters {
        let albedo = number("albedo", "albedo", 0.05, |body, change| {
            let (sigma_a, sigma_s) = (body.sigma_a(), body.sigma_s());
            let moved = (sigma_a + sigma_s) * change;
            coefficients(body, sigma_a - moved, sigma_s + moved)
        });
        numbers.push(albedo.per(""));
    }
    if scatters
        && any(|body| body.medium.phase.is_isotropic() || body.medium.phase.mean_cosine() != 0.0)
    {
        let g = number("g", "g of the phase function", 0.1, |body, change| {
            let edit = |g: Asymmetry| Asymmetry::new(g.g() + change).unwrap_or(g);
            let phase = body.medium.phase.with_asymmetry(edit);
            let differs = phase != body.medium.phase || change == 0.0;
            body.medium.phase = phase;
            differs.then_some(())
        });
        numbers.push(g.per(""));
    }
    if any(|body| body.medium.emission != DVec3::ZERO) {
        let emission = number("emission", "emission", 0.5, |body, change| {
            body.medium.emission *= 1.0 + change;
            Some(())
        });
        numbers.push(emission.linear());
    }
    numbers
}

/// Parameters of the boundary of `body`, the medium `at`, a sphere or a box; none where it has a density, which has a
/// transform of its own.
fn of_boundary(body: &Body, at: usize) -> Vec<Number> {
    let is_mesh = |it: &Boundary| matches!(it, Boundary::Mesh(_) | Boundary::PlacedMesh(_));
    let boundary = body.boundary.as_ref().filter(|it| !is_mesh(it));
    let Some(boundary) = boundary.filter(|_| body.density.is_none()) else {
        return Vec::new();
    };
    let (size, centre) = (boundary.bounds().size(), boundary.bounds().centre());
    let step = 0.02 * size.max_element();
    let places = (0..3).map(|axis| {
        let names = along(["medium", "of the medium", "medium"], axis);
        let number = Number::radiative(names, step, move |scene, change| {
            let offset = DVec3::AXES[axis] * change;
            moved(scene, at, Transform::translation(offset).ok()?)
        });
        number.per("world units")
    });
    let mut numbers: Vec<Number> = places.collect();
    if !matches!(boundary, Boundary::Sphere(_)) {
        let words = "angle about the vertical axis of the medium";
        let names = ["medium.turn", words, "medium"];
        let turn = Number::radiative(names, 2.0, move |scene, change| {
            let turn = Transform::rotation(DVec3::Y, change).ok()?;
            moved(scene, at, turn.about(centre).ok()?)
        });
        numbers.push(turn.per("degrees"));
    }
    numbers
}

fn coefficients(body: &mut Body, sigma_a: DVec3, sigma_s: DVec3) -> Option<()> {
    body.medium.coefficients = Coefficients::new(sigma_a, sigma_s).ok()?;
    Some(())
}

fn moved(scene: &mut Radiative, at: usize, by: Transform) -> Option<()> {
    let boundary = scene.media.get_mut(at)?.boundary.as_mut()?;
    *boundary = boundary.clone().moved(&by);
    Some(())
}
