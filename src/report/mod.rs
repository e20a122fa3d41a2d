//! Results to text, JSON, JUnit and HTML. Nothing here reads, writes or prints.

mod html;
mod json;
mod junit;
mod self_test;
mod terminal;

pub use html::{Page, results_html};
pub use json::{results_json, validation_json};
pub use junit::results_junit;
pub use self_test::{naming_text, self_test_json, self_test_text};
pub use terminal::{likely_text, results_text};
