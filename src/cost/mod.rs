//! Cost of accuracy: sweeps of settings, error against time.
//!
//! Each parameter of a scene's approximations is swept from coarse to fine ([`study`]), each against a reference that
//! carries its own bound ([`collocation`](crate::optics::collocation)). [`rules`], [`marching`], [`jitter`], [`estimators`],
//! [`unbiased_ray_marching`] and [`preintegration`] are what is compared; the reference renderer is one of them. Orders of convergence are judged in [`order`]. What gates are counters and
//! errors, which repeat to the last bit; wall time is reported ([`timing`]) and never judged.

pub mod advice;
pub mod classified;
pub mod data;
pub mod effects;
pub mod estimators;
pub mod image;
pub mod jitter;
pub mod marching;
pub mod norms;
pub mod order;
pub mod pixels;
pub mod preintegration;
pub mod profile;
pub mod results;
pub mod rules;
pub mod samples;
mod scene;
pub mod study;
pub mod thumbnail;
pub mod timing;
pub mod transmittance;
pub mod unbiased_ray_marching;

pub use scene::{CostError, Options, cost};
