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

/// A bar over `cases` cases.
pub fn cases(cases: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{spinner} {msg:32} {bar:40} {pos}/{len}")
        .expect("a valid template");
    ProgressBar::new(cases as u64).with_style(style)
}

/// A bar over work whose amount is said later, with the time that is left.
pub fn work() -> ProgressBar {
    let style = ProgressStyle::with_template("{msg:32} {bar:40} {percent:>3}% {eta:>5} left")
        .expect("a valid template");
    ProgressBar::new(0).with_style(style)
}

/// What is being done, step by step; how many there are is not known.
pub fn steps() -> ProgressBar {
    let style = ProgressStyle::with_template("{spinner} {msg}").expect("a valid template");
    ProgressBar::new_spinner().with_style(style)
}

/// A sign of life while images are held against the catalogue of mistakes.
pub fn mistakes() -> ProgressBar {
    let style = ProgressStyle::with_template("{spinner} looking for the mistake")
        .expect("a valid template");
    ProgressBar::new_spinner().with_style(style)
}
