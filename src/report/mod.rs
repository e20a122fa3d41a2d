//! Results to text, JSON and JUnit. Nothing here reads, writes or prints.

mod json;
mod junit;
mod terminal;

pub use json::results_json;
pub use junit::results_junit;
pub use terminal::{likely_text, results_text};
