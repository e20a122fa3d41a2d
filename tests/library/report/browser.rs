//! The page in a browser: opened from `file://`, driven by keys and pointer, and read.
//!
//! Needs Chromium and its driver (Debian: `apt-get install chromium chromium-driver`).

use crate::needs::tried;
use crate::needs::tries;
use crate::report::samples::{self, CHECKED};
use crate::report::webdriver::Browser;
use serde_json::Value;
use std::collections::BTreeSet;
use std::sync::{Mutex, MutexGuard, PoisonError};
use volref::compare::Picture;
use volref::film::Film;
use volref::judging::Verdict;

const PAGE: &str = "index.html";

const ENTER: &str = "\u{e007}";
const ESCAPE: &str = "\u{e00c}";
const RIGHT: &str = "\u{e014}";
const DOWN: &str = "\u{e015}";

/// A browser that shows a page.
struct Opened {
    browser: Browser,
    /// Where the page is.
    folder: tempfile::TempDir,
    /// One browser at a time is work enough for a small machine.
    _turn: MutexGuard<'static, ()>,
}

fn open(html: &str, width: u32, height: u32) -> Option<Opened> {
    static TURN: Mutex<()> = Mutex::new(());
    // A test that failed has broken nothing for the next.
    let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let started = Browser::start(width, height);
    let reason = started.as_ref().err();
    let need = reason.map_or_else(String::new, |reason| format!("Chromium ({reason})"));
    if !tried(started.is_ok(), &need, "pages in a browser") {
        return None;
    }
    let browser = started.ok()?;
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(PAGE), html).unwrap();
    let opened = Opened {
        browser,
        folder,
        _turn: turn,
    };
    opened.load();
    Some(opened)
}

impl Opened {
    fn load(&self) {
        let path = self.folder.path().join(PAGE);
        self.browser.open(&format!("file://{}", path.display()));
    }
}

/// Returns when the pictures of the open case are shown.
fn wait_for_pictures(browser: &Browser) {
    browser.wait_for(
        "document.querySelector('article.open #viewer') && \
         document.querySelector('#stage-message').textContent === ''",
    );
}

/// Nothing may be complained of, and nothing asked for but the page itself.
fn check_quiet(browser: &Browser) {
    let mut console = browser.console();
    // That is about this test, which reads what the page only draws.
    console.retain(|message| !message.contains("getImageData"));
    assert_eq!(console, Vec::<String>::new());
    for url in browser.requests() {
        assert!(
            url.starts_with("file://") && url.ends_with("/index.html")
                || url.starts_with("data:image/png;"),
            "the page asked for {url}"
        );
    }
}

fn text(browser: &Browser, selector: &str) -> String {
    let script = format!("return document.querySelector({selector:?}).textContent");
    browser.run(&script).as_str().unwrap().to_owned()
}

fn number(text: &str) -> f64 {
    let plain = text.replace('−', "-").replace(['+', '%'], "");
    plain
        .trim()
        .parse()
        .unwrap_or_else(|_| panic!("{text:?} is no number"))
}

fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|number| number.as_f64().unwrap())
        .collect()
}

/// Of the read-out: golden, test and difference of a channel.
fn read_out(browser: &Browser, channel: usize) -> [f64; 3] {
    [2, 3, 4].map(|column| {
        let selector = format!(
            "#read-out tbody tr:nth-child({}) :nth-child({column})",
            channel + 1
        );
        number(&text(browser, &selector))
    })
}

/// Where the middle of a pixel is in the window, when the whole picture is shown in one pane.
fn place(browser: &Browser, film: &Film, [x, y]: [usize; 2]) -> [i64; 2] {
    let bounds = browser.run(
        "const box = document.querySelector('#stage canvas').getBoundingClientRect();
         return [box.left, box.top, box.width, box.height]",
    );
    let [left, top, width, height] = numbers(&bounds)[..] else {
        panic!("{bounds}")
    };
    let size = [film.width() as f64, film.height() as f64];
    let scale = (width / size[0]).min(height / size[1]);
    [
        left + width / 2.0 + (x as f64 + 0.5 - size[0] / 2.0) * scale,
        top + height / 2.0 + (y as f64 + 0.5 - size[1] / 2.0) * scale,
    ]
    .map(|at| at.round() as i64)
}

/// The colour that the first canvas shows there.
fn colour(browser: &Browser, [x, y]: [i64; 2]) -> [f64; 3] {
    let data = browser.run(&format!(
        "const canvas = document.querySelector('#stage canvas');
         const box = canvas.getBoundingClientRect();
         return [...canvas.getContext('2d').getImageData({x} - box.left, {y} - box.top, 1, 1).data]"
    ));
    let data = numbers(&data);
    [data[0], data[1], data[2]]
}

/// Eleven significant bits are off by half of 2⁻¹⁰, codes have 16384 steps of light, and the
/// steepest part of their curve makes 0.2 codes of one: a code can be rounded the other way.
fn assert_shows(browser: &Browser, at: [i64; 2], film: &Film, pixel: usize, exposure: f64) {
    let shown = colour(browser, at);
    let codes = film.srgb_codes(exposure)[pixel];
    for c in 0..3 {
        let expected = f64::from(codes[c]);
        assert!(
            (shown[c] - expected).abs() <= 1.0,
            "{shown:?} in place of {codes:?}"
        );
    }
}

#[test]
fn somebody_looks_into_a_failure() {
    let sample = samples::suite();
    let Some(Opened { browser, .. }) = &open(samples::suite_html(), 1400, 1100) else {
        return;
    };
    let index = sample
        .results
        .iter()
        .position(|result| result.name == CHECKED)
        .unwrap();
    let evidence = &sample.evidence[index];
    let golden = evidence.golden.as_ref().unwrap();
    let Some(Picture::Radiance(test)) = &evidence.test else {
        panic!("the test image is radiance");
    };

    // Failures come first, and the first is open.
    wait_for_pictures(browser);
    let first = text(browser, "#cases li .verdict");
    assert!(first.contains("fail"), "{first}");
    let failed = sample
        .results
        .iter()
        .filter(|r| r.verdict == Verdict::Fail)
        .count();
    let headline = text(browser, ".headline");
    let counts = format!("{} cases: ", sample.results.len());
    assert!(
        headline.contains(&counts) && headline.contains(&format!("{failed} failed")),
        "{headline}"
    );
    assert!(
        headline.contains(&format!("; likely cause of 1 of {failed}: “g negated”.")),
        "{headline}"
    );

    // The list is filtered by what is typed, and the case is opened by keys.
    let visible = "return document.querySelectorAll('#cases li:not([hidden])').length";
    assert_eq!(browser.run(visible), sample.results.len());
    browser.press(&format!("/{CHECKED}"));
    assert_eq!(browser.run(visible), 1);
    browser.press(&format!("{ESCAPE}j{ENTER}"));
    browser.wait_for(&format!(
        "document.querySelector('article.open h2').textContent.includes('{CHECKED}')"
    ));
    wait_for_pictures(browser);

    // The worst pixel is the one of the gate.
    browser.press("w");
    let metric = |name: &str| sample.results[index].metrics[name];
    let worst = [metric("worst_column"), metric("worst_row")].map(|place| place as usize);
    assert_eq!(
        text(browser, "#read-place"),
        format!("pixel ({}, {})", worst[0], worst[1])
    );

    // The read-out holds the values of the films.
    browser.press("01");
    let at = place(browser, golden, worst);
    browser.point(at);
    assert_eq!(
        text(browser, "#read-place"),
        format!("pixel ({}, {})", worst[0], worst[1])
    );
    let pixel = worst[1] * golden.width() + worst[0];
    for c in 0..3 {
        let [a, b] = [golden, test].map(|film| f64::from(film.radiance()[pixel][c]));
        // 2⁻¹¹ of it by the stored bits, and half of the fourth digit.
        let close =
            |shown: f64, value: f64| (shown - value).abs() <= value.abs() * (1.0 / 2048.0 + 0.5e-3);
        let [shown_a, shown_b, difference] = read_out(browser, c);
        assert!(close(shown_a, a), "golden {shown_a}, not {a}");
        assert!(close(shown_b, b), "test {shown_b}, not {b}");
        assert!(
            close(difference, b - a),
            "difference {difference}, not {}",
            b - a
        );
        assert!(b - a != 0.0, "the pixel says nothing");
    }
    assert_shows(browser, at, golden, pixel, evidence.exposure);

    // Exposure: two steps of half a stop.
    browser.press("++");
    assert_shows(browser, at, golden, pixel, evidence.exposure + 1.0);
    browser.press("2-");
    assert_shows(browser, at, test, pixel, evidence.exposure + 0.5);
    browser.press("-");

    // Swipe: at first in the middle; then the line is dragged beside the pixel, to either side.
    let line = "return Number(document.querySelector('#swipe').value)";
    browser.press("s");
    assert_eq!(browser.run(line), 0.5);
    let middle = place(browser, golden, [golden.width() / 2, golden.height() / 2]);
    for (side, film) in [(20, golden), (-20, test)] {
        browser.drag(middle, [at[0] + side, at[1]]);
        assert_shows(browser, at, film, pixel, evidence.exposure);
    }
    let before = browser.run(line).as_f64().unwrap();
    browser.press(RIGHT);
    let after = browser.run(line).as_f64().unwrap();
    assert!(after > before, "{before} → {after}");

    // The difference is red where the test is too bright, and nearly white where nothing is off.
    browser.press("3");
    let [red, _, blue] = colour(browser, at);
    assert!(red > blue + 50.0);
    let right = place(browser, golden, [worst[0], 20]);
    assert!(colour(browser, right).iter().all(|&code| code > 230.0));
    // Half of a scale finer, twice the colour.
    let limit = number(&text(browser, "#scale-value"));
    browser.press("[[");
    let finer = number(&text(browser, "#scale-value"));
    assert!((finer / limit - 0.5).abs() < 2e-3, "{limit} → {finer}");

    // Theme and help.
    let back = "return getComputedStyle(document.body).backgroundColor";
    let light = browser.run(back);
    browser.press("t");
    assert_ne!(browser.run(back), light);
    browser.press("t");
    assert_eq!(browser.run(back), light);
    browser.press("?");
    assert_eq!(
        browser.run("return document.querySelector('#help').open"),
        true
    );
    browser.press(ESCAPE);
    assert_eq!(
        browser.run("return document.querySelector('#help').open"),
        false
    );

    check_quiet(browser);
}

#[test]
fn every_case_opens_in_every_view() {
    let sample = samples::suite();
    let Some(Opened { browser, .. }) = &open(samples::suite_html(), 1400, 1100) else {
        return;
    };
    let mut opened = BTreeSet::new();
    let every = tries(8, 1);
    for place in (0..sample.results.len()).step_by(every) {
        let article = format!("document.querySelectorAll('article')[{place}]");
        browser.run(&format!("location.hash = encodeURIComponent({article}.id)"));
        browser.wait_for(&format!("{article}.classList.contains('open')"));
        let name = browser.run(&format!(
            "return document.querySelectorAll('#cases .name')[{place}].textContent"
        ));
        opened.insert(name.as_str().unwrap().to_owned());
        if browser.run("return Boolean(document.querySelector('article.open .pictures'))") == true {
            wait_for_pictures(browser);
            browser.press("123456bswnc+[z0");
        }
    }
    let names = sample.results.iter().map(|result| result.name.clone());
    assert!(opened.is_subset(&names.collect()), "{opened:?}");
    assert_eq!(opened.len(), sample.results.len().div_ceil(every));
    check_quiet(browser);
}

#[test]
fn a_pixel_that_is_no_number_is_found() {
    let Some(Opened { browser, .. }) = &open(samples::suite_html(), 1400, 1100) else {
        return;
    };
    browser.press(&format!("/gain-0.1{ENTER}"));
    browser.wait_for("document.querySelector('article.open h2').textContent.includes('gain-0.1')");
    wait_for_pictures(browser);
    browser.press(&format!("{ESCAPE}n"));
    assert_eq!(text(browser, "#read-place"), "pixel (64, 60)");
    assert_eq!(
        text(browser, "#read-out tbody tr:nth-child(1) :nth-child(3)"),
        "NaN"
    );
    browser.press(&"n".repeat(18));
    assert_eq!(text(browser, "#read-place"), "pixel (90, 90)");
    assert_eq!(
        text(browser, "#read-out tbody tr:nth-child(1) :nth-child(3)"),
        "∞"
    );
    check_quiet(browser);
}

#[test]
fn a_narrow_window_shows_the_list_or_the_case() {
    // Chromium's windows are no narrower than 500.
    let Some(Opened { browser, .. }) = &open(samples::suite_html(), 500, 900) else {
        return;
    };
    let shown = |selector: &str| {
        browser.run(&format!(
            "return document.querySelector({selector:?})?.checkVisibility() ?? false"
        ))
    };
    assert_eq!([shown("nav"), shown("article.open")], [true, false]);
    browser.press(&format!("{DOWN}{ENTER}"));
    wait_for_pictures(browser);
    assert_eq!([shown("nav"), shown("article.open")], [false, true]);
    // Nothing is cut off at the side.
    let fits = browser.run("return document.documentElement.scrollWidth <= innerWidth");
    assert_eq!(fits, true);
    browser.run("document.querySelector('article.open .back').click()");
    browser.wait_for("document.querySelector('nav').checkVisibility()");
    check_quiet(browser);
}
