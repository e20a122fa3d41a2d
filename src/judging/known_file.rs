//! Files of known failures: read, held against results, and rewritten.

use super::known::{Known, KnownStatus};
use super::known_failure::{
    BOUNDS, Keys, Size, causes, failing, found_causes, is_cause, is_failure,
};
use super::{CaseResult, Cause, Verdict};
use crate::files::misspelling::nearest;
use crate::scene::SceneResult;
use crate::scene::format::{Key, Kind, Range, Table};
use crate::scene::reader::{Document, Reader};
use crate::suite::{Suite, SuiteError};
use std::cell::RefCell;
use std::collections::BTreeMap;
use toml::Spanned;
use toml::de::DeValue;

/// The declaration of a table of the file; its name is a case, or filters over cases.
const ENTRY: Table = Table::new("A known failure.").keys(&[
    Key::optional("verdict", Kind::Choice(&["fail", "convention", "inconclusive", "missing", "error"]))
        .doc("Verdict on the image. If left out, fail."),
    Key::optional("cause", Kind::Text)
        .doc("Mistake or convention that explains it, as `looks_like` or `conventions` of the JSON name it. Held against a search that found one or came to its end."),
    Key::optional("reason", Kind::Text)
        .doc("Why the failure is accepted for now, by a person. Required."),
    Key::optional("link", Kind::Text).doc("Where it is told, such as the address of an issue."),
    Key::optional(BOUNDS[0], Kind::Number(Range::NOT_NEGATIVE))
        .doc("Largest size of the difference, by a metric of the gate: worst_in_tolerances, worst_off_limit (refinement), flip_weighted_p99 (perceptual), or the largest mean_difference of a channel with 5 standard errors (stochastic)."),
    Key::optional(BOUNDS[1], Kind::Number(Range::NOT_NEGATIVE))
        .doc("Largest share of the image that differs: outlier_share, share_off_limit (refinement), or flip_mean (perceptual)."),
]);

/// A table of the file.
#[derive(Clone, Debug)]
struct Entry {
    /// Filters, separated by blanks.
    name: String,
    /// Names of the cases that it matches.
    cases: Vec<String>,
    verdict: Verdict,
    cause: Option<String>,
    reason: String,
    link: Option<String>,
    /// Values of [`BOUNDS`].
    bounds: [Option<f64>; 2],
    /// Line of the table.
    line: usize,
}

/// The failures of a renderer that are known.
#[derive(Clone, Debug)]
pub(crate) struct KnownFailures {
    /// The file, as it was given.
    path: String,
    /// Its text.
    text: String,
    entries: Vec<Entry>,
}

impl KnownFailures {
    /// The known failures in the file at `path`, with this `text`. Each entry names cases of the `suite`, no two the
    /// same, and gives a reason: unless it `may_lack_reasons`, since they are yet to be written.
    ///
    /// # Errors
    ///
    /// With the line of what is wrong.
    pub fn parse(
        text: &str,
        path: &str,
        suite: &Suite,
        may_lack_reasons: bool,
    ) -> SceneResult<KnownFailures> {
        let document = Document { path, text };
        let root = document.parse()?;
        let mut known = KnownFailures {
            path: path.to_owned(),
            text: text.to_owned(),
            entries: Vec::new(),
        };
        let mut tables: Vec<_> = root.get_ref().iter().collect();
        tables.sort_by_key(|(name, _)| name.span().start);
        // The entry that names each case.
        let mut named: BTreeMap<String, usize> = BTreeMap::new();
        for (name, value) in tables {
            let at_name = |message: String, help: String| {
                document.error(Some(name.span()), message, Some(help))
            };
            let text_of_name: &str = name.get_ref();
            let cases = cases_named(suite, text_of_name)
                .map_err(|(message, help)| at_name(message, help))?;
            let line = 1 + text[..name.span().start].matches('\n').count();
            let entry = entry(&document, text_of_name, value, (line, cases))?;
            if entry.reason.trim().is_empty() && !may_lack_reasons {
                let message = format!("the known failure {text_of_name:?} has no reason");
                let help = "write in `reason` why the failure is accepted for now: --known-update cannot write reasons";
                return Err(at_name(message, help.to_owned()));
            }
            for case in &entry.cases {
                if let Some(other) = named.insert(case.clone(), line) {
                    let message =
                        format!("two entries name the case {case}: lines {other} and {line}");
                    let help =
                        "a case has one entry: exclude it from a pattern, or remove one of the two";
                    return Err(at_name(message, help.to_owned()));
                }
            }
            known.entries.push(entry);
        }
        Ok(known)
    }

    /// The status of `result` by the file; `None` if it is neither listed nor a failure, or was not judged.
    pub fn of(&self, result: &CaseResult) -> Option<Known> {
        let entry = self.entry(&result.name);
        let (status, change) = match entry {
            Some(entry) => entry.status(result)?,
            None if is_failure(result) => {
                let (name, verdict) = (&result.name, result.verdict.name());
                let keys = in_words(&failing(result));
                let words = format!(
                    "{name} is {verdict:?}: {MEND}, or write [{name:?}] and below it {keys}, reason = \"...\""
                );
                let line = self.text.lines().count() + 1;
                (KnownStatus::New, Some((line, words)))
            }
            None => return None,
        };
        Some(Known {
            status,
            reason: entry.map(|entry| entry.reason.clone()),
            link: entry.and_then(|entry| entry.link.clone()),
            line: entry.map(|entry| entry.line),
            change: change.map(|(line, words)| format!("{}:{line}: {words}", self.path)),
        })
    }

    fn entry(&self, case: &str) -> Option<&Entry> {
        let names = |entry: &&Entry| entry.cases.iter().any(|name| name == case);
        self.entries.iter().find(names)
    }

    /// The text of the file with the new failures of `results`, without the mended ones, and with sizes that were not
    /// written. A case that changes is taken out of the filters of its entry, and nothing is said of cases without a
    /// result.
    pub fn updated(&self, results: &[&CaseResult]) -> String {
        let mut rewriting = super::known_rewriting::Rewriting::of(&self.text);
        for entry in &self.entries {
            let is_of_entry = |result: &&&CaseResult| entry.cases.contains(&result.name);
            let of_entry = results.iter().filter(is_of_entry);
            let changes = of_entry.filter_map(|result| Some((*result, entry.status(result)?)));
            let (known, changed): (Vec<_>, Vec<_>) =
                changes.partition(|(_, (status, _))| *status == KnownStatus::Known);
            let sizes = entry.unwritten(known.into_iter().map(|(result, _)| result));
            if changed.is_empty() && sizes.is_empty() {
                continue;
            }
            let left = entry.without(changed.iter().map(|(result, _)| &*result.name));
            let mut entries: Vec<_> = left.map(|name| (name, sizes)).into_iter().collect();
            let failing_now = changed.iter();
            let failing_now = failing_now.filter(|(_, (status, _))| *status != KnownStatus::Mended);
            entries.extend(failing_now.map(|(result, _)| (result.name.clone(), failing(result))));
            rewriting.replace(&entry.name, entries);
        }
        for result in results {
            if self.entry(&result.name).is_none() && is_failure(result) {
                rewriting.add(&result.name, failing(result));
            }
        }
        rewriting.text()
    }
}

impl Entry {
    /// The name of the entry without the `cases`; `None` if none is left.
    fn without<'c>(&self, cases: impl Iterator<Item = &'c str> + Clone) -> Option<String> {
        let is_left = cases.clone().count() < self.cases.len();
        let name = || cases.fold(self.name.clone(), |name, case| format!("{name} !{case}"));
        is_left.then(name)
    }

    /// The largest sizes of known failures that the entry does not bound, and could.
    fn unwritten<'r>(&self, results: impl Iterator<Item = &'r CaseResult>) -> Keys {
        let sizes: Vec<_> = results.map(Size::of).collect();
        let most = |key: &usize| {
            let of_key = sizes.iter().filter_map(|sizes| Some(sizes[*key]?.bound));
            Some((BOUNDS[*key], Some(of_key.max_by(f64::total_cmp)?.into())))
        };
        let unbounded = (0..2).filter(|key| self.bounds[*key].is_none());
        unbounded.filter_map(|key| most(&key)).collect()
    }

    /// The status by this entry of the `result` of one of its cases, and the line to change, with its new text. `None` if
    /// the case was not judged.
    fn status(&self, result: &CaseResult) -> Option<(KnownStatus, Option<(usize, String)>)> {
        if result.cause >= Cause::Golden {
            return None;
        }
        let name = &result.name;
        let change = |words: String| Some((self.line, format!("{name} {words}")));
        if result.cause == Cause::None {
            let what = match self.without([&**name].into_iter()) {
                None => format!("remove the entry [{:?}]", self.name),
                Some(left) => format!("take it out of the entry: write [{left:?}]"),
            };
            return Some((KnownStatus::Mended, change(format!("passes: {what}"))));
        }
        let is_unjudged = matches!(result.verdict, Verdict::Missing | Verdict::Inconclusive);
        if is_unjudged && self.verdict != result.verdict {
            return None;
        }
        let otherwise = |words: String| Some((KnownStatus::Otherwise, change(words)));
        if !self.has_verdict_of(result) {
            let verdict = result.verdict.name();
            let words = format!("is {verdict:?} now: {MEND}, or write verdict = {verdict:?}");
            return otherwise(words);
        }
        let (found, is_searched) = found_causes(result);
        if let Some(cause) = self.cause.as_deref().filter(|_| is_searched)
            && !found.contains(&cause)
        {
            let words = match found.first() {
                Some(now) => format!("looks like {now:?} now: {MEND}, or write cause = {now:?}"),
                None => format!("does not look like {cause:?} now: {MEND}, or remove `cause`"),
            };
            return otherwise(words);
        }
        for ((key, bound), size) in BOUNDS.into_iter().zip(self.bounds).zip(Size::of(result)) {
            match (bound, size) {
                (Some(_), None) if key == BOUNDS[0] && result.verdict == Verdict::Fail => {
                    let reason = &result.reason;
                    let words = format!(
                        "has a difference that cannot be measured now ({reason}): {MEND}, or remove `bound` and `share`"
                    );
                    return otherwise(words);
                }
                (Some(bound), Some(size)) if size.least > bound => {
                    let size = size.bound;
                    let words =
                        format!("is worse, beyond the margin: {MEND}, or write {key} = {size}");
                    return Some((KnownStatus::Worse, change(words)));
                }
                _ => {}
            }
        }
        let unwritten = self.unwritten([result].into_iter());
        let words = format!(
            "fails without a bound in the entry: write {}",
            in_words(&unwritten)
        );
        let change = (!unwritten.is_empty()).then(|| change(words)).flatten();
        Some((KnownStatus::Known, change))
    }

    /// True if the result has the verdict of the entry. Only a search tells `convention` from `fail`: without one, or
    /// where the entry states no cause, they are the same.
    fn has_verdict_of(&self, result: &CaseResult) -> bool {
        let (_, is_searched) = found_causes(result);
        match (self.verdict, result.verdict) {
            (Verdict::Fail, Verdict::Convention) => self.cause.is_none(),
            (Verdict::Convention, Verdict::Fail) => !is_searched,
            (listed, now) => listed == now,
        }
    }
}

/// The first of the two ways to end a failure.
const MEND: &str = "mend the renderer";

/// Names of the cases that an entry matches, or what is wrong with it and the remedy.
fn cases_named(suite: &Suite, name: &str) -> Result<Vec<String>, (String, String)> {
    let filters: Vec<String> = name.split_whitespace().map(str::to_owned).collect();
    if filters.iter().all(|filter| filter.starts_with('!')) {
        let message = format!("{name:?} names no case that fails");
        let help = "begin with a case or pattern, such as \"sampled/* !sampled/opaque\"";
        return Err((message, help.to_owned()));
    }
    match suite.select(&filters) {
        Ok(cases) => Ok(cases.into_iter().map(|case| case.name.clone()).collect()),
        Err(SuiteError::NoMatch { filter, help }) => {
            Err((format!("no case matches {filter:?}"), help))
        }
        Err(error) => {
            let help = "an entry is a family, a case, or a pattern over them such as 'figures/*'";
            Err((error.to_string(), help.to_owned()))
        }
    }
}

/// The entry in `value`, in this `line`, with its `cases`.
fn entry<'s>(
    document: &Document<'s>,
    name: &str,
    value: &Spanned<DeValue<'s>>,
    (line, cases): (usize, Vec<String>),
) -> SceneResult<Entry> {
    let log = RefCell::default();
    let reader = Reader::of_value(document, &ENTRY, value, format!("{name:?}"), &log)?;
    let Some(reader) = reader else {
        let message = format!("{name:?} is no table");
        let help = format!("write [{name:?}], and below it reason = \"...\"");
        return Err(document.error(Some(value.span()), message, Some(help)));
    };
    let cause = reader.get::<Option<String>>("cause")?;
    if let Some(cause) = cause.as_deref().filter(|cause| !is_cause(cause)) {
        let message = format!("{cause:?} is no mistake or convention that a search finds");
        let meant = nearest(cause, causes()).map(|meant| format!("did you mean {meant:?}? "));
        let meant = meant.unwrap_or_default();
        let help = format!(
            "{meant}`volref list --mistakes` shows the mistakes, a verdict the conventions"
        );
        return Err(reader.mistake("cause", message, help));
    }
    let verdict = reader.get::<Option<String>>("verdict")?;
    let mut verdicts = Verdict::ALL.into_iter();
    let verdict = verdicts.find(|(_, name, _)| verdict.as_deref() == Some(name));
    Ok(Entry {
        name: name.to_owned(),
        cases,
        verdict: verdict.map_or(Verdict::Fail, |(verdict, ..)| verdict),
        cause,
        reason: reader.get::<Option<String>>("reason")?.unwrap_or_default(),
        link: reader.get("link")?,
        bounds: [reader.get(BOUNDS[0])?, reader.get(BOUNDS[1])?],
        line,
    })
}

/// Keys as they are written.
fn in_words(keys: &Keys) -> String {
    let some = keys.iter();
    let some = some.filter_map(|(key, value)| Some(format!("{key} = {}", value.as_ref()?)));
    some.collect::<Vec<_>>().join(", ")
}
