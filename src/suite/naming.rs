//! How often the mistake that was made is the one that is named.

use super::likeness::likeness_with;
use super::mistakes::Mistake;
use super::self_test::Subject;
use super::{Case, Judged, Likeness, Store, Verdict};
use crate::compare::Picture;

/// Mistakes that were made, and what was named.
#[derive(Clone, Debug, PartialEq)]
pub struct Naming {
    /// What was made: one name or two.
    pub made: Vec<&'static str>,
    /// Cases that failed.
    pub failed: usize,
    /// What was named, most likely first.
    pub named: Vec<Likeness>,
}

impl Naming {
    /// The place of what was made among what was named, 1 for the first; two in any order.
    pub fn place(&self) -> Option<usize> {
        let sorted = |names: Vec<&str>| {
            let mut names: Vec<String> = names.into_iter().map(str::to_owned).collect();
            names.sort();
            names
        };
        let made = sorted(self.made.clone());
        let is_made = |named: &Likeness| sorted(named.mistake.split(" + ").collect()) == made;
        self.named.iter().position(is_made).map(|place| place + 1)
    }
}

/// Makes mistakes wherever there is occasion in `cases`, each of `made` by itself: one or two, and
/// a number that chooses the seeds. The other cases are as they should be. Judges all, and says
/// what is named; `told` is told of each that is done. Cases whose golden cannot be trusted are
/// left out.
pub fn naming(
    cases: &[&Case],
    store: &Store,
    made: &[(Vec<&'static Mistake>, u64)],
    told: &dyn Fn(),
) -> Vec<Naming> {
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
        let named = likeness_with(cases, &mut judged, &scene_of, &|| ());
        let failed = |judged: &&Judged| judged.result.verdict == Verdict::Fail;
        namings.push(Naming {
            made: mistakes.iter().map(|mistake| mistake.name).collect(),
            failed: judged.iter().filter(failed).count(),
            named,
        });
        told();
    }
    namings
}
