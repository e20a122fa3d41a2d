//! volref: a reference renderer for volumes, and the harness that judges others by it.

pub mod atomic_file;
pub mod cli;
pub mod compare;
pub mod film;
pub mod geometry;
pub mod math;
pub mod media;
pub mod render;
pub mod report;
pub mod scene;
pub mod suite;
pub mod volume;
