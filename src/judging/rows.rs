//! The rows of the catalogue of hard cases, as results of the suite.

use super::finding::CaseFinding;
use super::{Cause, Evidence, Judged, Verdict};
use crate::hard_cases::{Row, rows};
use crate::suite::analytic::{ANALYTIC, Analytic, ERROR_OF_TOLERANCE};
use crate::suite::row_name::{HARD, row_name};
use crate::suite::{Case, Suite, SuiteError};
use std::time::Instant;

impl Suite {
    /// The rows that go with this suite.
    pub fn rows(&self) -> Vec<&'static Row> {
        if self.cases().iter().any(|case| case.family == HARD) {
            rows().collect()
        } else {
            vec![]
        }
    }

    /// The cases and rows that any of the filters matches, as [`Suite::select`] has it.
    pub(crate) fn select_with_rows(
        &self,
        filters: &[String],
    ) -> Result<(Vec<&Case>, Vec<&'static Row>), SuiteError> {
        let rows = self.rows();
        let names: Vec<String> = rows.iter().map(|row| row_name(row)).collect();
        let chosen = self.chosen(filters, &names)?;
        let cases = self.cases().iter().filter(|case| chosen.has(&case.name));
        let rows = rows.into_iter().filter(|row| chosen.has(&row_name(row)));
        Ok((cases.collect(), rows.collect()))
    }
}

/// Runs a row.
pub(crate) fn verify_row(row: &Row) -> Judged {
    let start = Instant::now();
    let margin = row.run();
    let share = margin.share();
    let mut finding = if margin.passed() {
        let reason = format!("{} [{}]", row.what, row.tolerance);
        CaseFinding::new(Verdict::Pass, Cause::None, reason)
    } else {
        let reason = format!(
            "{}: {share:.3} times the tolerance, which is: {}\n{}",
            row.what,
            row.tolerance,
            margin.worst()
        );
        CaseFinding::new(Verdict::Fail, Cause::Mismatch, reason)
    };
    // A value that should be exact and is not has no number.
    if share.is_finite() {
        finding.metrics.insert(ERROR_OF_TOLERANCE.to_owned(), share);
    }
    Judged {
        result: finding.result(&row_name(row), ANALYTIC, &Analytic, start),
        evidence: Evidence {
            source: format!("Catalogue of hard cases, {}", row.id),
            shows: format!("{}. It may be off by: {}.", row.what, row.tolerance),
            computes: format!("Remedy: {}; see {}.", row.remedy, row.file),
            without_image: true,
            ..Evidence::default()
        },
    }
}
