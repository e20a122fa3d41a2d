//! Samplers of light that a path finds rarely.
//!
//! Each samples, for a vertex or a ray, light whose contribution is large where the path seldom goes.
//! The path finds the same light by itself; both are weighted by multiple importance sampling, so that
//! every light is counted once. Without one of them the mean of an image is the same, and its noise
//! larger.
//!
//! | sampler | light |
//! |---|---|
//! | [`area_light_scattering`] | of area lights, scattered once in media along a ray |
//! | [`light_vertices`] | of lights without extent, scattered once before a vertex; [`light_vertex_shares`] choose between media and surfaces |
//! | [`guiding`] | scattered in fog around area lights |
//! | [`caustics`] | of area lights by way of a mirror or glass, from a vertex |
//! | [`lights_through_glass`] | of area lights by way of mirrors and glass, from the eye |
//!
//! [`specular_chain`] weights a path against the last two, [`specular_objects`] are what they aim at.
//! [Shadow edges](super::shadow_edges) and [equiangular sampling](super::single_scattering) stand
//! outside: integrals along the line of sight use them, too.

pub mod area_light_scattering;
pub mod caustics;
pub mod guiding;
pub mod light_vertex_shares;
pub mod light_vertices;
pub mod lights_through_glass;
pub mod specular_chain;
pub mod specular_objects;
