//! The report: as a file, and in a browser.

mod page;
mod samples;
