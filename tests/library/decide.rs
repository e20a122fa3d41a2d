//! Looks at more and more samples raise no more false alarms than one look.

use crate::common::simulated::{Sampling, Shape, sampled, scene};
use volref::compare::stochastic::judge_at;
use volref::film::Film;
use volref::suite::share_of_look;

const SIDE: usize = 24;
const LOOKS: u32 = 6;

/// Noise shown to a renderer whose samples are doubled until it fails, or until a bias of 5 % would be
/// seen, six looks at most.
fn is_rejected(seed: u64, shape: &Shape, level: f64, states_noise: bool) -> bool {
    let sampling = |seed: u64, samples: u32| Sampling::of(shape, SIDE, samples, seed);
    let reference = sampled(sampling(2 * seed + 200_000, 512), scene);
    let mut films = vec![sampled(sampling(1000 * seed + 1, 8), scene)];
    for look in 1..=LOOKS {
        let test = match &films[..] {
            [one] => one.clone(),
            several if states_noise => Film::from_replicates(several).unwrap(),
            several => {
                let silent = several
                    .iter()
                    .map(|film| Film::new(SIDE, SIDE, film.radiance().to_vec()));
                Film::from_replicates(&silent.collect::<Vec<_>>()).unwrap()
            }
        };
        let judgement = judge_at(&reference, &test, level * share_of_look(look)).unwrap();
        if !judgement.passed {
            return true;
        }
        if judgement.metrics["smallest_visible_bias"] < 0.05 {
            return false;
        }
        let seed = 1000 * seed + 10 * u64::from(look);
        if states_noise {
            films.push(sampled(sampling(seed, 8 << (look - 1)), scene));
        } else {
            // Sixteen new ones, of more samples each time.
            let fresh = (0..16).map(|i| sampled(sampling(seed + 100 * i + 1, 1 << look), scene));
            films = fresh.collect();
        }
    }
    false
}

/// At levels at which alarms are rare and at which they are not: no more suites are rejected than one
/// look is promised to reject, by four standard deviations of their number.
#[test]
fn adaptive_looks_keep_the_promise_of_one() {
    let shapes = Shape::all();
    let suites = 1000;
    for (level, states_noise) in [(0.2, true), (0.02, true), (0.2, false)] {
        let alarms = (0..suites)
            .filter(|&suite| {
                let shape = &shapes[suite as usize % shapes.len()];
                is_rejected(suite, shape, level, states_noise)
            })
            .count();
        let expected = level * suites as f64;
        let most = expected + 4.0 * expected.sqrt();
        assert!(
            alarms as f64 <= most,
            "{alarms} alarms at {level}, {states_noise}"
        );
    }
}
