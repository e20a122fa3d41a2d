//! A volume that an affine map places in the world: turned, scaled unevenly, sheared or mirrored.
//!
//! The map takes a point `u` of the volume, in which its grid stands along the axes, to the point `x`
//! of the world. A ray of the world, with the distance `t` along its unit direction `d`, is a line in
//! the volume, too:
//!
//! ```text
//! x = M u + o,     x(t) = e + t d     ⇒     u(t) = M⁻¹(e − o) + t M⁻¹d
//! ```
//!
//! `M⁻¹d` is not made a unit vector: `t` stays the distance in the world, in which steps and the lengths
//! of opacities are measured. Lookups at `u` are as without a map. The gradient of
//! `f` by `x` follows from that by `u` by the chain rule, and the normal points against it:
//!
//! ```text
//! f(x) = g(M⁻¹(x − o))     ⇒     ∇ₓf = M⁻ᵀ ∇ᵤg,     n = −∇ₓf / |∇ₓf|
//! ```
//!
//! Eye, light and shading are of the world. Gradients are stored at the nodes, of the world, up to a
//! common factor.
//!
//! Sources: Turkowski 1990, "Properties of surface-normal transformations", Graphics Gems;
//! Schroeder, Martin & Lorensen 2006, "The Visualization Toolkit" (volumes with a matrix of their own).

use crate::geometry::{Line, Ray};
use crate::scene::Classified;
use crate::volume::{Grid, placed_gradients, relative_gradients};

/// `ray` in the coordinates of the volume, by distances of the world.
pub(super) fn in_volume(scene: &Classified, ray: &Ray) -> Line {
    match &scene.to_world {
        None => ray.into(),
        Some(map) => map.line_to_object(ray),
    }
}

/// Density gradients of the world at the nodes of the grid, all scaled by one factor.
pub(super) fn gradients(scene: &Classified) -> Grid<[f32; 3]> {
    match &scene.to_world {
        None => relative_gradients(&*scene.grid),
        Some(map) => placed_gradients(&*scene.grid, map),
    }
}
