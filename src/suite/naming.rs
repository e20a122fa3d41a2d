//! How often the mistake that was made is the one that is named.

use super::mistakes::Mistake;
use super::self_test::Subject;
use super::{Case, Judged, Likeness, Store, Verdict, likeness};
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

/// Makes `made`, one mistake or two, wherever there is occasion in `cases`, renders the rest as it
/// should be, judges all, and says what is named. Every `run` has seeds of its own.
pub fn naming(cases: &[&Case], store: &Store, made: &[&'static Mistake], run: u64) -> Naming {
    let judged = cases.iter().filter_map(|case| {
        let subject = Subject::new(case, store).ok()?;
        let film = subject.with_all(made, run).or_else(|| subject.right(run))?;
        Some(subject.judge(Picture::Radiance(film)))
    });
    let mut judged: Vec<Judged> = judged.collect();
    let named = likeness(cases, &mut judged, store, &|| ());
    let failed = |judged: &&Judged| judged.result.verdict == Verdict::Fail;
    Naming {
        made: made.iter().map(|mistake| mistake.name).collect(),
        failed: judged.iter().filter(failed).count(),
        named,
    }
}
