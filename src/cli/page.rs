//! `--report DIR`: results as one offline page.

use super::failure::Failure;
use super::output;
use crate::report::{self, Page};
use std::path::{Path, PathBuf};

/// Name of the page within the folder of a report.
const PAGE: &str = "index.html";

/// Where a page is written.
#[derive(clap::Args, Debug)]
pub struct ReportPage {
    /// Write the report as one offline HTML page, DIR/index.html
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
}

impl ReportPage {
    /// True if a page is asked for, which shows the images behind the results.
    pub fn is_asked(&self) -> bool {
        self.report.is_some()
    }

    /// The file of the page.
    pub fn file(&self) -> Option<PathBuf> {
        self.report.as_deref().map(|folder| folder.join(PAGE))
    }

    /// Fails if the page cannot be written; called before long work.
    pub fn check(&self) -> Result<(), Failure> {
        let (Some(folder), Some(page)) = (&self.report, self.file()) else {
            return Ok(());
        };
        output::make_folder(folder)?;
        output::check_own(&page)
    }

    /// Writes the page if one is asked for, and says so in `text`.
    pub fn write(&self, page: &Page<'_>, text: &mut String) -> Result<(), Failure> {
        let Some(folder) = &self.report else {
            return Ok(());
        };
        let html = report::results_html(page);
        let path = output::write_within(folder, Path::new(PAGE), html.as_bytes())?;
        text.push_str(&format!("\nreport: {}\n", path.display()));
        Ok(())
    }
}
