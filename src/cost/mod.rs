//! What accuracy costs: ladders of settings, error against time.

pub mod preintegration;
pub mod unbiased_ray_marching;
