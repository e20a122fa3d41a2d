//! A progress bar on a terminal, nothing in a pipe.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar over `rows` rows of pixels on stderr. In a pipe it draws nothing.
pub fn rows(label: &str, rows: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg:24} {bar:40} {percent:>3}% {eta:>5} left")
        .expect("a valid template");
    ProgressBar::new(rows as u64)
        .with_style(style)
        .with_message(label.to_owned())
}
