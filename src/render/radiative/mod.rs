//! Surfaces, media and lights: a path tracer, and integrals along the line of sight.
//!
//! [`PathTracer::radiance`](path_tracer::PathTracer::radiance) is the loop along one path.

pub mod context;
pub mod direct_light;
pub mod effects;
pub mod emission;
pub mod free_flight;
pub mod intersection;
pub(super) mod kernels;
pub mod light_vertices;
pub mod line_of_sight;
pub mod majorants;
pub mod media;
pub mod medium;
pub mod path_tracer;
pub mod ray_majorants;
pub mod sampler;
pub mod scattering;
pub mod scene_context;
pub mod segments;
pub mod shadow_edges;
pub mod single_scattering;
pub mod specular;
pub mod tracker;
pub mod tracking;
pub mod transmittance;
pub mod vertex;
pub mod visibility;
