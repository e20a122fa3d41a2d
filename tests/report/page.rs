//! The page as a file.

use crate::samples;
use volref::report::results_html;

/// Writes the report that the other tests look into, to be looked at: `cargo test --test report
/// -- --ignored`, then open the file it names.
#[test]
#[ignore = "for looking at"]
fn write_a_report() {
    let start = std::time::Instant::now();
    let html = results_html(&samples::suite().page());
    let path = std::env::temp_dir().join("volref-report.html");
    std::fs::write(&path, &html).unwrap();
    println!(
        "{} ({} bytes, {:?})",
        path.display(),
        html.len(),
        start.elapsed()
    );
}
