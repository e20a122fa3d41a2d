//! Names of the rows of the catalogue of hard cases.

use crate::hard_cases::Row;

/// The family of the catalogue. A suite with cases of it has the rows, too.
pub(crate) const HARD: &str = "hard";

/// `hard/G1`.
pub(crate) fn row_name(row: &Row) -> String {
    format!("{HARD}/{}", row.id)
}
