//! Results for other programs.

use crate::suite::{CaseResult, Likeness, Summary};
use serde_json::{Value, json};

/// The results of the command `kind` (`verify`, `validate`, `compare`) as JSON, with the mistakes
/// that they look like all together.
pub fn results_json(kind: &str, results: &[CaseResult], likely: &[Likeness]) -> Value {
    json!({
        "schema": format!("volref/{kind}/1"),
        "cases": results,
        "summary": Summary::of(results),
        "looks_like": likely,
    })
}
