//! Any valid scene makes an image or a clear refusal: no panic, no NaN, no negative radiance, no
//! work without end.
//!
//! `VOLREF_SCENES` is how many scenes are tried, `VOLREF_SCENES_SEED` which: by default always
//! the same, so that a change is judged by what it changes.

mod bounds;
mod check;
pub mod choices;
mod found;
pub mod scenes;

use crate::common;
use crate::common::watch;
use check::{Outcome, check, pools};
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestCaseError, TestRunner};
use std::cell::RefCell;
use std::time::Duration;

/// Scenes tried unless `VOLREF_SCENES` asks for another number.
const SCENES: u32 = 1_000;

/// Longest time for one scene. Those that are rendered take milliseconds; the bounds of their work,
/// seconds.
const PATIENCE: Duration = Duration::from_secs(300);

#[test]
fn any_valid_scene_makes_an_image_or_is_refused() {
    let number = |name: &str| std::env::var(name).ok()?.parse::<u64>().ok();
    let scenes = number("VOLREF_SCENES").map_or(SCENES, |scenes| scenes as u32);
    let config = ProptestConfig {
        cases: scenes,
        rng_seed: RngSeed::Fixed(number("VOLREF_SCENES_SEED").unwrap_or(1)),
        max_shrink_iters: 4096,
        ..common::failures_in("fixtures/proptest-regressions/any_scene.txt")
    };
    let folder = tempfile::tempdir().unwrap();
    let pools = pools();
    let outcomes = RefCell::new(Vec::new());
    let lists = prop::collection::vec(any::<u32>(), 0..400);
    let written = lists.prop_map(|list| scenes::written(&list));
    let result = TestRunner::new(config).run(&written, |written| {
        let _watched = watch::during(&written.text, PATIENCE);
        let outcome = check(&written, folder.path(), &pools).map_err(TestCaseError::fail)?;
        outcomes.borrow_mut().push(outcome);
        Ok(())
    });
    if let Err(error) = result {
        panic!("{error}");
    }
    let outcomes = outcomes.into_inner();
    let share = |wanted: Outcome| {
        let such = outcomes.iter().filter(|outcome| **outcome == wanted);
        such.count() as f64 / outcomes.len() as f64
    };
    use Outcome::{NotShown, Refused, Shown, TooLong};
    for outcome in [Refused, TooLong, NotShown, Shown] {
        println!("{outcome:?}: {:.1} % of {scenes}", 100.0 * share(outcome));
    }
    // Were most refused, or none, that would say little of rendering, or of refusing.
    assert!(share(Shown) > 0.4 && share(Refused) > 0.1);
}
