//! Results for build servers.

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
            .or_insert_with(|| TestSuite::new(format!("volref/{}", result.family)));
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
        status.set_message(format!("{}{likely}", result.reason));
    }
    let mut case = TestCase::new(result.name.clone(), status);
    case.set_classname(result.family.clone());
    case.set_time(Duration::from_secs_f64(result.seconds));
    case
}
