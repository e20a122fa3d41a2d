//! volref: a reference renderer for volumes, and the harness that judges others by it.

pub mod compare;
pub mod geometry;
pub mod math;
pub mod media;
pub mod volume;
