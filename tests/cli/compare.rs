//! `volref compare`

use crate::folder::{Folder, assert_shown};
use volref::film::Film;

/// A smooth image of 16 × 8 pixels, `edit`ed.
fn film(edit: impl Fn(usize, &mut [f32; 3])) -> Film {
    let mut pixels: Vec<_> = (0..16 * 8)
        .map(|i| [(i % 16) as f32 / 16.0, (i / 16) as f32 / 8.0, 0.25])
        .collect();
    for (index, pixel) in pixels.iter_mut().enumerate() {
        edit(index, pixel);
    }
    Film::new(16, 8, pixels)
}

/// `right` is the image, `ulp` off by a rounding, `hot` in one pixel, `small` of another size,
/// `nan` no image at all in one pixel.
fn images() -> Folder {
    let folder = Folder::new();
    for (name, film) in [
        ("right", film(|_, _| ())),
        ("ulp", film(|_, pixel| pixel[0] = pixel[0].next_up())),
        (
            "hot",
            film(|i, pixel| pixel[1] += if i == 37 { 1.0 } else { 0.0 }),
        ),
        (
            "nan",
            film(|i, pixel| pixel[2] = if i == 37 { f32::NAN } else { 0.25 }),
        ),
        ("small", Film::new(8, 8, vec![[0.5; 3]; 64])),
    ] {
        folder.write_film(&format!("{name}.exr"), &film);
        folder.write(&format!("{name}.png"), film.to_png(0.0));
    }
    folder
}

#[test]
fn a_pair_that_passes() {
    let run = images().volref("compare right.exr ulp.exr");
    assert_shown!(run.shown(), @r"
    exit code 0
    --- stdout
    pass  (deterministic gate)
    0 of 128 pixels differ by more than 0.001 + 1 %; the largest difference is 5.960e-8

      far_share              0
      max_abs_error          5.960464477539063e-8
      mean_difference_blue   0
      mean_difference_green  0
      mean_difference_red    3.958120942115784e-8
      outlier_pixels         0
      outlier_share          0
      worst_column           8
      worst_in_tolerances    0.000009934107462565104
      worst_row              0
    ");
}

#[test]
fn a_pair_that_fails() {
    let run = images().volref("compare right.exr hot.exr");
    assert_shown!(run.shown(), @r"
    exit code 1
    --- stdout
    fail  (deterministic gate)
    1 of 128 pixels (0.781 %) differ by more than 0.001 + 1 %; at most 0.02 % may. The worst is (5, 2), 285.7 times the tolerance

      far_share              0.0078125
      max_abs_error          1
      mean_difference_blue   0
      mean_difference_green  0.0078125
      mean_difference_red    0
      outlier_pixels         1
      outlier_share          0.0078125
      worst_column           5
      worst_in_tolerances    285.7142857142857
      worst_row              2
    ");
}

#[test]
fn json() {
    let run = images().volref("compare right.exr hot.exr --json");
    assert_shown!(run.shown(), @r#"
    exit code 1
    --- stdout
    {
      "cases": [
        {
          "class": "",
          "family": "",
          "gate": "deterministic",
          "looks_like": [],
          "metrics": {
            "far_share": 0.0078125,
            "max_abs_error": 1.0,
            "mean_difference_blue": 0.0,
            "mean_difference_green": 0.0078125,
            "mean_difference_red": 0.0,
            "outlier_pixels": 1.0,
            "outlier_share": 0.0078125,
            "worst_column": 5.0,
            "worst_in_tolerances": 285.7142857142857,
            "worst_row": 2.0
          },
          "name": "hot.exr",
          "reason": "1 of 128 pixels (0.781 %) differ by more than 0.001 + 1 %; at most 0.02 % may. The worst is (5, 2), 285.7 times the tolerance",
          "seconds": "[seconds]",
          "verdict": "fail",
          "work": {}
        }
      ],
      "schema": "volref/compare/1",
      "summary": {
        "convention": 0,
        "error": 0,
        "fail": 1,
        "inconclusive": 0,
        "missing": 0,
        "pass": 0
      }
    }
    "#);
}

#[test]
fn every_gate() {
    let folder = images();
    let mut said = String::new();
    for (gate, reference, test) in [
        ("exact", "right.exr", "right.exr"),
        ("exact", "right.exr", "ulp.exr"),
        ("deterministic", "right.exr", "ulp.exr"),
        ("deterministic", "right.exr", "hot.exr"),
        ("perceptual", "right.exr", "ulp.exr"),
        ("perceptual", "right.exr", "hot.exr"),
        ("perceptual", "right.png", "right.exr"),
        ("perceptual", "right.exr", "hot.png"),
        ("perceptual", "hot.png", "right.png"),
        ("exact", "right.exr", "small.exr"),
        ("deterministic", "right.exr", "nan.exr"),
        ("perceptual", "nan.exr", "right.exr"),
        ("perceptual", "right.png", "small.png"),
    ] {
        let run = folder.volref(&["compare", reference, test, "--gate", gate]);
        assert!(run.code < 2, "{}", run.stderr);
        let lines: Vec<_> = run.stdout.lines().take(2).collect();
        said.push_str(&format!(
            "{reference} {test}: {}\n  {}\n",
            lines[0], lines[1]
        ));
    }
    assert_shown!(said, @"
    right.exr right.exr: pass  (exact gate)
      all 128 pixels have the same bits
    right.exr ulp.exr: fail  (exact gate)
      128 of 128 pixels differ in colour and 0 in opacity; the largest difference of a channel is 5.960e-8
    right.exr ulp.exr: pass  (deterministic gate)
      0 of 128 pixels differ by more than 0.001 + 1 %; the largest difference is 5.960e-8
    right.exr hot.exr: fail  (deterministic gate)
      1 of 128 pixels (0.781 %) differ by more than 0.001 + 1 %; at most 0.02 % may. The worst is (5, 2), 285.7 times the tolerance
    right.exr ulp.exr: pass  (perceptual gate)
      FLIP: weighted 99th percentile 0.0000 (at most 0.065), mean 0.0000 (at most 0.06)
    right.exr hot.exr: fail  (perceptual gate)
      FLIP: weighted 99th percentile 0.4230 (at most 0.065), mean 0.0517 (at most 0.06)
    right.png right.exr: pass  (perceptual gate)
      FLIP: weighted 99th percentile 0.0000 (at most 0.065), mean 0.0000 (at most 0.06)
    right.exr hot.png: fail  (perceptual gate)
      FLIP: weighted 99th percentile 0.4230 (at most 0.065), mean 0.0517 (at most 0.06)
    hot.png right.png: fail  (perceptual gate)
      FLIP: weighted 99th percentile 0.4230 (at most 0.065), mean 0.0517 (at most 0.06)
    right.exr small.exr: fail  (exact gate)
      size differs: the reference has 16 × 8 pixels, the test image 8 × 8; render it at 16 × 8
    right.exr nan.exr: fail  (deterministic gate)
      1 of 128 pixels of the test image are not finite: (5, 2); the first has red, green, blue, opacity [0.3125, 0.25, NaN, 1.0]; look for a division by 0, a vector of length 0 that is normalised, or a value beyond the range of the file: half floats end at 65504
    nan.exr right.exr: fail  (perceptual gate)
      1 of 128 pixels of the reference are not finite: (5, 2); the first has red, green, blue, opacity [0.3125, 0.25, NaN, 1.0]; look for a division by 0, a vector of length 0 that is normalised, or a value beyond the range of the file: half floats end at 65504
    right.png small.png: fail  (perceptual gate)
      size differs: the reference has 16 × 8 pixels, the test image 8 × 8; render it at 16 × 8
    ");
}

/// Two radiances are judged as such; 8-bit codes only by how they look.
#[test]
fn the_gate_follows_from_the_images() {
    let folder = images();
    for (reference, test, gate) in [
        ("right.exr", "right.exr", "deterministic"),
        ("right.exr", "right.png", "perceptual"),
        ("right.png", "right.exr", "perceptual"),
        ("right.png", "right.png", "perceptual"),
    ] {
        let json = folder
            .volref(&["compare", reference, test, "--json"])
            .json();
        assert_eq!(json["cases"][0]["gate"], gate);
    }
    for gate in ["exact", "deterministic"] {
        let run = folder.volref(&["compare", "right.exr", "right.png", "--gate", gate]);
        run.expect(
            2,
            &[
                &format!("the {gate} gate compares linear images"),
                "perceptual",
            ],
        );
    }
}

#[test]
fn exposure_is_that_of_the_preview() {
    let folder = images();
    folder.write("dark.png", film(|_, _| ()).to_png(-2.0));
    let compare = |exposure| {
        folder
            .volref(&["compare", "right.exr", "dark.png", "--exposure", exposure])
            .code
    };
    assert_eq!(compare("-2"), 0);
    assert_eq!(compare("0"), 1);
}

#[test]
fn a_heat_map_is_bright_where_the_images_differ() {
    let folder = images();
    let run = folder.volref("compare right.exr hot.exr --heatmap map.png");
    assert_eq!(run.code, 1);
    let (width, height, codes) = Film::codes_from_png(&folder.read("map.png")).unwrap();
    assert_eq!((width, height), (16, 8));
    let light = |index: usize| {
        codes[index]
            .iter()
            .map(|&code| u32::from(code))
            .sum::<u32>()
    };
    let brightest = (0..codes.len()).max_by_key(|&index| light(index)).unwrap();
    assert!((brightest % 16).abs_diff(37 % 16) <= 1 && (brightest / 16).abs_diff(37 / 16) <= 1);
    let run = folder.volref("compare right.png right.exr --heatmap map.png");
    assert_eq!(run.code, 0);
    let (_, _, codes) = Film::codes_from_png(&folder.read("map.png")).unwrap();
    assert!(codes.iter().all(|code| *code == codes[0]));
}

/// The page of a pair, of radiance or of codes.
#[test]
fn a_pair_as_a_page() {
    let folder = images();
    for (pair, code) in [
        ("right.exr hot.exr", 1),
        ("right.png hot.png", 1),
        ("right.exr small.exr", 1),
    ] {
        let run = folder.volref(&*format!("compare {pair} --report page"));
        run.prints(code, &["report: page/index.html"]);
        let page = folder.text("page/index.html");
        let command = format!("volref compare {pair} --report page");
        crate::folder::assert_holds(
            &page,
            &["1 case: 0 passed, 1 failed", &command, "\"golden\":{"],
        );
    }
    let run = folder.volref("compare right.exr nan.exr --report page");
    assert_eq!(run.code, 1);
    crate::folder::assert_holds(&folder.text("page/index.html"), &["NaN or infinity in 1"]);
}
