//! The stochastic gate against the pairs it must reject and the noise it must accept.

use crate::common::simulated;
use crate::common::suite::silent;
use volref::compare::stochastic::{FALSE_ALARM, judge, judge_at};
use volref::compare::{
    self, Advice, Conditions, Gate, Judgement, Picture, PictureError, Promise, Undecided,
    metric_meaning,
};
use volref::film::{Encoding, Film, Origin, Quantisation};
use volref::math::rng::{Purpose, Stream};
use volref::math::{Moments, ln};

const SIDE: usize = 48;

/// One comparison by which a bias of the mean of `promise` is to be seen.
fn promising(reference: &Film, test: &Film, promise: f64) -> Judgement {
    keeping(reference, test, Promise::of_mean(promise))
}

/// One comparison by which what `promise` says is to be seen.
fn keeping(reference: &Film, test: &Film, promise: Promise) -> Judgement {
    let [reference, test] = [reference, test].map(|film| Picture::Radiance(film.clone()));
    let conditions = Conditions {
        promise: Some(promise),
        ..Conditions::default()
    };
    compare::judge(Gate::Stochastic, &reference, &test, &conditions).unwrap()
}

/// What is seen without noise: a ball on black, a gradient below it.
fn truth(index: usize) -> [f64; 3] {
    let (x, y) = ((index % SIDE) as f64, (index / SIDE) as f64);
    let (dx, dy) = ((x - 18.0) / 15.0, (y - 14.0) / 12.0);
    let light = (1.0 - dx * dx - dy * dy).max(0.0) + if y >= 30.0 { x / 60.0 } else { 0.0 };
    [0.9 * light, 0.5 * light, 0.2 * light]
}

/// The shape of the noise: a random factor of mean 1 for a number uniform in [0, 1).
type SampleShape = fn(f64) -> f64;

fn even(u: f64) -> f64 {
    0.5 + u
}

fn exponential(u: f64) -> f64 {
    -ln(1.0 - u)
}

/// One sample in twenty meets a light.
fn rare(u: f64) -> f64 {
    if u < 0.05 { 20.0 } else { 0.0 }
}

/// Means of `samples` samples of `truth` under noise, and their variances.
fn sampled(seed: u64, samples: u32, shape: SampleShape, truth: impl Fn(usize) -> [f64; 3]) -> Film {
    let (mut means, mut variances) = (Vec::new(), Vec::new());
    for index in 0..SIDE * SIDE {
        let mut moments = Moments::default();
        for sample in 0..samples {
            let stream = Stream::new(seed, index as u32, sample);
            moments.add(shape(stream.uniform(0, Purpose::Camera, 0)));
        }
        let truth = truth(index);
        means.push(truth.map(|value| (value * moments.mean()) as f32));
        let variance = moments.variance_of_mean().unwrap();
        variances.push(truth.map(|value| (value * value * variance) as f32));
    }
    Film::with_noise(SIDE, SIDE, means, variances, samples)
}

/// The film with another value in every pixel, and its own variances.
fn edited(film: &Film, edit: impl Fn(usize, [f32; 3]) -> [f32; 3]) -> Film {
    simulated::edited(film, |x, y, pixel| edit(x + film.width() * y, pixel))
}

/// Codes of 8 bits, with the noise that is stated.
fn in_codes(film: &Film) -> Film {
    let codes = Quantisation {
        encoding: Encoding::Linear,
        exposure: 0.0,
        origin: Origin::Declared,
        blended: false,
    };
    let noise = film.noise().unwrap();
    let variance = Film::new(SIDE, SIDE, noise.variance().to_vec());
    let rounded = codes.rounded(film);
    rounded
        .with_variance_of(&variance, noise.samples())
        .unwrap()
}

/// An image of 8 bits with more samples than its reference, near the largest code.
#[test]
fn what_a_finer_image_cuts_off_is_left_out() {
    let slope = |index: usize| {
        let x = (index % SIDE) as f64 / SIDE as f64;
        [0.2 + 0.9 * x, 0.5, 0.2 + 0.5 * x]
    };
    for shape in [even, exponential] {
        for seed in 0..8 {
            let reference = sampled(100 + seed, 64, shape, slope);
            for samples in [128, 1024] {
                let test = in_codes(&sampled(seed, samples, shape, slope));
                let judgement = assert_passes(&format!("{samples}"), &reference, &test);
                assert!(judgement.metrics["share_cut_off"] > 0.05);
            }
        }
    }
    // A lamp that the largest code would hold.
    let lamp = |radiance: f64| {
        move |index: usize| match [index % SIDE, index / SIDE] {
            [8..16, 8..16] => [radiance; 3],
            _ => [0.4; 3],
        }
    };
    let reference = sampled(1, 64, even, lamp(3.0));
    let [right, dim] = [3.0, 0.5].map(|radiance| sampled(2, 1024, even, lamp(radiance)));
    assert_passes("", &reference, &in_codes(&right));
    assert_test_rejected("dim", &reference, &in_codes(&dim), "too dark");
}

fn judged(reference: &Film, test: &Film) -> Judgement {
    let judgement = judge(reference, test, 1).unwrap();
    assert_eq!(judgement.gate.name(), "stochastic");
    for name in judgement.metrics.keys() {
        assert!(metric_meaning(name).is_some(), "{name} has no meaning");
    }
    assert!(judgement.metrics.values().all(|value| value.is_finite()));
    judgement
}

/// The judgement, which passes.
fn assert_passes(what: &str, reference: &Film, test: &Film) -> Judgement {
    let judgement = judged(reference, test);
    assert!(judgement.passed, "{what}: {}", judgement.reason);
    judgement
}

/// The judgement, which says nothing of black pixels.
fn assert_nothing_is_black(reference: &Film, test: &Film) {
    let reason = judged(reference, test).reason;
    assert!(!reason.contains("is black"), "{reason}");
}

/// Bias of the mean of the image that would have been seen.
fn mean_resolution(judgement: &Judgement) -> f64 {
    judgement.metrics["smallest_visible_bias"]
}

/// Bias of a block that would have been seen.
fn block_resolution(judgement: &Judgement) -> f64 {
    judgement.metrics["smallest_visible_block_bias"]
}

/// Of faults in what the test image states, which are not looked for in the reference.
fn assert_test_rejected(fault: &str, reference: &Film, test: &Film, word: &str) {
    let judgement = judged(reference, test);
    let is_said = !judgement.passed && judgement.reason.contains(word);
    assert!(is_said, "{fault}: {}", judgement.reason);
}

fn assert_rejected(fault: &str, reference: &Film, test: &Film, word: &str) {
    for (reference, test) in [(reference, test), (test, reference)] {
        let judgement = judged(reference, test);
        assert!(!judgement.passed, "{fault}: {}", judgement.reason);
        assert!(
            judgement.reason.contains(word),
            "{fault}: {}",
            judgement.reason
        );
    }
}

#[test]
fn honest_noise_passes() {
    let shapes: [(&str, SampleShape, u32); 5] = [
        ("even", even, 2),
        ("even", even, 64),
        ("exponential", exponential, 4),
        ("exponential", exponential, 100),
        ("rare light", rare, 16),
    ];
    for (name, shape, samples) in shapes {
        for seed in 0..6 {
            let reference = sampled(1000 + seed, 256, shape, truth);
            let test = sampled(seed, samples, shape, truth);
            for (reference, test) in [
                (&reference, &test),
                (&test, &reference),
                (&reference, &silent(&test)),
                (&silent(&reference), &test),
            ] {
                assert_passes(&format!("{name}, {samples}"), reference, test);
            }
        }
    }
}

/// At a level of one in five, at most about one in five honest pairs is rejected; many seeds
/// show what one in a million never would.
#[test]
fn false_alarms_are_as_rare_as_promised() {
    let pairs = 150;
    let mut alarms = [0; 2];
    for seed in 0..pairs {
        let reference = sampled(1000 + seed, 40, even, truth);
        let test = sampled(seed, 20, even, truth);
        for (alarms, test) in alarms.iter_mut().zip([test.clone(), silent(&test)]) {
            let passed = judge_at(&reference, &test, 0.2).unwrap().passed;
            *alarms += u32::from(!passed);
        }
    }
    // Four standard deviations of a binomial count.
    let most = 0.2 * pairs as f64 + 4.0 * (0.2 * 0.8 * pairs as f64).sqrt();
    assert!(
        alarms.iter().all(|&count| f64::from(count) <= most),
        "{alarms:?}"
    );
}

#[test]
fn what_it_must_reject() {
    let reference = sampled(1, 256, exponential, truth);
    let test = sampled(2, 128, exponential, truth);
    assert!(judged(&reference, &test).passed);
    let scaled = |factor: f32| edited(&test, |_, pixel| pixel.map(|value| value * factor));

    assert_rejected("half as bright", &reference, &scaled(0.5), "overall");
    // The mean of 2304 × 128 exponential samples is known to two parts in a thousand, and all
    // channels share their noise.
    assert_rejected("a faint bias", &reference, &scaled(1.03), "overall");
    assert_rejected(
        "a faint bias of one channel",
        &reference,
        &edited(&test, |_, [r, g, b]| [r, g, b * 1.03]),
        "blue",
    );
    let in_block = |i: usize| (8..16).contains(&(i % SIDE)) && (8..16).contains(&(i / SIDE));
    assert_rejected(
        "a bias of one block",
        &reference,
        &edited(&test, |i, pixel| {
            if in_block(i) {
                pixel.map(|value| value * 1.15)
            } else {
                pixel
            }
        }),
        "from column 8 and row 8",
    );
    assert_rejected(
        "one hot pixel",
        &reference,
        &edited(
            &test,
            |i, pixel| if i == 10 * SIDE + 18 { [9.0; 3] } else { pixel },
        ),
        "blocks",
    );
    assert_rejected(
        "a hot pixel where there is no noise",
        &reference,
        &edited(&test, |i, pixel| if i == 47 { [1e-3; 3] } else { pixel }),
        "both images state a noise of 0",
    );
    let checked = |i: usize| {
        if (i + i / SIDE).is_multiple_of(2) {
            2.0
        } else {
            0.0
        }
    };
    assert_rejected(
        "a pattern that cancels within blocks",
        &reference,
        &sampled(2, 128, exponential, |i| {
            truth(i).map(|value| value * checked(i))
        }),
        "standard errors",
    );
    assert_rejected(
        "mirrored",
        &reference,
        &sampled(2, 128, exponential, |i| {
            truth(i / SIDE * SIDE + SIDE - 1 - i % SIDE)
        }),
        "blocks",
    );
}

/// A pixel of which a sample was NaN and became 0; where light arrives in one sample of twenty,
/// pixels are black by chance.
#[test]
fn a_black_pixel_is_no_noise() {
    let reference = sampled(1, 512, exponential, truth);
    let lost = |film: &Film, pixels: &[usize]| {
        edited(
            film,
            |i, pixel| if pixels.contains(&i) { [0.0; 3] } else { pixel },
        )
    };
    // Of an exponential number a sample is below its mean, never 0; by its variance half may be.
    let test = sampled(2, 64, exponential, truth);
    let bright = 40 * SIDE + 40;
    assert_test_rejected(
        "a NaN replaced",
        &reference,
        &lost(&test, &[bright]),
        "is black",
    );
    // In four samples one black pixel is nothing, and six are where none is likely.
    let few = sampled(3, 8, exponential, truth);
    assert_nothing_is_black(&reference, &lost(&few, &[bright]));
    // Samples without light at all: (19/20)⁶⁴ is one pixel in 27.
    let reference = sampled(1, 8192, rare, truth);
    let test = sampled(2, 64, rare, truth);
    let black = test.radiance().iter().filter(|pixel| **pixel == [0.0; 3]);
    assert!(black.count() > 20);
    assert_nothing_is_black(&reference, &test);
}

/// Pixels at the edge of a lit wall, of which a twentieth shows it, are black by chance.
#[test]
fn an_edge_is_black_by_chance() {
    let covered = |seed: u64, samples: u32| {
        let pixel = |index: usize| {
            let share = match index % SIDE {
                0..24 => 1.0,
                24 => 0.05,
                _ => 0.0,
            };
            let mut moments = Moments::default();
            for sample in 0..samples {
                let stream = Stream::new(seed, index as u32, sample);
                let [place, light] = [0, 1].map(|at| stream.uniform(at, Purpose::Camera, 0));
                moments.add(if place < share { 0.5 + light } else { 0.0 });
            }
            [moments; 3]
        };
        let pixels: Vec<[Moments; 3]> = (0..SIDE * SIDE).map(pixel).collect();
        Film::of_moments([SIDE, SIDE], &pixels, samples)
    };
    let reference = covered(1, 4096);
    for seed in 2..12 {
        let test = covered(seed, 16);
        let is_black = |row: usize| test.radiance()[row * SIDE + 24] == [0.0; 3];
        assert!((0..SIDE).filter(|row| is_black(*row)).count() > 5);
        assert_passes("", &reference, &test);
    }
}

/// A floor seen through fog of few and bright paths, and in one pixel of 25 a glint in its place, as bright and as
/// noisy, of which many pixels have no sample.
fn glints(seed: u64, samples: u32) -> Film {
    let pixel = |index: usize| {
        let is_glint = index % SIDE % 5 == 2 && index / SIDE % 5 == 2;
        let mut moments = Moments::default();
        for sample in 0..samples {
            let stream = Stream::new(seed, index as u32, sample);
            let u = stream.uniform(0, Purpose::Camera, 0);
            moments.add(match is_glint {
                true if u < 0.01 => 100.0,
                true => 0.0,
                false if u < 0.002 => 250.0,
                false => 0.5,
            });
        }
        [moments; 3]
    };
    let pixels: Vec<[Moments; 3]> = (0..SIDE * SIDE).map(pixel).collect();
    Film::of_moments([SIDE, SIDE], &pixels, samples)
}

/// Of two hundred images none is rejected, though a tenth of the glints and more are black.
#[test]
fn a_glint_is_black_by_chance() {
    let reference = glints(1, 4096);
    for samples in [16, 64] {
        for seed in 2..102 {
            let test = glints(seed, samples);
            let black = test.radiance().iter().filter(|pixel| **pixel == [0.0; 3]);
            assert!(black.count() > 30);
            assert_passes(&format!("{samples}"), &reference, &test);
        }
    }
}

/// Wherever it lies in steady light, at its edges too, one black pixel is seen.
#[test]
fn a_black_pixel_is_seen_everywhere() {
    let lit = |index: usize| {
        if index % SIDE < 24 {
            [0.6, 0.5, 0.3]
        } else {
            [0.2; 3]
        }
    };
    let reference = sampled(1, 1024, even, lit);
    let test = sampled(2, 64, even, lit);
    for index in (0..SIDE * SIDE).step_by(97) {
        let lost = edited(&test, |i, pixel| if i == index { [0.0; 3] } else { pixel });
        assert_test_rejected("lost", &reference, &lost, "a pixel is black");
    }
}

/// A radiance of 10⁻⁵ in a text of six decimals, which rounds all of it.
#[test]
fn a_dim_image_may_be_a_text() {
    let dim = |index: usize| truth(index).map(|x| 1e-5 * (0.5 + x));
    let reference = sampled(1, 1024, even, dim);
    let honest = sampled(2, 256, even, dim);
    let written = edited(&honest, |_, pixel| {
        pixel.map(|x| format!("{x:.6}").parse().unwrap())
    });
    for film in [silent(&written), written, honest] {
        assert_passes("six decimals", &reference, &film);
    }
}

/// A black row is an eighth of each block, less than the noise of one, and much of all together.
#[test]
fn a_lost_line_is_seen() {
    let lit = |_: usize| [0.5; 3];
    let reference = sampled(1, 4096, rare, lit);
    let test = sampled(2, 64, rare, lit);
    let lost = |is_lost: &dyn Fn(usize) -> bool| {
        edited(&test, |i, pixel| if is_lost(i) { [0.0; 3] } else { pixel })
    };
    let row = lost(&|i| i / SIDE == 20);
    assert_test_rejected(
        "a row",
        &reference,
        &row,
        "a region of 48 × 1 pixels from column 0 and row 20",
    );
    let column = lost(&|i| i % SIDE == 0);
    assert_test_rejected("a column", &reference, &column, "a region of 1 × 48 pixels");
}

#[test]
fn too_little_noise_is_suspicious() {
    let reference = sampled(1, 256, exponential, truth);
    // The first half of the samples is the same.
    let shared = sampled(1, 200, exponential, truth);
    assert_rejected(
        "common random numbers",
        &reference,
        &shared,
        "too little noise",
    );
    let smoothed = edited(&sampled(2, 256, exponential, truth), |i, pixel| {
        [0, 1, 2].map(|c| 0.6 * reference.radiance()[i][c] + 0.4 * pixel[c])
    });
    assert_rejected("smoothed", &reference, &smoothed, "too little noise");
    let loud = sampled(2, 256, exponential, truth);
    let variance = loud.noise().unwrap().variance();
    let quiet = |scale: f32| {
        let variance = variance.iter().map(|v| v.map(|v| scale * v)).collect();
        Film::with_noise(SIDE, SIDE, loud.radiance().to_vec(), variance, 256)
    };
    assert_rejected(
        "a copy",
        &quiet(1.0),
        &quiet(8.0),
        "it is the same image, not an independent estimate",
    );
    assert_rejected("a silent copy", &loud, &silent(&loud), "the same image");
    assert_rejected(
        "overstated noise",
        &reference,
        &quiet(8.0),
        "too little noise",
    );
    // Of n samples that are among the N of the reference, the differences have (N − n)/(N + n)
    // times the noise of independent ones: with few of them that is nothing to speak of.
    let few = judged(&reference, &sampled(1, 40, exponential, truth));
    assert!(few.passed && few.metrics["amount_of_noise"] < 1.0);
}

#[test]
fn without_noise_equal_is_equal() {
    let film = |edit: fn(f32) -> f32, variance: f32| {
        let radiance = (0..SIDE * SIDE)
            .map(|i| truth(i).map(|v| edit(v as f32)))
            .collect();
        Film::with_noise(SIDE, SIDE, radiance, vec![[variance; 3]; SIDE * SIDE], 64)
    };
    let exact = film(|v| v, 0.0);
    for (name, equal) in [
        ("equal", exact.clone()),
        (
            "half precision",
            // As far as rounding to 11 bits can take a value, less a rounding of ours.
            film(|v| v * (1.0 + 0.999 / 2048.0), 0.0),
        ),
        ("no noise stated", silent(&exact)),
    ] {
        assert_passes(name, &exact, &equal);
    }
    for (name, different) in [
        ("twice that", film(|v| v * (1.0 + 2.0 / 2048.0), 0.0)),
        ("an offset", film(|v| v + 1e-6, 0.0)),
    ] {
        assert_rejected(name, &exact, &different, "both images state a noise of 0");
    }
    let offset = silent(&film(|v| v + 0.5, 0.0));
    assert!(!judged(&exact, &offset).passed);
}

#[test]
fn incomparable_first() {
    let film = sampled(1, 4, even, truth);
    let small = Film::with_noise(8, 8, vec![[1.0; 3]; 64], vec![[0.1; 3]; 64], 4);
    assert_rejected("size", &film, &small, "size differs");
    let broken = edited(&film, |i, pixel| if i == 9 { [f32::NAN; 3] } else { pixel });
    assert_rejected("not a number", &film, &broken, "not finite");
    for value in [f32::NAN, f32::INFINITY, -1.0] {
        let mut variance = film.noise().unwrap().variance().to_vec();
        variance[77] = [value; 3];
        let broken = Film::with_noise(SIDE, SIDE, film.radiance().to_vec(), variance, 4);
        assert_rejected("variance", &film, &broken, "variance");
    }
    let both_silent = judge(&silent(&film), &silent(&film), 1);
    assert!(matches!(both_silent, Err(PictureError::NeedsNoise)));
    let codes = Picture::Radiance(film.clone()).srgb(0.0).unwrap();
    let mixed = volref::compare::judge(
        Gate::Stochastic,
        &Picture::Radiance(film),
        &Picture::Codes(codes),
        &Conditions::default(),
    );
    assert!(matches!(
        mixed,
        Err(PictureError::NeedsRadiance("stochastic"))
    ));
}

/// What it says it would have seen, it sees; a third of that it does not always.
#[test]
fn the_resolution_is_no_boast() {
    let reference = sampled(1, 256, even, truth);
    let test = sampled(2, 64, even, truth);
    let resolution = block_resolution(&judged(&reference, &test));
    assert!((1e-3..0.2).contains(&resolution), "{resolution}");
    let biased = sampled(2, 64, even, |i| {
        truth(i).map(|value| value + 2.0 * resolution * (value + 1e-3))
    });
    assert_rejected("twice the resolution", &reference, &biased, "blocks");
    let stricter = judge_at(&reference, &test, FALSE_ALARM / 1e6).unwrap();
    assert!(block_resolution(&stricter) > resolution);
}

/// An image of a third, drawn and copied, is called out only where the copied pixels are more
/// than chance can explain: where there is no noise, both are right.
#[test]
fn copies_are_of_noise() {
    let reference = sampled(1, 256, exponential, truth);
    let test = sampled(2, 64, exponential, truth);
    let mixed = |part: usize| {
        edited(&test, |i, pixel| {
            if i % 10 < part {
                reference.radiance()[i]
            } else {
                pixel
            }
        })
    };
    assert!(judged(&reference, &mixed(1)).metrics["copied_pixels"] > 0.0);
    assert!(judged(&reference, &mixed(1)).passed);
    assert_rejected(
        "most is copied",
        &reference,
        &mixed(8),
        "part of it is copied",
    );
}

fn advised(judgement: &Judgement) -> Advice {
    match judgement.undecided {
        Some(Undecided::Samples(advice)) => advice,
        other => panic!("{other:?}: {}", judgement.reason),
    }
}

/// The samples that are advised decide, and a quarter of them do not, in whatever form the noise
/// is given: in samples of all renderings together where their number is known, else in times of
/// them.
#[test]
fn advice_decides_in_every_form() {
    /// An image of so many samples, stated or not, whose renderings tell its noise.
    type Form = fn(u64, u32, SampleShape) -> Film;
    fn renderings(seed: u64, samples: u32, shape: SampleShape) -> Film {
        let one = |i: u64| silent(&sampled(4 * seed + i, samples / 4, shape, truth));
        Film::from_replicates(&[one(0), one(1), one(2), one(3)]).unwrap()
    }
    let forms: [(Form, Option<u64>); 5] = [
        (|seed, n, shape| sampled(seed, n, shape, truth), Some(32)),
        (
            |seed, n, shape| silent(&sampled(seed, n, shape, truth)),
            None,
        ),
        (
            // As of a renderer that was asked for them.
            |seed, n, shape| silent(&sampled(seed, n, shape, truth)).with_samples(n),
            Some(32),
        ),
        (renderings, None),
        (
            |seed, n, shape| renderings(seed, n, shape).with_samples(n / 4),
            Some(32),
        ),
    ];
    for (name, shape) in [
        ("even", even as SampleShape),
        ("exponential", exponential),
        ("rare", rare),
    ] {
        let reference = sampled(1, 2048, shape, truth);
        let stated = judged(&reference, &sampled(2, 32, shape, truth));
        let promise = 0.5 * mean_resolution(&stated);
        for (form, has) in forms {
            let with = |seed, samples| {
                let film = form(seed, samples, shape);
                promising(&reference, &film, promise)
            };
            let few = with(3, 32);
            let advice = advised(&few);
            assert_eq!(advice.has, has, "{name}");
            let samples = advice.samples().unwrap_or(32.0 * advice.times).ceil() as u32;
            for seed in 6..8 {
                let enough = with(seed, samples.next_multiple_of(4));
                assert!(
                    enough.passed && enough.undecided.is_none(),
                    "{name}, {samples} samples: {}",
                    enough.reason
                );
                let quarter = with(seed, samples / 16 * 4);
                assert!(quarter.undecided.is_some(), "{name}: {samples} is too much");
            }
        }
    }
}

/// An image whose samples cannot help is told so: a reference of few samples, and one that is
/// silent and noisy; of a silent one without noise, they can.
#[test]
fn the_reference_may_be_in_the_way() {
    let test = sampled(2, 64, even, truth);
    let with = |reference: &Film, promise| promising(reference, &test, promise);
    let noisy = silent(&sampled(1, 64, even, truth));
    let promise = 0.3 * mean_resolution(&judged(&noisy, &test));
    let hopeless = with(&noisy, promise);
    assert!(
        matches!(hopeless.undecided, Some(Undecided::Reference(_))),
        "{}",
        hopeless.reason
    );
    assert!(
        hopeless
            .reason
            .contains("no number of samples of this image would decide")
    );
    let exact = (0..SIDE * SIDE).map(|i| truth(i).map(|value| value as f32));
    let exact = Film::new(SIDE, SIDE, exact.collect());
    let promise = 0.3 * mean_resolution(&judged(&exact, &test));
    let times = advised(&with(&exact, promise)).times;
    // About 1/0.3², a little more for rounding, and up to twice that for safety.
    assert!((11.0..30.0).contains(&times), "{times}");
}

/// Blocks are asked for, too: with the samples advised they show what the promise says, and a reference of
/// few samples asks for less.
#[test]
fn blocks_are_decided_like_the_mean() {
    let promise = Promise::of_mean(0.02).decisive();
    let exact = (0..SIDE * SIDE).map(|i| truth(i).map(|value| value as f32));
    let exact = Film::new(SIDE, SIDE, exact.collect()).known();
    let test = |samples| sampled(2, samples, even, truth);
    let few = keeping(&exact, &test(64), promise);
    let [mean, block] = ["smallest_visible_bias", "smallest_visible_block_bias"];
    assert!(few.metrics[mean] < 0.02 && few.metrics[block] > 0.02);
    assert!(
        few.reason.contains("of single blocks (90th percentile) ")
            && few.reason.contains(", required 2.00 %; about "),
        "{}",
        few.reason
    );
    let advice = advised(&few);
    let enough = keeping(&exact, &test(advice.samples().unwrap() as u32), promise);
    assert!(
        enough.passed && enough.undecided.is_none(),
        "{}",
        enough.reason
    );
    assert!(enough.metrics[mean] <= 0.005 && enough.metrics[block] <= 0.02);

    // The same image, where what the reference hides is more than a quarter of what is promised.
    let reference = sampled(1, 64, even, truth);
    let enough = keeping(&reference, &test(64), promise);
    assert!(enough.undecided.is_none(), "{}", enough.reason);
    assert!(enough.metrics[block] > 0.02);
}

/// A bias is said first, with its size, and that neighbours agree in it is not taken for a filter.
#[test]
fn a_bias_is_not_called_a_filter() {
    let reference = sampled(1, 1024, exponential, truth);
    // Darker by up to a half towards the right, smoothly: as of another phase function.
    let wrong = |i: usize| {
        let part = 1.0 - 0.5 * (i % SIDE) as f64 / SIDE as f64;
        truth(i).map(|value| part * value)
    };
    for samples in [8, 64, 512] {
        let test = sampled(2, samples, exponential, wrong);
        for test in [&test, &silent(&test)] {
            let reason = judged(&reference, test).reason;
            assert!(
                reason.starts_with("the image is too dark overall: the mean of "),
                "{samples}: {reason}"
            );
            assert!(reason.contains("where the reference has"), "{reason}");
            // The size, and its standard error.
            let size = reason
                .split_once(" (−")
                .and_then(|(_, after)| after.split_once(" %), "));
            let (size, error) = size.and_then(|(size, _)| size.split_once(" ± ")).unwrap();
            let [size, error] = [size, error].map(|number| number.parse::<f64>().unwrap());
            assert!((size - 24.0).abs() < 10.0 && error < size / 3.0, "{reason}");
            for word in ["smooth", "denoised", "filter"] {
                assert!(!reason.contains(word), "{samples}: {reason}");
            }
        }
    }
}

/// Correlation of neighbours, where variances say nothing against it.
#[test]
fn neighbours_are_independent() {
    let reference = sampled(1, 1024, exponential, truth);
    let test = sampled(2, 16, exponential, truth);
    let honest = judged(&reference, &test);
    // Of products that are independent, in units of their root mean square: four deviations of
    // the mean of 36 blocks × 16, more where some are black.
    for axis in ["correlation_across", "correlation_down"] {
        assert!(honest.metrics[axis].abs() < 4.0 / (12.0 * 16.0_f64).sqrt());
    }
    let blurred = edited(&test, |i, _| {
        let mean = |c: usize| {
            let rows = [0, SIDE, 2 * SIDE].into_iter();
            let around = rows.flat_map(|row| [row, row + 1, row + 2]);
            let values = around.map(|step| test.radiance()[(i + step) % (SIDE * SIDE)][c]);
            values.sum::<f32>() / 9.0
        };
        [0, 1, 2].map(mean)
    });
    for test in [&blurred, &silent(&blurred)] {
        let judgement = judged(&reference, test);
        assert!(judgement.reason.contains("too smooth"), "{judgement:?}");
        // Means of three by three share two thirds of their pixels with each neighbour.
        let found = judgement.metrics["correlation_across"];
        assert!((0.5..0.8).contains(&found), "{found}");
    }
}

// --- A known reference ---------------------------------------------------------------------------

/// What is seen of a slope, without noise; no part of it is dark.
fn slope(index: usize) -> [f64; 3] {
    let (x, y) = ((index % SIDE) as f64, (index / SIDE) as f64);
    let light = 0.02 + (x + 2.0 * y) / 150.0;
    [0.9 * light, 0.5 * light, 0.2 * light]
}

fn known(truth: impl Fn(usize) -> [f64; 3]) -> Film {
    let pixels = (0..SIDE * SIDE).map(|index| truth(index).map(|value| value as f32));
    Film::new(SIDE, SIDE, pixels.collect()).known()
}

/// Light that arrives or does not, each sample with a probability in proportion to the radiance: of
/// few samples most pixels are black, and many blocks state too little noise.
fn arriving(seed: u64, samples: u32) -> Film {
    let pixel = |index: usize| {
        let [red, green, blue] = slope(index);
        let mut moments = Moments::default();
        for sample in 0..samples {
            let u = Stream::new(seed, index as u32, sample).uniform(0, Purpose::Camera, 0);
            moments.add(f64::from(u8::from(u < 0.5 * red)));
        }
        let scale = [red, green, blue].map(|value| value / (0.5 * red));
        (scale, moments)
    };
    let (mut means, mut variances) = (Vec::new(), Vec::new());
    for (scale, moments) in (0..SIDE * SIDE).map(pixel) {
        let variance = moments.variance_of_mean().unwrap();
        means.push(scale.map(|scale| (scale * moments.mean()) as f32));
        variances.push(scale.map(|scale| (scale * scale * variance) as f32));
    }
    Film::with_noise(SIDE, SIDE, means, variances, samples)
}

#[test]
fn noise_around_a_known_answer_is_accepted() {
    let reference = known(slope);
    for seed in 0..40 {
        for shape in [even, exponential, rare] {
            for film in [4, 64].map(|samples| sampled(seed, samples, shape, slope)) {
                assert_passes("", &reference, &film);
                assert_passes("", &reference, &silent(&film));
            }
        }
        for samples in [2, 4, 16] {
            let film = arriving(seed, samples);
            assert_accepted(&reference, &film);
        }
    }
}

/// `film` passes, with its noise and without a word on it.
fn assert_accepted(reference: &Film, film: &Film) {
    for film in [film, &silent(film)] {
        assert_passes("", reference, film);
    }
}

/// Three per cent of 64 samples a pixel, 2304 pixels of a noise of 58 %: 20 standard errors.
#[test]
fn bias_against_a_known_answer_is_rejected() {
    let reference = known(slope);
    let brighter = |index| slope(index).map(|value| 1.03 * value);
    let corner = |index| {
        let factor = if index % SIDE < 8 && index / SIDE < 8 {
            1.5
        } else {
            1.0
        };
        slope(index).map(|value| factor * value)
    };
    let whole = sampled(1, 64, even, brighter);
    let part = sampled(2, 64, even, corner);
    for (film, what) in [
        (&whole, "too bright overall"),
        (&silent(&whole), "too bright overall"),
        (&part, "8 × 8 pixels from column 0 and row 0"),
        (&silent(&part), "8 × 8 pixels from column 0 and row 0"),
    ] {
        let judgement = judge(&reference, film, 1).unwrap();
        assert!(!judgement.passed);
        assert!(judgement.reason.contains(what), "{}", judgement.reason);
    }
}

#[test]
fn what_noise_cannot_make_is_rejected_beside_a_known_answer() {
    let reference = known(slope);
    let film = sampled(3, 64, even, slope);
    let noise = film.noise().unwrap().variance().to_vec();
    let with = |edit: &dyn Fn(usize, [f32; 3]) -> [f32; 3], variance: Vec<[f32; 3]>| {
        let pixels = film.radiance().iter().enumerate();
        let pixels = pixels.map(|(index, pixel)| edit(index, *pixel)).collect();
        Film::with_noise(SIDE, SIDE, pixels, variance, 64)
    };
    let none = vec![[0.0; 3]; SIDE * SIDE];
    let right = |index: usize, _: [f32; 3]| slope(index).map(|value| value as f32);
    // Within the rounding of half precision, and no copy.
    let nearly = |index: usize, _: [f32; 3]| slope(index).map(|value| 1.0002 * value as f32);
    for (film, reason) in [
        // Light is steady: a pixel of 64 samples is not black.
        (
            with(
                &|index, pixel| if index == 1000 { [0.0; 3] } else { pixel },
                noise.clone(),
            ),
            "a pixel is black",
        ),
        // Smoothed.
        (with(&nearly, noise.clone()), "too little noise"),
        (with(&right, noise.clone()), "it is the same image"),
        // Black, and sure of it.
        (with(&|_, _| [0.0; 3], none.clone()), "without any noise"),
    ] {
        let judgement = judge(&reference, &film, 1).unwrap();
        assert!(!judgement.passed);
        assert!(judgement.reason.contains(reason), "{}", judgement.reason);
    }
    // The answer itself, with or without noise that was stated to be none; in half precision, too.
    let half = |index: usize, _: [f32; 3]| slope(index).map(|v| half::f16::from_f64(v).to_f32());
    for film in [with(&right, none.clone()), with(&half, none)] {
        assert_accepted(&reference, &film);
    }
}

/// An advice says samples that suffice, never that the reference is in the way.
#[test]
fn a_known_answer_is_never_too_noisy() {
    let film = sampled(4, 4, even, slope);
    for film in [film.clone(), silent(&film)] {
        let judgement = promising(&known(slope), &film, 1e-3);
        let undecided = judgement.undecided.expect("too few samples");
        assert!(
            matches!(undecided, Undecided::Samples(_)),
            "{}",
            judgement.reason
        );
    }
}
