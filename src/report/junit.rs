//! Results for build servers.

use super::visible::xml_text;
use crate::suite::{CaseResult, Verdict};
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};
use std::collections::BTreeMap;
use std::time::Duration;

/// The results as a JUnit XML report, one test suite per family.
pub fn results_junit(results: &[CaseResult]) -> String {
    let mut families: BTreeMap<&str, TestSuite> = BTreeMap::new();
    for result in results {
        let suite = families
            .entry(&result.family)
            .or_insert_with(|| TestSuite::new(xml_text(&format!("volref/{}", result.family))));
        suite.add_test_case(test_case(result));
    }
    let mut report = Report::new("volref");
    report.add_test_suites(families.into_values());
    report.to_string().expect("results are plain text")
}

fn test_case(result: &CaseResult) -> TestCase {
    let mut status = match result.verdict {
        Verdict::Pass => TestCaseStatus::success(),
        Verdict::Fail => TestCaseStatus::non_success(NonSuccessKind::Failure),
        Verdict::Inconclusive | Verdict::Missing | Verdict::Error => {
            TestCaseStatus::non_success(NonSuccessKind::Error)
        }
    };
    if result.verdict != Verdict::Pass {
        status.set_type(result.verdict.name());
        let likely = match &result.looks_like[..] {
            [] => String::new(),
            names => format!("; looks like {}", names.join(", ")),
        };
        status.set_message(xml_text(&format!("{}{likely}", result.reason)));
    }
    let mut case = TestCase::new(xml_text(&result.name), status);
    case.set_classname(xml_text(&result.family));
    if !result.notes.is_empty() {
        case.set_system_out(xml_text(&result.notes.join("\n")));
    }
    case.set_time(Duration::from_secs_f64(result.seconds));
    case
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::Deterministic;
    use crate::suite::Cause;

    /// A case whose every text is `text`.
    fn case(text: &str, verdict: Verdict) -> CaseResult {
        CaseResult {
            name: text.to_owned(),
            family: text.to_owned(),
            class: text.to_owned(),
            verdict,
            metrics: BTreeMap::new(),
            gate: &Deterministic,
            reason: text.to_owned(),
            notes: vec![text.to_owned()],
            looks_like: vec![text.to_owned()],
            seconds: 0.0,
            work: BTreeMap::new(),
            cause: Cause::None,
        }
    }

    /// Whatever a renderer prints, a parser reads it, and as it was said where XML can hold it.
    #[test]
    fn every_character_is_well_formed() {
        let every: Vec<char> = ('\0'..='\u{ffff}').chain(['\u{10ffff}', '🎲']).collect();
        let texts = every.chunks(4096).map(String::from_iter);
        let markup = "]]> ]] > <![CDATA[ <!-- --> & &amp; &#0; &#x1b; <?xml ?> \" '";
        for text in texts.chain([markup.to_owned()]) {
            let results = [case(&text, Verdict::Fail), case(&text, Verdict::Pass)];
            let xml = results_junit(&results);
            let document = roxmltree::Document::parse(&xml).expect("well-formed XML");
            let cases = document
                .descendants()
                .filter(|node| node.has_tag_name("testcase"));
            assert_eq!(cases.clone().count(), 2);
            let output = document
                .descendants()
                .find(|node| node.has_tag_name("system-out"));
            let said = output.and_then(|node| node.text()).unwrap_or_default();
            assert_eq!(said.trim(), xml_text(&text).trim());
            // Parsers turn line ends and tabs of an attribute into spaces, unless they are escaped.
            let flat = |text: &str| text.replace(['\n', '\t'], " ");
            for case in cases {
                assert_eq!(
                    flat(case.attribute("name").unwrap()),
                    flat(&xml_text(&text))
                );
            }
        }
    }

    #[test]
    fn what_xml_cannot_hold_is_seen() {
        let xml = results_junit(&[case("\u{1b}[31m\u{fffe}\u{ffff}", Verdict::Fail)]);
        assert!(xml.contains("message=\"␛[31m��;"), "{xml}");
    }
}
