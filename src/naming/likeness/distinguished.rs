//! Comparison of two mistakes that explain the same cases.

use super::explanations::Explanation;
use super::hypothesis::Hypothesis;
use crate::suite::Case;

/// Largest number of scenes loaded for a hint. Loading one takes up to a quarter of a second
/// (figure 5): two seconds in all.
const MOST_SCENES: usize = 8;

/// A mistake that leaves less than this share of an image unexplained, root mean square, leaves its
/// rounding to 32 bits.
const ROUNDING: f64 = 1e-6;

/// Reason why `first`, which explains the same cases as `second`, is named before it: a sentence
/// about `first`. Nothing where they explain other cases, which is reason enough. `unjudged` are
/// cases without an image.
pub(super) fn in_words(
    first: &Explanation,
    second: &Explanation,
    unjudged: &[&Case],
) -> Option<String> {
    if !first.fits.keys().eq(second.fits.keys()) {
        return None;
    }
    let other = second.hypothesis.name();
    if first.contradictions < second.contradictions {
        let more = second.contradictions - first.contradictions;
        let cases = if more == 1 {
            "case that passed speaks"
        } else {
            "cases that passed speak"
        };
        return Some(format!(
            "likelier than {other}: {more} more {cases} against that"
        ));
    }
    if first.hypothesis.mistakes().len() < second.hypothesis.mistakes().len() {
        return Some(format!(
            "likelier than {other}: one mistake rather than two"
        ));
    }
    let at_most = first.mean(|misfit| misfit.distance().at_most());
    if at_most < second.mean(|misfit| misfit.distance().at_least()) {
        let [near, far] = [first, second].map(|explanation| {
            let square = explanation.mean(|misfit| misfit.distance().value);
            square.max(ROUNDING * ROUNDING).sqrt()
        });
        return Some(if near <= ROUNDING {
            format!(
                "likelier than {other}: it leaves nothing but rounding, the other {} of the image",
                percent(far)
            )
        } else {
            format!(
                "likelier than {other}: nearer to the images by a factor of {}",
                factor(far / near)
            )
        });
    }
    let hint = match telling(&first.hypothesis, &second.hypothesis, unjudged) {
        Some(case) => format!("an image of {case} would tell them apart"),
        None => "images of other cases may tell them apart".to_owned(),
    };
    Some(format!(
        "cannot be told apart from {other} in these cases; {hint}"
    ))
}

/// A case among `cases` that promises to catch one of the mistakes, and has no occasion for the
/// other.
fn telling<'c>(first: &Hypothesis, second: &Hypothesis, cases: &[&'c Case]) -> Option<&'c str> {
    let (&[first], &[second]) = (&first.mistakes()[..], &second.mistakes()[..]) else {
        return None;
    };
    let promises = |case: &Case, name: &str| case.mistakes.iter().any(|known| known == name);
    let one_sided = cases.iter().filter_map(|case| {
        match [first, second].map(|mistake| promises(case, mistake.name)) {
            [true, false] => Some((case, second)),
            [false, true] => Some((case, first)),
            _ => None,
        }
    });
    one_sided
        .filter(|(_, other)| !other.is_of_the_image())
        .take(MOST_SCENES)
        .find(|(case, other)| {
            let scene = case.load_scene().ok();
            scene.is_some_and(|scene| other.in_scene(&scene).is_none())
        })
        .map(|(case, _)| case.name.as_str())
}

/// A factor above one, in two digits.
fn factor(value: f64) -> String {
    match value {
        ..9.95 => format!("{value:.1}"),
        ..999.5 => format!("{value:.0}"),
        _ => "more than 1000".to_owned(),
    }
}

/// A share of the image, in two digits.
fn percent(share: f64) -> String {
    match 100.0 * share {
        percent @ 9.95.. => format!("{percent:.0} %"),
        percent @ 0.0995.. => format!("{percent:.1} %"),
        percent => format!("{percent:.1e} %"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::cells::Misfit;
    use crate::compare::unexplained::SquaredDistance;
    use crate::suite::Suite;
    use crate::variations::mistakes;
    use std::collections::BTreeMap;
    use std::path::Path;

    fn one(name: &str) -> Hypothesis {
        let index = mistakes::catalogue().position(|mistake| mistake.name == name);
        Hypothesis::One(index.unwrap())
    }

    /// `hypothesis` explains the first result with this distance, known with this error.
    fn explanation(hypothesis: Hypothesis, distance: f64, error: f64) -> Explanation {
        let misfit = Misfit {
            in_noise: 1.0,
            parts: [
                SquaredDistance {
                    value: distance,
                    error,
                },
                SquaredDistance::default(),
            ],
            by_other_weights: [SquaredDistance::default(); 2],
            test_from_black: SquaredDistance::default(),
            least_error: error,
            has_noise: false,
            gain: 0.0,
        };
        Explanation {
            hypothesis,
            fits: BTreeMap::from([(0, misfit)]),
            contradictions: 0,
        }
    }

    #[test]
    fn the_likelier_is_the_nearer_one_and_by_what_factor() {
        let [g, shadow] = ["phase-reversed", "shadow-left-out"].map(one);
        let near = explanation(g, 1e-4, 1e-6);
        let far = explanation(shadow, 1e-2, 1e-6);
        assert_eq!(
            in_words(&near, &far, &[]).unwrap(),
            "likelier than shadow-left-out: nearer to the images by a factor of 10"
        );
        let exact = explanation(g, 1e-15, 0.0);
        assert_eq!(
            in_words(&exact, &far, &[]).unwrap(),
            "likelier than shadow-left-out: it leaves nothing but rounding, the other 10 % of the image"
        );
        let mut denied = explanation(shadow, 1e-4, 1e-6);
        denied.contradictions = 2;
        assert_eq!(
            in_words(&near, &denied, &[]).unwrap(),
            "likelier than shadow-left-out: 2 more cases that passed speak against that"
        );
        let mut elsewhere = explanation(shadow, 1e-4, 1e-6);
        elsewhere.fits.insert(1, elsewhere.fits[&0]);
        assert_eq!(in_words(&elsewhere, &near, &[]), None);
    }

    #[test]
    fn what_cannot_be_told_apart_names_a_case_that_would() {
        let [g, shadow] = ["phase-reversed", "shadow-left-out"].map(one);
        let [near, far] = [(g, 1e-4), (shadow, 1.1e-4)].map(|(h, d)| explanation(h, d, 1e-5));
        assert_eq!(
            in_words(&near, &far, &[]).unwrap(),
            "cannot be told apart from shadow-left-out in these cases; images of other cases may tell them apart"
        );
        let suite = Suite::open(Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap();
        let cases: Vec<&Case> = suite.cases().iter().collect();
        let case = telling(&g, &shadow, &cases).unwrap();
        let case = suite
            .cases()
            .iter()
            .find(|known| known.name == case)
            .unwrap();
        let scene = case.load_scene().unwrap();
        let occurs = [&g, &shadow].map(|h| h.mistakes()[0].in_scene(&scene).is_some());
        assert_ne!(occurs[0], occurs[1], "{}", case.name);
        assert!(
            in_words(&near, &far, &cases)
                .unwrap()
                .contains("would tell them apart")
        );
    }
}
