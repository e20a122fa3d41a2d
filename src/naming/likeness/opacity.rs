//! Mistakes in the opacity of an image whose colours are right.

use crate::compare::{Conditions, Deterministic, Gate as _, Picture, judge};
use crate::film::Film;
use crate::judging::{Judged, Likeness};
use crate::variations::mistakes::{Mistake, catalogue};
use std::collections::BTreeMap;

/// Failing images that differ from their goldens in opacity alone, by index, with the mistakes that explain each.
#[derive(Default)]
pub(super) struct OfOpacity(BTreeMap<usize, Vec<&'static Mistake>>);

impl OfOpacity {
    /// Takes the image at `index`, if its colours are right; there is nothing to name in one that is right but for
    /// its depth.
    pub fn takes(&mut self, index: usize, judged: &Judged) -> bool {
        let evidence = &judged.evidence;
        let (Some(golden), Some(Picture::Radiance(test))) = (&evidence.golden, &evidence.test)
        else {
            return false;
        };
        let is_deterministic = judged.result.gate.name() == Deterministic.name();
        if !is_deterministic || !has_right_colours(golden, test) {
            return false;
        }
        if agrees(golden, test) {
            return true;
        }
        let explains = |mistake: &&Mistake| {
            mistake.is_of_opacity()
                && mistake
                    .in_image(golden)
                    .is_some_and(|film| agrees(&film, test))
        };
        self.0.insert(index, catalogue().filter(explains).collect());
        true
    }

    /// Number of images.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Names the mistakes in the results; all of them, those of most cases first, and the cases that none explains.
    pub fn name(self, judged: &mut [Judged]) -> (Vec<Likeness>, Vec<String>) {
        let of = self.count();
        let mut likely: Vec<Likeness> = Vec::new();
        let mut unexplained = Vec::new();
        for (index, mistakes) in self.0 {
            let result = &mut judged[index].result;
            if mistakes.is_empty() {
                unexplained.push(result.name.clone());
            }
            result.search_ended = Some(true);
            result.looks_like = mistakes.iter().map(|it| it.name.to_owned()).collect();
            for mistake in mistakes {
                let known = likely
                    .iter()
                    .position(|other| other.mistake == mistake.name);
                let at = known.unwrap_or(likely.len());
                if known.is_none() {
                    likely.push(Likeness {
                        mistake: mistake.name.to_owned(),
                        advice: mistake.advice.to_owned(),
                        explains: 0,
                        of,
                        cases: Vec::new(),
                        beside_the_next: None,
                    });
                }
                likely[at].explains += 1;
                likely[at].cases.push(result.name.clone());
            }
        }
        likely.sort_by_key(|likely| std::cmp::Reverse(likely.explains));
        (likely, unexplained)
    }
}

/// True if the colours of two images without noise agree, and opacity may not.
fn has_right_colours(golden: &Film, test: &Film) -> bool {
    golden.opacity().is_some()
        && golden.noise().is_none()
        && test.noise().is_none()
        && agrees(&golden.clone().without_opacity(), test)
}

/// True if `test` agrees with `film`, in opacity where both have it.
fn agrees(film: &Film, test: &Film) -> bool {
    let picture = |film: &Film| Picture::Radiance(film.clone());
    let conditions = Conditions {
        opacity: true,
        ..Conditions::default()
    };
    let judgement = judge(&Deterministic, &picture(film), &picture(test), &conditions);
    judgement.is_ok_and(|judgement| judgement.passed)
}
