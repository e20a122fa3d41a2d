//! Absorption by a grid whose density is multilinear.
//!
//! Trilinear interpolation reproduces every function that is linear in each of x, y and z: where the
//! nodes hold one, so does all of the box, with whatever spacing. Along a line such a density is a
//! cubic polynomial, whose integral over a length s is, by Simpson's rule exactly,
//! `s/6 · (ρ(near) + 4 ρ(middle) + ρ(far))`. The eye sees the environment times `e^(−σ_a ∫ρ dt)`.
//!
//! The eight corners of the grid give the function; that all other nodes hold it is checked.
//!
//! Source: Lambert 1760, *Photometria*; Simpson's rule is exact for cubics, Davis & Rabinowitz 1984,
//! *Methods of Numerical Integration*, §2.2.

use super::bodies::Convex;
use super::formula::{AlongRay, Formula, transmittance};
use super::requirements::{
    absorbing, dark, only_medium, require, without_lights, without_surfaces,
};
use crate::math::quadrature::Integral;
use crate::optics::Field;
use crate::scene::Radiative;
use crate::volume::{Centring, GridDensity, Interpolation};
use glam::DVec3;

/// A grid of a multilinear density that absorbs.
pub const ABSORBING_GRID: Formula = Formula {
    name: "absorbing-grid",
    what: "A trilinear grid that absorbs the light of the environment, its nodes linear in x, y and z \
           each: Simpson's rule is exact along a ray.",
    of,
};

/// Nodes are numbers of 32 bits: by how much they may be off the function, relative to its largest
/// value.
const ROUNDING: f64 = f32::EPSILON as f64 / 2.0;

fn of(scene: &Radiative) -> Result<AlongRay<'_>, String> {
    without_surfaces(scene)?;
    without_lights(scene)?;
    let body = only_medium(scene)?;
    dark(&body.medium)?;
    absorbing(&body.medium.coefficients)?;
    let density = body.density.as_ref();
    let Some(Field::Grid(grid)) = density.map(|density| density.field()) else {
        return Err("its medium has no grid".to_owned());
    };
    let bounds = grid.bounds();
    let density = Multilinear::of(grid)?;
    let shape = Convex::Cuboid {
        min: bounds.min,
        max: bounds.max,
    };
    let sigma = body.medium.coefficients.sigma_a();
    Ok(Box::new(move |ray| {
        let mut depth = 0.0;
        if let Some([near, far]) = shape.span(ray.origin, *ray.direction) {
            let at = |t: f64| density.at(ray.origin + *ray.direction * t);
            let sum = at(near) + 4.0 * at(0.5 * (near + far)) + at(far);
            depth = (far - near) / 6.0 * sum;
        }
        let value = transmittance(sigma * depth) * scene.environment;
        // A relative error of the depth is one of the radiance times that depth.
        let error = value * sigma * depth * (2.0 * ROUNDING);
        Ok(Integral {
            value,
            error: error.max_element(),
        })
    }))
}

/// A function linear in x, y and z each, by its values at the corners of a box, x fastest.
struct Multilinear {
    min: DVec3,
    size: DVec3,
    corners: [f64; 8],
}

impl Multilinear {
    fn of(grid: &GridDensity) -> Result<Multilinear, String> {
        let lattice = grid.grid().lattice();
        let values = grid.grid().values();
        let [nx, ny, nz] = lattice.nodes();
        require(
            grid.interpolation() == Interpolation::Trilinear
                && lattice.centring() == Centring::Nodes
                && nx.min(ny).min(nz) >= 2,
            "its grid is not trilinear between nodes on the faces of its box",
        )?;
        let corner = |i: usize| {
            let node = [
                (i & 1) * (nx - 1),
                (i >> 1 & 1) * (ny - 1),
                (i >> 2) * (nz - 1),
            ];
            f64::from(values[lattice.index(node)])
        };
        let bounds = lattice.bounds();
        let density = Multilinear {
            min: bounds.min,
            size: bounds.size(),
            corners: std::array::from_fn(corner),
        };
        let largest = values.iter().copied().fold(0.0, f32::max);
        for (index, &value) in values.iter().enumerate() {
            let node = lattice.node(index);
            let expected = density.at(lattice.position(node));
            let off = (f64::from(value) - expected).abs();
            if off > 2.0 * ROUNDING * f64::from(largest) {
                return Err(format!(
                    "node {node:?} of its grid holds {value}, and between its corners lies {expected}"
                ));
            }
        }
        Ok(density)
    }

    fn at(&self, point: DVec3) -> f64 {
        let share = (point - self.min) / self.size;
        let mut sum = 0.0;
        for (i, corner) in self.corners.iter().enumerate() {
            let weight = |axis: usize| {
                if i >> axis & 1 == 1 {
                    share[axis]
                } else {
                    1.0 - share[axis]
                }
            };
            sum += corner * weight(0) * weight(1) * weight(2);
        }
        sum
    }
}
