//! The page as a file.

use crate::report::asks_for_nothing_outside;
use crate::report::samples::{self, HOSTILE, Numbers, Sample};
use volref::compare::flip::SrgbImage;
use volref::compare::{GATES, Picture};
use volref::film::Film;
use volref::judging::{Evidence, Verdict};
use volref::report::{Page, results_html};

/// Writes the report that the other tests look into, to be looked at: `cargo test --test report
/// -- --ignored`, then open the file it names.
#[test]
#[ignore = "for looking at"]
fn write_a_report() {
    let start = std::time::Instant::now();
    let html = samples::suite_html();
    let path = std::env::temp_dir().join("volref-report.html");
    std::fs::write(&path, html).unwrap();
    println!(
        "{} ({} bytes, {:?})",
        path.display(),
        html.len(),
        start.elapsed()
    );
}

/// Every text of a case with harmful texts is escaped, in the page and in its data.
#[test]
fn names_are_escaped() {
    let sample = samples::hostile();
    let page = Page {
        title: HOSTILE,
        command: HOSTILE,
        judged_with: HOSTILE,
        ..sample.page()
    };
    let html = results_html(&page);
    for harm in [
        "<img src=x",
        "<script>window",
        "</script><script>",
        "'x' onerror",
        "<!--]",
        "49<",
    ] {
        assert!(!html.contains(harm), "{harm}");
    }
    assert!(html.contains("&lt;img src=x onerror=window.hacked=1&gt;"));
    // All scripts of the page, and no more: theme, data of the case, palettes, program.
    assert_eq!(html.matches("<script").count(), 4);
    assert_eq!(html.matches("</script>").count(), 4);
}

#[test]
fn the_page_asks_for_nothing_outside() {
    asks_for_nothing_outside(samples::suite_html());
}

/// Every combination of what there may be of golden and test image, under every gate.
#[test]
fn odd_evidence_is_shown_too() {
    let gradient = |width: usize, height: usize| {
        let pixels = (0..width * height).map(|i| [i as f32, -1.0, 0.5]).collect();
        Film::new(width, height, pixels)
    };
    let broken = Film::new(3, 2, vec![[f32::NAN, f32::INFINITY, f32::NEG_INFINITY]; 6]);
    let extreme = Film::new(3, 2, vec![[f32::MAX, f32::MIN, 1e-45]; 6]);
    let noisy = Film::with_noise(3, 2, vec![[0.5; 3]; 6], vec![[f32::NAN, -1.0, 0.0]; 6], 2);
    let codes = |width, height| {
        let codes = vec![[0, 128, 255]; width * height];
        Picture::Codes(SrgbImage::new(width, height, codes).unwrap())
    };
    let films = [
        gradient(3, 2),
        broken,
        extreme,
        noisy,
        gradient(9, 20),
        gradient(0, 0),
        gradient(0, 5),
    ];
    let goldens = films.iter().cloned().map(Some).chain([None]);
    let tests: Vec<_> = films
        .iter()
        .cloned()
        .map(Picture::Radiance)
        .chain([codes(3, 2), codes(1, 1)])
        .map(Some)
        .chain([None])
        .collect();
    let mut sample = Sample::default();
    for golden in goldens {
        for test in &tests {
            for gate in GATES {
                let evidence = Evidence {
                    golden: golden.clone(),
                    test: test.clone(),
                    exposure: if gate.name() == "exact" {
                        f64::NAN
                    } else {
                        64.0
                    },
                    ..Evidence::default()
                };
                sample.push("a/b", Verdict::Fail, evidence).gate = gate;
            }
        }
    }
    let html = results_html(&sample.page());
    assert_eq!(html.matches("<article").count(), sample.results.len());
    assert!(html.contains("The images differ in size"));
    assert!(html.contains("The golden has no pixels"));

    // Evidence for none of the cases, and no case at all.
    let lone = Page {
        evidence: &[],
        ..sample.page()
    };
    assert!(results_html(&lone).contains("There is no readable test image"));
    let empty = Sample::default();
    assert!(results_html(&empty.page()).contains("Nothing was compared."));
}

#[test]
fn an_image_too_large_for_a_browser_is_left_out() {
    let mut sample = Sample::default();
    let evidence = Evidence {
        golden: Some(Film::new(2, 2, vec![[0.5; 3]; 4])),
        test: Some(Picture::Radiance(Film::new(
            4097,
            1024,
            vec![[0.5; 3]; 4097 * 1024],
        ))),
        ..Evidence::default()
    };
    sample.push("a/b", Verdict::Fail, evidence);
    let html = results_html(&sample.page());
    assert!(html.contains("left out of this page: it has 4097 × 1024 pixels"));
    assert!(html.len() < 100_000);
}

#[test]
fn the_same_results_give_the_same_page() {
    let sample = samples::hostile();
    assert_eq!(results_html(&sample.page()), results_html(&sample.page()));
}

/// 30 cases of 200 × 200 pixels, 1.2 million in all, coloured and noisy in every channel on its
/// own: what compresses worst of what renderers make.
#[test]
fn a_suite_stays_below_15_megabytes() {
    let mut numbers = Numbers(7);
    let mut sample = Sample::default();
    for case in 0..30 {
        let side = 200;
        let mut noisy = |amount: f32| {
            let pixels = (0..side * side).map(|i| {
                let (x, y) = ((i % side) as f32, (i / side) as f32);
                let smooth = [x + 50.0, y + 50.0, 300.0 - x].map(|v| v / 300.0);
                smooth.map(|v| v * (1.0 + amount * numbers.normal()))
            });
            Film::new(side, side, pixels.collect())
        };
        // 64 times fewer samples, eight times the noise.
        let (golden, test) = (noisy(0.02), noisy(0.16));
        let evidence = Evidence {
            golden: Some(golden),
            test: Some(Picture::Radiance(test)),
            ..Evidence::default()
        };
        sample.push(&format!("a/{case}"), Verdict::Fail, evidence);
    }
    let bytes = results_html(&sample.page()).len();
    println!("{bytes} bytes");
    assert!(bytes < 15_000_000, "{bytes} bytes");
}
