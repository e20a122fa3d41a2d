//! Results for other programs.

use crate::judging::{CaseResult, Verdict};
use serde_json::{Map, Value, json};

/// The results of the command `kind` (`verify`, `validate`, `compare`) as JSON.
pub(crate) fn results_json(kind: &str, results: &[CaseResult]) -> Value {
    let summary = Verdict::ALL.into_iter();
    let summary = summary.map(|(it, name, _)| (name.to_owned(), it.count(results).into()));
    json!({
        "schema": format!("volref/{kind}/1"),
        "cases": results,
        "summary": summary.collect::<Map<_, _>>(),
    })
}
