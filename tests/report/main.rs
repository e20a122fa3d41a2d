//! The report: as a file, and in a browser.

mod browser;
mod page;
mod samples;
mod webdriver;
