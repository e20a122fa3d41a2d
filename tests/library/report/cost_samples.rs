//! Costs of accuracy from `costs.json`, as `volref cost --json` writes them: errors that fall as powers
//! of steps, and some that do not as they should.

use volref::cost::results::{Cost, ErrorPicture, Machine, Norms};
use volref::math;

/// The scenes of the file: one with everything, a small one, and one at the edge of what may come.
fn recorded() -> [Cost; 3] {
    serde_json::from_str(include_str!("costs.json")).unwrap()
}

/// Two scenes, one with everything.
pub fn costs() -> Vec<Cost> {
    let [mut full, small, _] = recorded();
    // JSON holds no pixels.
    for (picture, strength) in (full.studies[0].pictures.iter_mut()).zip([0.1, 0.026, 6.4e-3]) {
        draw(picture, strength);
    }
    vec![full, small]
}

/// One study of two sweeps, and nothing else: errors h², lookups 1/h.
pub fn small() -> Cost {
    let [_, small, _] = recorded();
    small
}

/// Values at the edge of what may come: errors that are zero or no number, work that was not
/// counted, sweeps of one setting or of none.
pub fn extremes() -> Cost {
    let [_, _, mut cost] = recorded();
    // JSON holds no such numbers.
    let study = &mut cost.studies[0];
    let norms = |l2: f64| Norms {
        l1: l2,
        l2,
        max: l2,
        uncertainty: f64::NAN,
    };
    for level in study.sweeps.iter_mut().flat_map(|sweep| &mut sweep.levels) {
        level.error = norms(level.error.l2);
    }
    study.sweeps[0].levels[0].error = norms(f64::NAN);
    study.sweeps[0].levels[1].error = norms(f64::INFINITY);
    for offer in study.prices.iter_mut().flat_map(|price| &mut price.offers) {
        offer.times_cheapest = offer.lookups.map(|lookups| lookups / 0.0);
    }
    cost
}

/// Signed errors like those of too few steps around a cloud.
fn draw(picture: &mut ErrorPicture, strength: f64) {
    let [columns, rows] = picture.size;
    let error = |at: usize| {
        let x = 2.0 * (at % columns) as f64 / columns as f64 - 1.0;
        let y = 2.0 * (at / columns) as f64 / rows as f64 - 1.0;
        let r2 = x * x + y * y;
        strength * math::exp(-4.0 * r2) * math::sin(14.0 * r2 + 3.0 * x)
    };
    picture.errors = (0..columns * rows).map(error).collect();
}

pub fn machine() -> Machine {
    Machine {
        processor: "AMD EPYC 9R14".to_owned(),
        threads: 1,
        platform: "linux x86_64".to_owned(),
        compiler: "rustc 1.89.0".to_owned(),
        profile: "release",
        target_features: "fxsr, sse, sse2".to_owned(),
    }
}
