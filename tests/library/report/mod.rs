//! The report: as a file, and in a browser.

mod browser;
mod cost;
mod cost_samples;
mod page;
mod samples;
mod webdriver;
