//! The estimator of a pixel's radiance.

use super::Reason;
use serde::Serialize;
use std::fmt;

/// The estimator of a plan: the cheapest that is exact for the scene, with the reason.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Estimator {
    /// The method.
    pub method: Method,
    /// The reason why nothing simpler suffices, or why nothing more is needed.
    #[serde(flatten)]
    pub why: Reason,
}

/// A method to estimate the radiance of a pixel, the cheapest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// A drawing of the transfer function.
    Plot,
    /// The background, everywhere.
    Background,
    /// Compositing of samples along the ray through the pixel's centre.
    RayCasting,
    /// A closed form on each segment of that ray; through a grid, cell by cell.
    ClosedForm,
    /// An integral along that ray, to a tolerance.
    Quadrature,
    /// The mean of random paths through the pixel.
    PathTracing,
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Method::Plot => "plot",
            Method::Background => "background",
            Method::RayCasting => "ray casting",
            Method::ClosedForm => "closed form",
            Method::Quadrature => "quadrature",
            Method::PathTracing => "path tracing",
        })
    }
}
