//! All orders of scattering in a sphere and a cube, and each order alone.

use crate::common::entries::Entry;
use crate::transport::all;
use crate::transport::scenes::*;
use crate::transport::statistics::*;
use glam::DVec3;
use volref::geometry::Ray;
use volref::scene::Radiative;

/// Standard errors of the sums between 0.2 and 0.5 %, of an order seldom above 3 %: the orders
/// fall by less than half from one to the next, so one turn too many or too few shows in all.
const SAMPLES: u32 = samples(40_000);

fn question(entry: &Entry) -> (Radiative, Ray) {
    let body = match entry.text("shape") {
        "sphere, radius 1, centre 0" => within(unit_ball(), grey_of(entry)),
        "cube [-1,1]^3" => cube_of(entry),
        unknown => panic!("{unknown}"),
    };
    let mut scene = Radiative {
        media: vec![body],
        ..empty()
    };
    match entry.text("light") {
        "uniform environment of radiance 1, seen directly behind the medium too" => {
            scene.environment = DVec3::ONE;
        }
        "directional" => {
            let travel = entry.vector("light_travel_direction");
            scene.lights = vec![sun(travel, DVec3::splat(entry.input("E0")))];
        }
        "point" => {
            let position = entry.vector("light_position");
            scene.lights = vec![lamp(position, entry.input("light_intensity"))];
        }
        unknown => panic!("{unknown}"),
    }
    (scene, ray_of(entry))
}

fn entries() -> Vec<Entry> {
    let text = include_str!("../../../fixtures/known-answers/volume_radiance.json");
    all(text, 8)
}

#[test]
fn all_orders() {
    for entry in entries() {
        let (scene, ray) = question(&entry);
        let white = Radiative {
            environment: DVec3::ONE,
            lights: vec![],
            ..scene.clone()
        };
        entry.is("transmittance", straight(&white, &ray).x);
        let [found, ..] = sampled(&scene, None, (entry.seed(41), SAMPLES), |_| ray);
        let error = entry.expected("L_std_err");
        agrees(entry.id(), &found, entry.expected("L"), error);
    }
}

#[test]
fn each_order() {
    for entry in entries() {
        let (scene, ray) = question(&entry);
        let orders = entry.answers("L_by_order");
        let errors = entry.answers("L_by_order_std_err");
        let found = by_order(
            &scene,
            orders.len() as u32 - 1,
            (entry.seed(42), SAMPLES),
            |_| ray,
        );
        for (order, (found, (expected, error))) in
            found.iter().zip(orders.into_iter().zip(errors)).enumerate()
        {
            let what = format!("{} order {order}", entry.id());
            agrees(what, found, expected, error);
            // No light is seen directly but the environment; what is turned once at most is an
            // integral, which the file knows to 9 digits and more; of varying densities, only
            // paths know it.
            let homogeneous = scene.media.iter().all(|body| body.density.is_none());
            if order == 1 && error == 0.0 && homogeneous {
                let exact = by_quadrature(&scene, &ray).x;
                assert!((exact - expected).abs() <= 1e-9 * expected, "{exact:e}");
            }
        }
    }
}
