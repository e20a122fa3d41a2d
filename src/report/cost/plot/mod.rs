//! Plots of the cost of accuracy: SVG that needs neither fonts nor network.
//!
//! Each kind of plot puts together a [`figure`]; [`draw`] draws all of them by [`svg`].

mod axis;
mod draw;
mod figure;
mod labels;
mod orders;
mod ray;
mod svg;
mod thickness;
mod work_precision;

pub(super) use orders::{jitter, orders};
pub(super) use ray::ray;
pub(super) use svg::Theme;
pub(super) use thickness::thickness;
pub(super) use work_precision::work_precision;

use crate::cost::results::Study;
use serde::Serialize;

/// A drawing, and notes on the data that it could not show.
#[derive(Serialize)]
pub(super) struct Plot {
    pub(super) svg: String,
    pub(super) notes: Vec<String>,
}

/// The work–precision diagram of a study as an SVG file of its own: on white, 800 wide.
pub fn work_precision_svg(study: &Study) -> String {
    work_precision(study, Theme::Standalone).svg
}
