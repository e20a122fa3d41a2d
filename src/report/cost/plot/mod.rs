//! What accuracy costs, drawn: SVG that needs neither fonts nor network.
//!
//! Each kind of plot says in a [`picture`] what is to be seen; [`draw`] draws all of them.

mod axis;
mod draw;
mod jitter;
mod labels;
mod orders;
mod picture;
mod ray;
mod stroke;
mod thickness;
mod work_precision;

pub(super) use jitter::jitter;
pub(super) use orders::orders;
pub(super) use ray::ray;
pub(super) use stroke::Theme;
pub(super) use thickness::thickness;
pub(super) use work_precision::work_precision;

use crate::cost::results::Study;
use serde::Serialize;

/// A drawing, and what it could not show.
#[derive(Serialize)]
pub(super) struct Plot {
    pub(super) svg: String,
    pub(super) notes: Vec<String>,
}

/// The work–precision diagram of a study as an SVG file of its own: on white, 800 wide.
pub fn work_precision_svg(study: &Study) -> String {
    work_precision(study, Theme::Standalone).svg
}
