//! Light in surfaces and media against numbers from outside: integrals along the line of sight to
//! the digits they are known to, sampled paths within four standard errors.
//!
//! All entries of six files are asked: `single_scatter`, `slab_total`, `slab_radiance`,
//! `semi_infinite`, `volume_radiance` and `furnace`; hard cases S4 to S8 and S10; and what follows
//! from the equation alone: media add up where they overlap, and what is null changes no bit.
//!
//! Every seed is fixed, so nothing fails by chance. Each comparison prints how many standard
//! errors it was off: `cargo test --test transport -- --nocapture | grep '^z'`.

#[allow(dead_code, reason = "each test program asks for a part of it")]
#[path = "../common/entries.rs"]
mod entries;
#[path = "../common/quadrature.rs"]
mod quadrature;
mod scenes;
mod statistics;

mod furnaces;
mod half_space;
mod null_effects;
mod overlaps;
mod single_scattering;
mod slab_radiance;
mod slab_totals;
mod spheres_and_cubes;

use entries::Entry;

/// Half a unit in the last place of 1: the largest relative error of one rounding.
const U: f64 = f64::EPSILON / 2.0;

/// The entries that cannot be rendered: heterogeneous media, not yet. Of the other entries about
/// them, the exponential atmospheres of `single_scatter` are slabs by their optical depth, and
/// those of `transmittance` and `free_flight` are closed forms.
const HETEROGENEOUS: [&str; 4] = [
    "furnace-p003",
    "furnace-p004",
    "volume_radiance-p007",
    "volume_radiance-p008",
];

/// The entries of a file that can be rendered; `all` are in it.
fn renderable(text: &str, all: usize) -> Vec<Entry> {
    let mut entries = Entry::all(text);
    assert_eq!(entries.len(), all);
    entries.retain(|entry| !HETEROGENEOUS.contains(&entry.id()));
    entries
}

/// The list above holds what it says, no less and no more.
#[test]
fn what_cannot_be_rendered_is_heterogeneous() {
    let files = [
        include_str!("../../fixtures/known-answers/furnace.json"),
        include_str!("../../fixtures/known-answers/volume_radiance.json"),
    ];
    let entries = files.into_iter().flat_map(Entry::all);
    let heterogeneous = entries.filter(|entry| {
        let density = entry.0["inputs"]["density"].as_str();
        density.is_some_and(|density| density != "homogeneous")
    });
    let ids: Vec<_> = heterogeneous.map(|entry| entry.id().to_owned()).collect();
    assert_eq!(ids, HETEROGENEOUS);
}
