//! Results as text, plots, JSON, JUnit, CSV and HTML. Nothing here reads, writes or prints.

mod cost;
mod gallery;
mod html;
mod json;
mod junit;
mod self_test;
mod template;
mod terminal;

pub(crate) use cost::wrapped;
pub use cost::{cost_csv, cost_html, cost_json, cost_plot, cost_text};
pub(crate) use gallery::{GalleryAbout, GalleryRenderer, GalleryRow, gallery_html, gallery_row};
pub use html::{Page, results_html};
pub(crate) use json::results_json;
pub(crate) use junit::results_junit;
pub(crate) use self_test::{self_test_json, self_test_text};
pub(crate) use template::signed_colour;
pub(crate) use terminal::{families_text, judged_with_text, number_of, results_text, summary_text};
pub use terminal::{likely_text, verdict_text, widest};
