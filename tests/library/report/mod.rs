//! The report: as a file, and in a browser.

mod browser;
mod cost;
mod page;
mod samples;
mod webdriver;

/// Fails if a page names an address outside of it.
fn asks_for_nothing_outside(html: &str) {
    for address in ["http:", "https:", "src=\"//", "@import", "url("] {
        assert!(!html.contains(address), "{address}");
    }
    for source in html.split("src=\"").skip(1) {
        assert!(
            source.starts_with("data:image/png;base64,"),
            "{}",
            &source[..40]
        );
    }
    assert!(html.contains("default-src 'none'"));
}
