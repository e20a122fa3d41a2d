//! Surfaces, media and lights: a path tracer, and integrals along the line of sight.
//!
//! [`PathTracer::radiance`](path_tracer::PathTracer::radiance) is the loop along one path,
//! [`LineOfSight::radiance`](line_of_sight::LineOfSight::radiance) the integral along one ray. An
//! estimator or a query is a struct around the [`scene_context`], named like its file. A file imports
//! only from files that stand later in this table:
//!
//! | files | hold |
//! |---|---|
//! | `kernels` | the renderers over the pixels of an image |
//! | [`path_tracer`], [`line_of_sight`] | the two renderers |
//! | `variance_reduction` | samplers of light that paths find rarely |
//! | `single_scattering`, `direct_light`, [`emission`], [`free_flight`], [`specular`] | their estimators |
//! | [`visibility`], [`transmittance`], `scattering_function`, `shadow_edges` |
//! queries of estimators to a scene |
//! | [`context`], [`tracker`] | the state passed to them: path, random numbers, memory, counters |
//! | [`scene_context`], [`segments`], `ray_majorants`, [`vertex`] | a scene and its media along a ray |
//! | [`media`], [`medium`], [`majorants`], [`surfaces`] | the media, surfaces and lights of a scene |
//! | [`sampler`], [`tracking`] | random numbers, tracking in general |

pub mod context;
mod direct_light;
pub mod emission;
pub(super) mod faulty_paths;
pub mod free_flight;
pub(super) mod kernels;
pub mod line_of_sight;
pub mod majorants;
pub mod media;
pub mod medium;
mod occluders;
pub mod path_tracer;
pub(crate) mod ray_majorants;
pub mod sampler;
mod scattering_function;
pub mod scene_context;
pub mod segments;
mod shadow_edges;
mod single_scattering;
pub mod specular;
pub mod surfaces;
pub mod tracker;
pub mod tracking;
pub mod transmittance;
mod variance_reduction;
pub mod vertex;
pub mod visibility;
