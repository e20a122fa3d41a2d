//! Results to text, JSON, JUnit and HTML. Nothing here reads, writes or prints.

mod html;
mod json;
mod junit;
mod terminal;

pub use html::{Page, results_html};
pub use json::results_json;
pub use junit::results_junit;
pub use terminal::results_text;
