//! Results for build servers.

use crate::files::visible::xml_text;
use crate::judging::{CaseResult, Cause, JudgedWith, Known, KnownStatus, Verdict, is_declared};
use std::collections::BTreeMap;
use std::fmt::Write;

/// JUnit XML of the results, one test suite for each family, each with what loosens its judgements as properties.
pub(crate) fn results_junit(results: &[CaseResult], judged_with: &JudgedWith) -> String {
    let properties = properties(judged_with);
    let mut families: BTreeMap<&str, Vec<&CaseResult>> = BTreeMap::new();
    for result in results {
        families.entry(&result.family).or_default().push(result);
    }
    let mut xml = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"volref\" {}>\n",
        counts(results.iter())
    );
    for (family, results) in families {
        let (family, counts) = (xml_text(family), counts(results.iter().copied()));
        let _ = writeln!(xml, r#"    <testsuite name="volref/{family}" {counts}>"#);
        xml.push_str(&properties);
        for result in results {
            xml.push_str(&test_case(result));
        }
        xml.push_str("    </testsuite>\n");
    }
    xml.push_str("</testsuites>\n");
    xml
}

/// The element of properties; empty where there are none.
fn properties(judged_with: &JudgedWith) -> String {
    let properties = judged_with.properties();
    if properties.is_empty() {
        return String::new();
    }
    let mut text = String::from("        <properties>\n");
    for (name, value) in properties {
        let (name, value) = (xml_text(&name), xml_text(&value));
        let _ = writeln!(
            text,
            r#"            <property name="volref.{name}" value="{value}"/>"#
        );
    }
    text + "        </properties>\n"
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

/// The attributes that count results.
fn counts<'r>(results: impl Iterator<Item = &'r CaseResult> + Clone) -> String {
    let of = |name| {
        let such = |result: &&CaseResult| element(result) == Some(name);
        results.clone().filter(such).count()
    };
    let (tests, skipped) = (results.clone().count(), of("skipped"));
    let (errors, failures) = (of("error"), of("failure"));
    format!(r#"tests="{tests}" skipped="{skipped}" failures="{failures}" errors="{errors}""#)
}

/// The attribute that states the kind of a failure.
fn kind_of(result: &CaseResult) -> String {
    format!(r#" type="{}""#, result.verdict.name())
}

fn test_case(result: &CaseResult) -> String {
    let mut children = String::new();
    if let Some(element) = element(result) {
        let likely = match &result.looks_like[..] {
            [] => String::new(),
            names => format!("; looks like {}", names.join(", ")),
        };
        let known = result.known.as_ref().map(Known::in_words);
        let said = format!("{}{likely}", result.reason);
        let (said, kind) = match (known, element) {
            // Its schema has no type for it.
            (Some(known), "skipped") => (known, String::new()),
            (Some(known), _) => (format!("{known}; {said}"), kind_of(result)),
            (None, _) => (said, kind_of(result)),
        };
        let message = xml_text(&said);
        let _ = writeln!(
            children,
            r#"            <{element} message="{message}"{kind}/>"#
        );
    }
    let notes = result.notes.iter().filter(|note| !is_declared(note));
    let notes: Vec<&str> = notes.map(String::as_str).collect();
    if !notes.is_empty() {
        let notes = xml_text(&notes.join("\n"));
        let _ = writeln!(children, "            <system-out>{notes}</system-out>");
    }
    let tag = format!(
        r#"testcase name="{}" classname="{}" time="{:.3}""#,
        xml_text(&result.name),
        xml_text(&result.family),
        result.seconds
    );
    match &children[..] {
        "" => format!("        <{tag}/>\n"),
        _ => format!("        <{tag}>\n{children}        </testcase>\n"),
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
