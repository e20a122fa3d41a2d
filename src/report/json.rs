//! Results for other programs.

use crate::suite::{CaseResult, Summary};
use serde_json::{Value, json};

/// The results of the command `kind` (`verify`, `validate`, `compare`) as JSON.
pub fn results_json(kind: &str, results: &[CaseResult]) -> Value {
    json!({
        "schema": format!("volref/{kind}/1"),
        "cases": results,
        "summary": Summary::of(results),
    })
}
