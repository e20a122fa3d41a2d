//! Scenes in code.

use crate::common::entries::Entry;
use crate::transport::U;
use glam::DVec3;
use std::sync::Arc;
use volref::geometry::{Aabb, Boundary, Camera, Direction, Ray, Rectangle, Shape, Sphere};
use volref::math::{cos, sin};
use volref::optics::{
    Asymmetry, Coefficients, Density, Directional, Field, Homogeneous, Light, Material, Phase,
    Point,
};
use volref::scene::{Body, Object, Radiative, Scattering};
use volref::volume::{Blob, Grid, GridDensity, Interpolation, Lattice};

/// A scene of nothing. Its camera is not used: every ray is given.
pub fn empty() -> Radiative {
    Radiative {
        scattering: Scattering::Multiple(None),
        objects: vec![],
        area_lights: vec![],
        media: vec![],
        lights: vec![],
        environment: DVec3::ZERO,
        camera: Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 1.0).unwrap(),
        samples: 1,
        seed: 0,
    }
}

/// A medium that is the same in all channels.
pub fn grey(sigma_t: f64, albedo: f64, g: f64) -> Homogeneous {
    let sigma_s = sigma_t * albedo;
    Homogeneous {
        coefficients: Coefficients::new(DVec3::splat(sigma_t - sigma_s), DVec3::splat(sigma_s))
            .unwrap(),
        emission: DVec3::ZERO,
        phase: Phase::henyey_greenstein(Asymmetry::new(g).unwrap()),
    }
}

/// The medium that an entry describes by `sigma_t` or `sigma0`, `albedo` and `g`.
pub fn grey_of(entry: &Entry) -> Homogeneous {
    let sigma_t = entry.given("sigma_t");
    let sigma_t = sigma_t.unwrap_or_else(|| entry.input("sigma0"));
    grey(sigma_t, entry.input("albedo"), entry.input("g"))
}

/// `medium` with the emission of a body in thermal equilibrium with radiance `source`.
pub fn emissive(medium: Homogeneous, source: f64) -> Homogeneous {
    Homogeneous {
        emission: medium.coefficients.sigma_a() * source,
        ..medium
    }
}

pub fn within(boundary: Boundary, medium: Homogeneous) -> Body {
    Body {
        boundary: Some(boundary),
        medium,
        density: None,
    }
}

/// A medium that fills the cube from −1 to 1, in the density that an entry describes.
pub fn cube_of(entry: &Entry) -> Body {
    let density = entry.text("density").split(':').next().unwrap();
    let parameters = |name: &str| match entry.0["inputs"]["density_parameters"].as_array() {
        Some(_) => entry.inputs("density_parameters"),
        None if name == "w" => vec![entry.input(name)],
        None => entry.inputs(name),
    };
    let field = match density {
        "homogeneous" => None,
        // The corners of one cell say all about a linear density.
        "linear" => {
            let a = DVec3::from_slice(&parameters("a"));
            let lattice = Lattice::new([2; 3], DVec3::splat(2.0), DVec3::NEG_ONE).unwrap();
            let corner = |index| (1.0 + a.dot(lattice.position(lattice.node(index)))) as f32;
            let grid = Grid::new(lattice, (0..8).map(corner).collect()).unwrap();
            Some(Field::Grid(GridDensity::new(
                Arc::new(grid),
                Interpolation::Trilinear,
            )))
        }
        "gaussian" => Some(Field::Blob(Blob {
            centre: DVec3::ZERO,
            peak: 1.0,
            width: parameters("w")[0],
        })),
        unknown => panic!("{unknown}"),
    };
    let medium = grey_of(entry);
    match field {
        None => within(cube(), medium),
        Some(field) => heterogeneous(
            Aabb::new(DVec3::NEG_ONE, DVec3::ONE).unwrap(),
            field,
            medium,
        ),
    }
}

/// A medium in a box, with a density of its own.
pub fn heterogeneous(bounds: Aabb, field: Field, medium: Homogeneous) -> Body {
    Body {
        density: Some(Density::new(field, bounds, None)),
        ..within(Boundary::Box(bounds), medium)
    }
}

pub fn everywhere(medium: Homogeneous) -> Body {
    Body {
        boundary: None,
        medium,
        density: None,
    }
}

pub fn cuboid(min: DVec3, max: DVec3) -> Boundary {
    Boundary::Box(Aabb::new(min, max).unwrap())
}

/// The cube from −1 to 1.
pub fn cube() -> Boundary {
    cuboid(DVec3::NEG_ONE, DVec3::ONE)
}

pub fn ball(centre: DVec3, radius: f64) -> Boundary {
    Boundary::Sphere(Sphere::new(centre, radius).unwrap())
}

/// The sphere of radius 1 around 0.
pub fn unit_ball() -> Boundary {
    ball(DVec3::ZERO, 1.0)
}

pub fn ray(origin: DVec3, towards: DVec3) -> Ray {
    Ray::new(origin, towards).unwrap()
}

/// Media lit by a sun, a lamp above the cube, and from all around.
pub fn lit(media: Vec<Body>) -> Radiative {
    Radiative {
        media,
        lights: vec![
            sun(DVec3::new(0.3, -1.0, -0.4), DVec3::ONE),
            lamp(DVec3::new(0.5, 1.8, 0.4), 2.0),
        ],
        environment: DVec3::splat(0.3),
        ..empty()
    }
}

/// A ray that looks into the cube, aslant.
pub fn into_the_middle() -> Ray {
    ray(DVec3::new(1.0, 0.7, 4.0), DVec3::new(-0.25, -0.1, -1.0))
}

/// The ray that an entry gives by `origin` and `direction`.
pub fn ray_of(entry: &Entry) -> Ray {
    ray(entry.vector("origin"), entry.vector("direction"))
}

/// Light that travels along `travel`.
pub fn sun(travel: DVec3, irradiance: DVec3) -> Light {
    Light::Directional(Directional {
        direction: Direction::unit(travel.normalize()),
        irradiance,
    })
}

pub fn lamp(position: DVec3, intensity: f64) -> Light {
    Light::Point(Point {
        position,
        intensity: DVec3::splat(intensity),
    })
}

pub fn object(shape: Shape, material: Material) -> Object {
    Object { shape, material }
}

pub fn black() -> Material {
    Material::Diffuse(DVec3::ZERO)
}

/// A rectangle perpendicular to the z axis that reaches so far from it on all sides.
pub fn plane(height: f64, reach: f64) -> Rectangle {
    let centre = DVec3::new(0.0, 0.0, height);
    Rectangle::new(
        centre - (DVec3::X + DVec3::Y) * reach,
        DVec3::X * (2.0 * reach),
        DVec3::Y * (2.0 * reach),
    )
    .unwrap()
}

/// Where a slab leaves off, in thicknesses. Light that flies farther than that inside it must be
/// within 1e-6 of horizontal.
pub const REACH: f64 = 1e6;

/// A slab of thickness 1 between z = 0 and its upper face, z = 1.
pub fn slab(tau: f64, albedo: f64, g: f64) -> Radiative {
    let reach = DVec3::new(REACH, REACH, 0.0);
    let bounds = cuboid(-reach, reach + DVec3::Z);
    Radiative {
        media: vec![within(bounds, grey(tau, albedo, g))],
        ..empty()
    }
}

/// The slab of an entry.
pub fn slab_of(entry: &Entry) -> Radiative {
    slab(
        entry.input("tau"),
        entry.given("albedo").unwrap_or(1.0),
        entry.input("g"),
    )
}

/// A face of a slab.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// The one that lights shine on, z = 1.
    Upper,
    /// The other, z = 0.
    Lower,
}

/// The ray that looks into a slab from a point of a face of it, against light that leaves there
/// with the cosine `mu`, and travels in the direction of x as far as it travels horizontally.
pub fn leaving(face: Face, mu: f64) -> Ray {
    let (height, up) = match face {
        Face::Upper => (1.0, 1.0),
        Face::Lower => (0.0, -1.0),
    };
    let travel = tilted(mu, 0.0) * DVec3::new(1.0, 1.0, up);
    ray(DVec3::new(0.0, 0.0, height), -travel)
}

/// Light that shines on the upper face of a slab with the cosine `mu0`, its azimuth being
/// `phi_deg` away from that of [`leaving`] light.
pub fn shining(mu0: f64, phi_deg: f64, irradiance: DVec3) -> Light {
    let travel = tilted(mu0, phi_deg) * DVec3::new(1.0, 1.0, -1.0);
    Light::Directional(Directional {
        direction: Direction::unit(travel),
        irradiance,
    })
}

/// The upward direction with the cosine `mu` from the z axis and that azimuth.
fn tilted(mu: f64, phi_deg: f64) -> DVec3 {
    let sine = ((1.0 - mu) * (1.0 + mu)).sqrt();
    let phi = phi_deg.to_radians();
    // The rounded quarter turn has a cosine, and the rounded half turn a sine: of no digits.
    let clean = |x: f64| if x.abs() < 4.0 * U { 0.0 } else { x };
    DVec3::new(sine * clean(cos(phi)), sine * clean(sin(phi)), mu)
}
