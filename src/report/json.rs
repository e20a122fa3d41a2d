//! Results for other programs.

use crate::judging::{CaseResult, Likeness, Verdict};
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

/// [`results_json`] of `validate`, with the likely mistakes over all cases.
pub(crate) fn validation_json(results: &[CaseResult], likely: &[Likeness]) -> Value {
    let mut value = results_json("validate", results);
    value["looks_like"] = json!(likely);
    value
}
