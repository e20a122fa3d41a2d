//! volref: a reference renderer for volumes, and the harness that judges others by it.

pub mod atomic_file;
pub mod compare;
pub mod math;
pub mod suite;
