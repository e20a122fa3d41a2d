//! The suite catches every mistake of the catalogue, and accepts what is right: the quick form of
//! `volref selftest`, on cases that catch them all together. `scripts/check.sh` runs it in release.

use std::cell::Cell;
use std::path::Path;
use volref::judging::{SelfTestCases, SelfTestExtent, Step, self_test, self_test_steps};
use volref::suite::{Store, Suite};

#[test]
#[ignore = "minutes without the optimisation of a release: scripts/check.sh runs it there"]
fn the_suite_catches_every_mistake() {
    let suite = Suite::open(Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap();
    let names = [
        "figures",
        "bricks",
        "scenes",
        "smoke",
        "fog/absorption",
        "fog/forward",
        "fog/balance",
        "fog/rate-0.1",
        "procedural/absorbing-grid",
        "procedural/emissive-grid",
        "procedural/coloured",
        "procedural/gain-0.6",
        "procedural/scale-2-0.5-2",
    ];
    let cases = suite.select(&names.map(str::to_owned)).unwrap();
    let store = Store::open(suite.golden_folder());
    let done = Cell::new(0);
    let told = |step: Step<'_>| done.set(done.get() + usize::from(step == Step::Done));
    let test = self_test(
        &cases,
        SelfTestCases::Whole,
        &store,
        SelfTestExtent::Quick,
        &told,
    );
    assert_eq!(done.get(), self_test_steps(cases.len()));
    assert!(test.mistakes.len() >= 40);
    assert_eq!(test.uncaught, Vec::<&str>::new(), "caught by no case");
    assert_eq!(test.broken_promises, Vec::<String>::new());
    for benign in &test.benign {
        assert!(benign.rejected.is_empty(), "{benign:?}");
        assert!(benign.accepted > 0, "{} was never tried", benign.variant);
    }
    assert!(test.passed(), "{:?}", test.unusable);
}
