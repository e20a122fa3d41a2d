//! What accuracy costs: ladders of settings, error against time.

pub mod results;
