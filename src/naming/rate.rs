//! Success rate of naming the mistakes of simulated images.

use super::likeness::{Predictions, Search, likeness_with};
use crate::compare::Picture;
use crate::judging::self_test::Subject;
use crate::judging::{Judged, Likeness, Verdict};
use crate::suite::{Case, Store};
use crate::variations::mistakes::Mistake;

/// The mistakes made, and those named.
#[derive(Clone, Debug, PartialEq)]
pub struct Naming {
    /// The mistakes made: one name or two.
    pub made: Vec<&'static str>,
    /// Cases that failed.
    pub failed: usize,
    /// The mistakes named, most likely first.
    pub named: Vec<Likeness>,
}

impl Naming {
    /// Number of names, from 1, after which all mistakes made are named. Two mistakes that meet in
    /// no case are named one by one; a name with any other mistake does not count.
    pub(crate) fn rank(&self) -> Option<usize> {
        let mut missing = self.made.clone();
        for (index, named) in self.named.iter().enumerate() {
            let parts: Vec<&str> = named.mistake.split(" + ").collect();
            if parts.iter().all(|part| self.made.contains(part)) {
                missing.retain(|made| !parts.contains(made));
            }
            if missing.is_empty() {
                return Some(index + 1);
            }
        }
        None
    }
}

/// Simulates each of `made`, one or two mistakes and a number that chooses the seeds, in all
/// `cases` that give occasion; the other cases are correct. Judges all cases, and returns the names
/// given, without a time limit; `report` is called after each. Cases whose golden cannot be trusted
/// are left out.
pub fn naming(
    cases: &[&Case],
    store: &Store,
    made: &[(Vec<&'static Mistake>, u64)],
    predictions: &Predictions,
    report: &dyn Fn(),
) -> Vec<Naming> {
    let search = Search {
        budget: None,
        predictions,
        interrupted: &|| false,
        progress: &|_| (),
    };
    let subjects: Vec<Subject<'_>> = cases
        .iter()
        .filter_map(|case| Subject::new(case, store).ok())
        .collect();
    let scene_of = |case: &Case| {
        let subject = subjects.iter().find(|s| s.case.name == case.name);
        subject.map(|subject| subject.scene().clone())
    };
    let right: Vec<Judged> = subjects.iter().map(Subject::judged_right).collect();
    let mut namings = Vec::new();
    for (mistakes, run) in made {
        let subjects = subjects.iter().zip(&right);
        let judged = subjects.map(|(subject, right)| match subject.with_all(mistakes, *run) {
            Some(film) => subject.judge(Picture::Radiance(film)),
            None => right.clone(),
        });
        let mut judged: Vec<Judged> = judged.collect();
        let named = likeness_with(cases, &[], &mut judged, &scene_of, &search).likely;
        let failed = |judged: &&Judged| judged.result.verdict == Verdict::Fail;
        namings.push(Naming {
            made: mistakes.iter().map(|mistake| mistake.name).collect(),
            failed: judged.iter().filter(failed).count(),
            named,
        });
        report();
    }
    namings
}

#[cfg(test)]
mod tests {
    use super::*;

    fn naming(made: &[&'static str], named: &[&str]) -> Option<usize> {
        let likeness = |name: &&str| Likeness {
            mistake: (*name).to_owned(),
            advice: String::new(),
            explains: 1,
            of: 1,
            cases: vec![],
            beside_the_next: None,
        };
        let naming = Naming {
            made: made.to_vec(),
            failed: 1,
            named: named.iter().map(likeness).collect(),
        };
        naming.rank()
    }

    #[test]
    fn one_mistake_has_the_rank_of_its_name() {
        assert_eq!(naming(&["a"], &["b", "a"]), Some(2));
        assert_eq!(naming(&["a"], &["a + b", "b"]), None);
    }

    #[test]
    fn two_mistakes_are_named_together_or_one_by_one() {
        assert_eq!(naming(&["a", "b"], &["b + a"]), Some(1));
        assert_eq!(naming(&["a", "b"], &["b", "c", "a"]), Some(3));
        assert_eq!(naming(&["a", "b"], &["a", "b + c"]), None);
    }
}
