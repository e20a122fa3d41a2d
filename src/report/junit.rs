//! Results for build servers.

use super::template::xml;
use crate::judging::{CaseResult, Cause, JudgedWith, Known, KnownStatus, Verdict};
use minijinja::{Value, context};
use std::collections::BTreeMap;

/// JUnit XML of the results, one test suite for each family, each with what loosens its judgements as properties.
pub(crate) fn results_junit(results: &[CaseResult], judged_with: &JudgedWith) -> String {
    let mut families: BTreeMap<&str, Vec<&CaseResult>> = BTreeMap::new();
    for result in results {
        families.entry(&result.family).or_default().push(result);
    }
    let suites = families.into_iter().map(|(family, results)| {
        let cases: Vec<Value> = results.iter().map(|result| test_case(result)).collect();
        context! { family, cases, ..counts(&results) }
    });
    let context = context! {
        suites => suites.collect::<Vec<_>>(),
        properties => judged_with.properties(),
        all => counts(&results.iter().collect::<Vec<_>>()),
    };
    xml(include_str!("junit.xml"), context)
}

/// The element for a result that does not count as a pass: only a difference is the fault of the image.
fn element(result: &CaseResult) -> Option<&'static str> {
    match &result.known {
        Some(known) if known.status == KnownStatus::Known => return Some("skipped"),
        Some(known) if known.is_outdated() => return Some("failure"),
        _ => {}
    }
    match result.verdict {
        Verdict::Pass => None,
        // Accepted.
        Verdict::Convention if result.cause == Cause::None => None,
        Verdict::Fail | Verdict::Convention => Some("failure"),
        Verdict::Inconclusive | Verdict::Missing | Verdict::Error => Some("error"),
    }
}

/// Numbers of results.
fn counts(results: &[&CaseResult]) -> Value {
    let of = |name| {
        let such = |result: &&&CaseResult| element(result) == Some(name);
        results.iter().filter(such).count()
    };
    context! {
        tests => results.len(),
        skipped => of("skipped"),
        failures => of("failure"),
        errors => of("error"),
    }
}

fn test_case(result: &CaseResult) -> Value {
    let element = element(result);
    let likely = match &result.looks_like[..] {
        [] => String::new(),
        names => format!("; looks like {}", names.join(", ")),
    };
    let said = format!("{}{likely}", result.reason);
    let is_skipped = element == Some("skipped");
    let message = match result.known.as_ref().map(Known::in_words) {
        Some(known) if is_skipped => known,
        Some(known) => format!("{known}; {said}"),
        None => said,
    };
    let notes: Vec<&str> = result.notes.iter().map(String::as_str).collect();
    context! {
        name => result.name,
        seconds => format!("{:.3}", result.seconds),
        element,
        message,
        // The schema has no type for one that is skipped.
        kind => (!is_skipped).then(|| result.verdict.name()),
        notes => notes.join("\n"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::Gate;
    use crate::files::visible::visible;
    use crate::judging::Cause;

    /// A case whose every text is `text`.
    fn case(text: &str, verdict: Verdict) -> CaseResult {
        CaseResult {
            family: text.to_owned(),
            notes: vec![text.to_owned()],
            looks_like: vec![text.to_owned()],
            ..CaseResult::new(verdict, Cause::None, text).of_case(text, text, Gate::Deterministic)
        }
    }

    /// The text that a parser gives back.
    fn seen(text: &str) -> String {
        visible(text).replace(['\u{fffe}', '\u{ffff}'], "�")
    }

    /// Whatever a renderer prints, a parser reads it, and as it was said where XML can hold it.
    #[test]
    fn every_character_is_well_formed() {
        let every: Vec<char> = ('\0'..='\u{ffff}').chain(['\u{10ffff}', '🎲']).collect();
        let texts = every.chunks(4096).map(String::from_iter);
        let markup = "]]> ]] > <![CDATA[ <!-- --> & &amp; &#0; &#x1b; <?xml ?> \" '";
        for text in texts.chain([markup.to_owned()]) {
            let results = [case(&text, Verdict::Fail), case(&text, Verdict::Pass)];
            let xml = results_junit(&results, &JudgedWith::default());
            let document = roxmltree::Document::parse(&xml).expect("well-formed XML");
            let cases = document
                .descendants()
                .filter(|node| node.has_tag_name("testcase"));
            assert_eq!(cases.clone().count(), 2);
            let output = document
                .descendants()
                .find(|node| node.has_tag_name("system-out"));
            let said = output.and_then(|node| node.text()).unwrap_or_default();
            assert_eq!(said.trim(), seen(&text).trim());
            // Parsers turn line ends and tabs of an attribute into spaces, unless they are escaped.
            let flat = |text: &str| text.replace(['\n', '\t'], " ");
            for case in cases {
                assert_eq!(flat(case.attribute("name").unwrap()), flat(&seen(&text)));
            }
        }
    }

    #[test]
    fn what_xml_cannot_hold_is_seen() {
        let results = [case("\u{1b}[31m\u{fffe}\u{ffff}", Verdict::Fail)];
        let xml = results_junit(&results, &JudgedWith::default());
        assert!(xml.contains("message=\"␛[31m��;"), "{xml}");
    }
}
