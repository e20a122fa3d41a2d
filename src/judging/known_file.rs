//! Files of known failures: read, held against results, and rewritten.

use super::known::{Known, KnownStatus};
use super::known_failure::{Failing, Size, found_causes, is_failure};
use super::{CaseResult, Cause, Verdict};
use crate::scene::SceneResult;
use crate::scene::format::{Key, Kind, Range, Table};
use crate::scene::reader::{Document, Reader};
use crate::suite::{Suite, SuiteError};
use std::cell::RefCell;
use std::collections::BTreeMap;
use toml::Spanned;
use toml::de::DeValue;

/// The verdicts that a failure may have.
const VERDICTS: [Verdict; 5] = [
    Verdict::Fail,
    Verdict::Convention,
    Verdict::Inconclusive,
    Verdict::Missing,
    Verdict::Error,
];

/// The declaration of a table of the file; its name is a case, or a pattern over cases.
const ENTRY: Table = Table::new("A known failure.").keys(&[
    Key::optional("verdict", Kind::Choice(&["fail", "convention", "inconclusive", "missing", "error"]))
        .doc("Verdict on the image. If left out, fail."),
    Key::optional("cause", Kind::Text)
        .doc("Mistake or convention that explains it, as `looks_like` or `conventions` of the JSON name it. Held against a search that found one or came to its end."),
    Key::optional("reason", Kind::Text)
        .doc("Why the failure is accepted for now, by a person. Required."),
    Key::optional("link", Kind::Text).doc("Where it is told, such as the address of an issue."),
    Key::optional("bound", Kind::Number(Range::NOT_NEGATIVE))
        .doc("Largest size of the difference, by one metric of the gate: worst_in_tolerances, max_abs_error (exact), worst_off_limit (refinement), flip_weighted_p99 (perceptual), or the largest mean_difference of a channel with 5 standard errors (stochastic)."),
]);

/// A table of the file.
#[derive(Clone, Debug)]
struct Entry {
    /// Case or pattern.
    name: String,
    /// Names of the cases that it matches.
    cases: Vec<String>,
    verdict: Verdict,
    cause: Option<String>,
    reason: String,
    link: Option<String>,
    bound: Option<f64>,
    /// Line of the table.
    line: usize,
    /// Lines of its keys.
    lines: BTreeMap<String, usize>,
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
            let line = line_at(text, name.span().start);
            let entry = Entry {
                line,
                cases,
                ..entry(&document, text_of_name, value)?
            };
            if entry.reason.trim().is_empty() && !may_lack_reasons {
                let message = format!("the known failure {text_of_name:?} has no reason");
                let help = "write in `reason` why the failure is accepted for now: --known-update leaves that to a person";
                return Err(at_name(message, help.to_owned()));
            }
            for case in &entry.cases {
                if let Some(other) = named.insert(case.clone(), line) {
                    let message =
                        format!("two entries name the case {case}: lines {other} and {line}");
                    let help =
                        "a case has one entry: take it out of a pattern, or remove one of the two";
                    return Err(at_name(message, help.to_owned()));
                }
            }
            known.entries.push(entry);
        }
        Ok(known)
    }

    /// What the file says of `result`; `None` of one that is neither listed nor a failure, and of one that was not
    /// judged.
    pub fn of(&self, result: &CaseResult) -> Option<Known> {
        let Some(entry) = self.entry(&result.name) else {
            return is_failure(result).then_some(Known {
                status: KnownStatus::New,
                reason: None,
                link: None,
                line: None,
                change: None,
            });
        };
        let (status, change) = entry.status(result)?;
        let change = change.map(|(line, words)| format!("{}:{line}: {words}", self.path));
        Some(Known {
            status,
            reason: Some(entry.reason.clone()),
            link: entry.link.clone(),
            line: Some(entry.line),
            change,
        })
    }

    /// A case with its result, where there is one, and what the file says of it.
    fn listed<'r>(
        &self,
        case: &'r str,
        results: &[&'r CaseResult],
    ) -> (&'r str, Option<&'r CaseResult>, Option<KnownStatus>) {
        let result = results.iter().find(|result| result.name == case).copied();
        let known = result.and_then(|result| self.of(result));
        (case, result, known.map(|known| known.status))
    }

    fn entry(&self, case: &str) -> Option<&Entry> {
        let names = |entry: &&Entry| entry.cases.iter().any(|name| name == case);
        self.entries.iter().find(names)
    }

    /// The text of the file with the new failures of `results` and without the mended ones.
    pub fn updated(&self, results: &[&CaseResult]) -> String {
        let mut rewriting = super::known_rewriting::Rewriting::of(&self.text);
        for entry in &self.entries {
            let is_kept =
                |status: Option<KnownStatus>| matches!(status, None | Some(KnownStatus::Known));
            let cases: Vec<_> = entry
                .cases
                .iter()
                .map(|case| self.listed(case, results))
                .collect();
            if cases.iter().all(|(.., status)| is_kept(*status)) {
                continue;
            }
            let left = cases.into_iter();
            let left = left.filter(|(.., status)| *status != Some(KnownStatus::Mended));
            let changed = |result: Option<&CaseResult>, status| match is_kept(status) {
                true => None,
                false => result.map(Failing::of),
            };
            let left = left.map(|(case, result, status)| (case, changed(result, status)));
            rewriting.replace(&entry.name, &left.collect::<Vec<_>>());
        }
        for result in results {
            if self.entry(&result.name).is_none() && is_failure(result) {
                rewriting.add(&result.name, &Failing::of(result));
            }
        }
        rewriting.text()
    }
}

impl Entry {
    /// What the entry says of the `result` of one of its cases, and the line to change, with what to write there.
    /// `None` of a result that was not judged.
    fn status(&self, result: &CaseResult) -> Option<(KnownStatus, Option<(usize, String)>)> {
        if result.cause >= Cause::Golden {
            return None;
        }
        let name = &result.name;
        if result.cause == Cause::None {
            let what = match self.cases.len() {
                1 => format!("remove the entry [{:?}]", self.name),
                _ => format!(
                    "leave it out of the pattern {:?}, and give each of its other cases an entry",
                    self.name
                ),
            };
            let change = (self.line, format!("{name} passes: {what}"));
            return Some((KnownStatus::Mended, Some(change)));
        }
        let is_unjudged = matches!(result.verdict, Verdict::Missing | Verdict::Inconclusive);
        if is_unjudged && self.verdict != result.verdict {
            return None;
        }
        let change = |key: &str, words: String| {
            let line = self.lines.get(key).copied().unwrap_or(self.line);
            Some((line, format!("{name} {words}")))
        };
        if !self.has_verdict_of(result) {
            let verdict = result.verdict.name();
            let words = format!("is {verdict:?} now: write verdict = {verdict:?}");
            return Some((KnownStatus::Otherwise, change("verdict", words)));
        }
        let (found, is_searched) = found_causes(result);
        if let Some(cause) = self.cause.as_deref().filter(|_| is_searched)
            && !found.contains(&cause)
        {
            let words = match found.first() {
                Some(now) => format!("looks like {now:?} now: write cause = {now:?}"),
                None => format!("does not look like {cause:?} now: remove `cause`"),
            };
            return Some((KnownStatus::Otherwise, change("cause", words)));
        }
        // What was measured of an image that conventions explain is left under these.
        let Some(bound) = self.bound.filter(|_| result.verdict == Verdict::Fail) else {
            return Some((KnownStatus::Known, None));
        };
        match Size::of(result) {
            None => {
                let words = format!(
                    "has a difference without a size now ({}): remove `bound`",
                    result.reason
                );
                Some((KnownStatus::Otherwise, change("bound", words)))
            }
            Some(size) if size.least > bound => {
                let words = format!("is worse, beyond the margin: write bound = {}", size.bound);
                Some((KnownStatus::Worse, change("bound", words)))
            }
            Some(_) => Some((KnownStatus::Known, None)),
        }
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

/// Names of the cases that an entry matches, or what is wrong with it and the remedy.
fn cases_named(suite: &Suite, name: &str) -> Result<Vec<String>, (String, String)> {
    if suite.case(name).is_some() {
        return Ok(vec![name.to_owned()]);
    }
    if name.starts_with('!') {
        let message = format!("{name:?} excludes cases, and a known failure names them");
        return Err((message, "write the cases that fail".to_owned()));
    }
    match suite.select(&[name.to_owned()]) {
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

/// The entry in `value`, but for its line and its cases.
fn entry<'s>(
    document: &Document<'s>,
    name: &str,
    value: &Spanned<DeValue<'s>>,
) -> SceneResult<Entry> {
    let log = RefCell::default();
    let reader = Reader::of_value(document, &ENTRY, value, format!("{name:?}"), &log)?;
    let Some(reader) = reader else {
        let message = format!("{name:?} is no table");
        let help = format!("write [{name:?}], and below it reason = \"...\"");
        return Err(document.error(Some(value.span()), message, Some(help)));
    };
    let verdict: Option<String> = reader.get("verdict")?;
    let verdict = VERDICTS
        .into_iter()
        .find(|known| verdict.as_deref() == Some(known.name()));
    Ok(Entry {
        name: name.to_owned(),
        cases: Vec::new(),
        verdict: verdict.unwrap_or(Verdict::Fail),
        cause: reader.optional("cause")?,
        reason: reader.optional("reason")?.unwrap_or_default(),
        link: reader.optional("link")?,
        bound: reader.optional("bound")?,
        line: 0,
        lines: lines_of_keys(document.text, value),
    })
}

/// The lines of the keys of a table.
fn lines_of_keys(text: &str, table: &Spanned<DeValue>) -> BTreeMap<String, usize> {
    let DeValue::Table(table) = table.get_ref() else {
        return BTreeMap::new();
    };
    let line = |key: &Spanned<std::borrow::Cow<str>>| {
        (key.get_ref().to_string(), line_at(text, key.span().start))
    };
    table.keys().map(line).collect()
}

/// The line, from 1, of the byte at `offset`.
fn line_at(text: &str, offset: usize) -> usize {
    1 + text[..offset].matches('\n').count()
}
