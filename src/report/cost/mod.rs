//! The cost of accuracy: for a terminal, for spreadsheets, for programs, and as one offline page.

mod page;
mod pictures;
mod plot;
mod table;
mod tables;
mod text;
mod words;

pub use page::{CostPage, cost_html};
pub use plot::work_precision_svg;
pub(crate) use table::wrapped;
pub use tables::cost_csv;
pub use text::cost_text;

use crate::cost::results::{Cost, Machine};
use serde_json::{Value, json};

/// The cost of accuracy as JSON, without error images.
pub fn cost_json(costs: &[Cost], machine: Option<&Machine>) -> Value {
    json!({
        "schema": "volref/cost/1",
        "machine": machine,
        "costs": costs,
    })
}
