//! No valid scene makes a pixel that is no radiance.

use super::scenes;
use glam::DVec3;
use proptest::prelude::*;
use volref::volume::Lattice;

proptest! {
    #![proptest_config(config(192))]

}

/// The brightest density whose square fits, and one beyond.
#[test]
fn radiance_beyond_the_film_is_refused() {
    let lattice = Lattice::new([2, 2, 2], DVec3::ONE, DVec3::ZERO).unwrap();
    let check =
        |density: f32| scenes::plain(scenes::sampled(lattice, |_| density)).check_brightness();
    // √(f32::MAX / 2) = 1.304e19.
    assert!(check(1.30e19).is_ok());
    assert!(check(1.31e19).is_err());
}
