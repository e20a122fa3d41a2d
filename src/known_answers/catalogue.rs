//! The catalogue of formulas.

use super::formula::Formula;
use super::{absorbing_grid, airlight, emission_absorption, furnace, half_space, lit_body, slab};

/// All formulas.
pub const CATALOGUE: &[Formula] = &[
    furnace::FURNACE,
    emission_absorption::EMISSION_ABSORPTION,
    absorbing_grid::ABSORBING_GRID,
    airlight::AIRLIGHT,
    lit_body::LIT_BODY,
    half_space::HALF_SPACE,
    slab::SLAB,
];

/// Names of all formulas.
pub const NAMES: [&str; CATALOGUE.len()] = {
    let mut names = [""; CATALOGUE.len()];
    let mut index = 0;
    while index < names.len() {
        names[index] = CATALOGUE[index].name;
        index += 1;
    }
    names
};

impl Formula {
    /// The formula called `name`.
    pub fn named(name: &str) -> Option<&'static Formula> {
        CATALOGUE.iter().find(|formula| formula.name == name)
    }
}
