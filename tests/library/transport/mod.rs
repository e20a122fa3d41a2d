//! Light in surfaces and media against numbers from outside: integrals along the line of sight to
//! the digits they are known to, sampled paths within four standard errors.
//!
//! All entries of six files are asked: `single_scatter`, `slab_total`, `slab_radiance`,
//! `semi_infinite`, `volume_radiance` and `furnace`; hard cases S4, S8 and S10 at greater length than
//! in the catalogue; and what follows from the equation alone: media add up where they overlap, and what is null changes no bit.
//!
//! Every seed is fixed, so nothing fails by chance. Each comparison prints how many standard
//! errors it was off: `cargo test --test library transport:: -- --nocapture | grep '^z'`.

mod scenes;
mod statistics;

mod furnaces;
mod half_space;
mod heterogeneous;
mod overlaps;
mod single_scattering;
mod slab_radiance;
mod slab_totals;
mod spheres_and_cubes;

use crate::common::entries::Entry;

/// Half a unit in the last place of 1: the largest relative error of one rounding.
const U: f64 = f64::EPSILON / 2.0;

/// The entries of a file; there are `count` of them.
fn all(text: &str, count: usize) -> Vec<Entry> {
    let entries = Entry::all(text);
    assert_eq!(entries.len(), count);
    entries
}
