//! Two images to a difference.

pub mod flip;
