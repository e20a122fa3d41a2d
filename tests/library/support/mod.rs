//! Image pairs and a second FLIP for the tests of FLIP.
#![allow(dead_code, reason = "every test takes what it needs")]

pub mod pairs;
pub mod plain_flip;
