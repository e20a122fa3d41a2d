//! Cost of accuracy, as text, CSV, JSON and page.

use crate::report::asks_for_nothing_outside;
use crate::report::cost_samples::{costs, extremes, machine, small};
use crate::report::samples::HOSTILE;
use roxmltree::{Document, Node};
use volref::cost::results::{Cost, Event, Parameter, Recommendation};
use volref::report::{CostPage, cost_csv, cost_html, cost_json, cost_text, work_precision_svg};

pub fn page(costs: &[Cost]) -> String {
    cost_html(&CostPage {
        title: "what accuracy costs",
        command: "volref cost fixtures/scenes/plume.toml --report cost",
        costs,
        machine: Some(&machine()),
    })
}

/// Writes the page and the picture, to be looked at: `cargo test --test library report:: -- --ignored`, then
/// open the files it names.
#[test]
#[ignore = "for looking at"]
fn write_a_cost_page() {
    let folder = std::env::temp_dir().join("volref-cost");
    std::fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, text: &str| {
        std::fs::write(folder.join(name), text).unwrap();
        println!("{} ({} bytes)", folder.join(name).display(), text.len());
    };
    let costs = costs();
    write("cost.html", &page(&costs));
    write("extremes.html", &page(&[extremes()]));
    write("cost.txt", &cost_text(&costs, Some(&machine())));
    for (at, study) in costs[0].studies.iter().enumerate() {
        write(
            &format!("work-precision-{at}.svg"),
            &work_precision_svg(study),
        );
    }
    for (name, text) in cost_csv(&costs) {
        write(&name, &text);
    }
}

#[test]
fn text_says_what_to_take_then_what_it_costs_then_how_errors_fall() {
    let mut cost = small();
    cost.recommendations = vec![Recommendation {
        error: 1e-2,
        text: "for an error of 1 %: steps of 0.25 voxels, 2 times the work".to_owned(),
        command: Some("volref render fog.toml --step 0.005 -o fog.exr".to_owned()),
    }];
    cost.notes = vec!["no lights, so nothing is scattered".to_owned()];
    insta::assert_snapshot!(cost_text(&[cost], Some(&machine())), @"
    fog: left half
    ==============

    recommended settings
      for an error of 1 %: steps of 0.25 voxels, 2 times the work
        volref render fog.toml --step 0.005 -o fog.exr

    transmittance
      Transmittance of one ray.
      reference: closed form; its own error at most 1.00e-12

    transmittance: cheapest settings for a given error
      error  estimator  setting       lookups  × cheapest  time per ray
      1e-2   midpoint   0.25 voxels      33.0         1.0        516 ns
      1e-3   midpoint   0.125 voxels     65.0         1.0       1.02 µs
      1e-2 was not reached in the range tested by: left
      1e-3 was not reached in the range tested by: left

    transmittance: convergence orders
      estimator  varied  expected     ±  fitted  of max  verdict
      midpoint   step           2  0.10    2.00    1.97  ✓ as expected
      left       step           1  0.10    0.41    0.97  ✗ not as expected

    transmittance: midpoint (as in the reference renderer)
      setting       lookups       L1       L2      max  order  f32 off            time per ray
      1 voxels         9.00  4.37e-2  6.25e-2  2.63e-1      –        –  141 (112–180) ns noisy
      0.5 voxels       17.0  1.09e-2  1.56e-2  6.56e-2   2.00        –        266 (212–340) ns
      0.25 voxels      33.0  2.73e-3  3.91e-3  1.64e-2   2.00        –        516 (412–660) ns
      0.125 voxels     65.0  6.84e-4  9.77e-4  4.10e-3   2.00  2.00e-3     1.02 (0.81–1.30) µs

    transmittance: left
      setting       lookups       L1       L2      max  order            time per ray
      1 voxels         9.00  4.37e-2  6.25e-2  2.63e-1      –  141 (112–180) ns noisy
      0.5 voxels       17.0  2.19e-2  3.12e-2  1.31e-1   1.00        266 (212–340) ns
      0.25 voxels      33.0  1.09e-2  1.56e-2  6.56e-2   1.00        516 (412–660) ns
      0.125 voxels     65.0  5.47e-3  3.00e-2  3.28e-2  -0.94     1.02 (0.81–1.30) µs

    not measured
      no lights, so nothing is scattered

    fog: left half, for an error of 1 %: steps of 0.25 voxels, 2 times the work
    ✗ fog: left half, transmittance, left: order 0.41, expected 1 ± 0.10
    2 convergence orders: 1 as expected, 1 not as expected.
    times: AMD EPYC 9R14, 1 thread, linux x86_64, rustc 1.89.0, release, target features fxsr, sse, sse2
    ");
}

#[test]
fn csv_has_a_file_for_each_table() {
    let files = cost_csv(&[small()]);
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["sweeps.csv", "orders.csv", "prices.csv"]);
    insta::assert_snapshot!(files[0].1, @"
    scene,panel,study,estimator,is_ours,parameter,setting,value,density_lookups,gradient_lookups,cells_walked,shadow_rays,phase_evaluations,null_collisions,surface_tests,random_draws,l1,l2,max,l2_uncertainty,judged_l1,judged_l2,judged_max,local_order,f32_off_l1,f32_off_l2,f32_off_max,reference_bound,runs,median_seconds,min_seconds,max_seconds,deviation_seconds,outliers,is_noisy
    fog,left half,transmittance,midpoint,true,step,1 voxels,0.02,9.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.04375,0.0625,0.2625,0.02,,,,,,,,1e-12,10,1.40625e-7,1.125e-7,1.8e-7,1.40625e-8,1,true
    fog,left half,transmittance,midpoint,true,step,0.5 voxels,0.01,17.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0109375,0.015625,0.065625,0.02,,,,2.0,,,,1e-12,10,2.65625e-7,2.125e-7,3.4e-7,2.65625e-8,1,false
    fog,left half,transmittance,midpoint,true,step,0.25 voxels,0.005,33.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.002734375,0.00390625,0.01640625,0.02,,,,2.0,,,,1e-12,10,5.15625e-7,4.125e-7,6.6e-7,5.15625e-8,1,false
    fog,left half,transmittance,midpoint,true,step,0.125 voxels,0.0025,65.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.00068359375,0.0009765625,0.0041015625,0.02,,,,2.0,0.001,0.002,0.004,1e-12,10,1.015625e-6,8.125e-7,1.3e-6,1.015625e-7,1,false
    fog,left half,transmittance,left,false,step,1 voxels,0.02,9.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.04375,0.0625,0.2625,0.02,,,,,,,,1e-12,10,1.40625e-7,1.125e-7,1.8e-7,1.40625e-8,1,true
    fog,left half,transmittance,left,false,step,0.5 voxels,0.01,17.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.021875,0.03125,0.13125,0.02,,,,1.0,,,,1e-12,10,2.65625e-7,2.125e-7,3.4e-7,2.65625e-8,1,false
    fog,left half,transmittance,left,false,step,0.25 voxels,0.005,33.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0109375,0.015625,0.065625,0.02,,,,1.0,,,,1e-12,10,5.15625e-7,4.125e-7,6.6e-7,5.15625e-8,1,false
    fog,left half,transmittance,left,false,step,0.125 voxels,0.0025,65.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.00546875,0.03,0.0328125,0.02,,,,-0.94,,,,1e-12,10,1.015625e-6,8.125e-7,1.3e-6,1.015625e-7,1,false
    ");
    insta::assert_snapshot!(files[1].1, @"
    scene,panel,study,of,parameter,expected,tolerance,fitted,fitted_max,verdict,cut
    fog,left half,transmittance,midpoint,step,2.0,0.1,2.0,1.97,as-expected,
    fog,left half,transmittance,left,step,1.0,0.1,0.41,0.97,otherwise,
    ");
    insta::assert_snapshot!(files[2].1, @"
    scene,panel,study,error,estimator,parameter,setting,lookups,times_cheapest,seconds
    fog,left half,transmittance,0.01,midpoint,step,0.25 voxels,33.0,1.0,5.15625e-7
    fog,left half,transmittance,0.01,left,step,,,,
    fog,left half,transmittance,0.001,midpoint,step,0.125 voxels,65.0,1.0,1.015625e-6
    fog,left half,transmittance,0.001,left,step,,,,
    ");

    let files = cost_csv(&costs());
    assert_eq!(files.len(), 7);
    for (name, text) in files {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let heads = reader.headers().unwrap().clone();
        assert_eq!(&heads[0], "scene", "{name}");
        assert!(reader.records().count() >= 4, "{name}");
        // All times, and nothing but times, are in the last columns.
        let is_time = |head: &str| head.contains("seconds") || head.contains("is_noisy");
        let is_of_runs = |head: &str| head == "runs" || head == "outliers";
        let times: Vec<bool> = heads.iter().map(|h| is_time(h) || is_of_runs(h)).collect();
        assert!(times.is_sorted(), "{name}: {heads:?}");
    }
}

#[test]
fn csv_quotes_what_it_must() {
    let mut cost = small();
    cost.scene = "a, \"b\"\nc".to_owned();
    let (_, text) = &cost_csv(&[cost])[0];
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let record = reader.records().next().unwrap().unwrap();
    assert_eq!(&record[0], "a, \"b\"\nc");
}

#[test]
fn json_has_a_schema() {
    let value = cost_json(&costs(), Some(&machine()));
    assert_eq!(value["schema"], "volref/cost/1");
    assert_eq!(value["machine"]["threads"], 1);
    let study = &value["costs"][0]["studies"][0];
    assert_eq!(study["sweeps"][1]["parameter"], "shadow-step");
    assert_eq!(study["sweeps"][4]["order"]["verdict"], "otherwise");
    let read: Vec<Cost> = serde_json::from_value(value["costs"].clone()).unwrap();
    assert_eq!(read[1], small());
}

#[test]
fn text_keeps_to_a_hundred_columns() {
    let costs = [costs(), vec![extremes()]].concat();
    let text = cost_text(&costs, Some(&machine()));
    for line in text.lines().filter(|line| !line.contains("volref render")) {
        assert!(line.chars().count() <= 100, "{line}");
        assert_eq!(line.trim_end(), line);
    }
}

/// Every drawing on the page, read as XML.
fn drawings(html: &str) -> Vec<&str> {
    html.match_indices("<svg")
        .map(|(from, _)| &html[from..from + html[from..].find("</svg>").unwrap() + 6])
        .collect()
}

fn texts<'a>(document: &'a Document<'_>) -> Vec<&'a str> {
    let is_text = |node: &Node<'_, '_>| node.has_tag_name("text") || node.has_tag_name("title");
    let nodes = document.descendants().filter(is_text);
    nodes.filter_map(|node| node.text()).collect()
}

#[test]
fn every_study_has_its_plots() {
    let costs = costs();
    let html = page(&costs);
    let studies: usize = costs.iter().map(|cost| cost.studies.len()).sum();
    assert_eq!(html.matches("<figure class=\"work\">").count(), studies);
    assert_eq!(html.matches("<figure class=\"orders\">").count(), 2);
    assert_eq!(html.matches("<figure class=\"thickness\">").count(), 1);
    assert_eq!(html.matches("<figure class=\"jitter\">").count(), 1);
    // And the ray of one study.
    let drawings = drawings(&html);
    // Each is there broad and narrow.
    assert_eq!(drawings.len(), 2 * (studies + 2 + 1 + 1 + 1));
    for drawing in &drawings {
        Document::parse(drawing).unwrap();
    }
    // Of each study, a mark with its value for every setting in both panels.
    for (study, drawing) in costs.iter().flat_map(|cost| &cost.studies).zip(
        drawings
            .iter()
            .filter(|drawing| drawing.contains("Work and precision"))
            .filter(|drawing| drawing.contains("class=\"broad\"")),
    ) {
        let document = Document::parse(drawing).unwrap();
        let texts = texts(&document);
        for sweep in &study.sweeps {
            let told = |text: &&&str| text.contains(&sweep.estimator);
            assert!(texts.iter().filter(told).count() > 2 * sweep.levels.len());
        }
        for axis in [
            "lookups per ray",
            "error: relative RMSE",
            "slope −½",
            "slope −1",
        ] {
            assert!(texts.iter().any(|text| text.trim() == axis), "{axis}");
        }
    }
}

#[test]
fn failures_are_shown() {
    let html = page(&costs());
    for words in [
        "2 not as expected, 1 not yet asymptotic; 4 of 5 estimators agree",
        "plume, image, centre sample: order 0.46, expected 2",
        "plume, transmittance, midpoint, linear opacity: not yet asymptotic",
        "✗ disagrees",
        "not reached by any setting that was measured: 1e-6",
        "ratio tracking ended early: 65536 samples would take 3 minutes",
    ] {
        assert!(html.contains(words), "{words}");
    }
}

/// Where nothing is looked up, random numbers are counted, and called so everywhere.
#[test]
fn what_is_counted_is_named() {
    let mut cost = small();
    let study = &mut cost.studies[0];
    for level in study.sweeps.iter_mut().flat_map(|sweep| &mut sweep.levels) {
        level.work[Event::RandomDraw] = std::mem::take(&mut level.work[Event::DensityLookup]);
    }
    let svg = work_precision_svg(study);
    assert!(svg.contains("random numbers per ray") && !svg.contains("lookups"));
    let text = cost_text(&[cost.clone()], None);
    assert!(text.contains("setting       random numbers"), "{text}");
    assert!(
        text.contains("setting       random numbers  × cheapest"),
        "{text}"
    );
    assert!(!text.contains("lookups"), "{text}");
    cost.studies[0].sweeps[0].levels[0].work[Event::DensityLookup] = 1.0;
    let svg = work_precision_svg(&cost.studies[0]);
    assert!(svg.contains("lookups or random numbers per ray"));
}

/// No text of a drawing begins or ends beyond its edges, whatever its letters: none is narrower than
/// half of its size, on average.
#[test]
fn no_label_is_cut_off() {
    let html = page(&[costs(), vec![extremes()]].concat());
    for drawing in drawings(&html) {
        let document = Document::parse(drawing).unwrap();
        let svg = document.root_element();
        let number = |node: &Node<'_, '_>, name: &str| -> f64 {
            let value = node.attribute(name).unwrap();
            value.trim_end_matches("px").parse().unwrap()
        };
        let view = svg.attribute("viewBox").unwrap();
        let size: Vec<f64> = view.split(' ').map(|size| size.parse().unwrap()).collect();
        for text in svg.children().filter(|node| node.has_tag_name("text")) {
            let letters = text.text().unwrap_or_default().trim().chars().count() as f64;
            let length = 0.5 * number(&text, "font-size") * letters;
            let share = match text.attribute("text-anchor") {
                Some("middle") => 0.5,
                Some("end") => 1.0,
                _ => 0.0,
            };
            let (at, room) = match text.attribute("transform") {
                None => (number(&text, "x"), size[2]),
                // Upwards, along the first axis.
                Some(_) => (number(&text, "y"), size[3]),
            };
            let ends = [at - share * length, at + (1.0 - share) * length];
            assert!(
                ends[0] >= 0.0 && ends[1] <= room,
                "{text:?}: {ends:?} of {room}"
            );
        }
    }
}

#[test]
fn what_cannot_be_drawn_is_told() {
    let html = page(&[extremes()]);
    for words in [
        "whose error is not a finite number",
        "Not drawn by work: closed form",
        "work is the number of random numbers drawn: blind guess",
        "? nowhere, image, path tracer: undecided",
    ] {
        assert!(html.contains(words), "{words}");
    }
    for drawing in drawings(&html) {
        Document::parse(drawing).unwrap();
        assert!(!drawing.contains("NaN") && !drawing.contains("inf"));
    }
}

/// All texts of a scene are hostile.
#[test]
fn names_are_escaped() {
    let text = || HOSTILE.to_owned();
    let mut cost = costs().swap_remove(0);
    cost.scene = text();
    cost.panel = Some(text());
    cost.notes = vec![text()];
    for study in &mut cost.studies {
        study.quantity = text();
        study.reference.method = text();
        for picture in &mut study.pictures {
            picture.setting = text();
        }
        if let Some(ray) = &mut study.worst_ray {
            ray.ray = text();
            ray.setting = text();
        }
        for sweep in &mut study.sweeps {
            sweep.estimator = text();
            sweep.cut = Some(text());
            for level in &mut sweep.levels {
                level.setting = text();
            }
        }
    }
    for curve in &mut cost.thickness.as_mut().unwrap().curves {
        curve.estimator = text();
    }
    for curve in &mut cost.jitter.as_mut().unwrap().curves {
        curve.jitter = text();
    }
    for row in &mut cost.estimators.as_mut().unwrap().rows {
        row.estimator = text();
    }
    for advice in &mut cost.recommendations {
        advice.text = text();
        advice.command = Some(text());
    }
    for effect in &mut cost.effects {
        effect.effect = text();
    }
    let html = page(&[cost]);
    for harm in ["<script", "<img src=x", "'x' onerror", "<!--]", "49&lt;"] {
        assert!(!html.contains(harm), "{harm}");
    }
    assert!(html.contains("&lt;script&gt;window.hacked=1"));
    for drawing in drawings(&html) {
        Document::parse(drawing).unwrap();
    }
}

#[test]
fn the_page_asks_for_nothing_outside() {
    let html = page(&costs()).replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    asks_for_nothing_outside(&html);
    assert!(!html.contains("<script"));
}

/// A file of its own has colours and no variables of a page.
#[test]
fn the_picture_stands_alone() {
    let svg = work_precision_svg(&costs()[0].studies[1]);
    let document = Document::parse(&svg).unwrap();
    let root = document.root_element();
    assert_eq!(root.attribute("width"), Some("800"));
    assert!(
        root.attribute("font-family")
            .unwrap()
            .contains("sans-serif")
    );
    assert!(!svg.contains("var("));
    // Strokes that were drawn as numbers would end like this.
    assert!(!svg.contains("A5\""));
    assert!(svg.contains("<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>"));
}

/// Without times there is one panel.
#[test]
fn without_times_there_is_one_panel() {
    let mut study = costs().swap_remove(0).studies.swap_remove(1);
    assert!(work_precision_svg(&study).contains("wall time"));
    for sweep in &mut study.sweeps {
        for level in &mut sweep.levels {
            level.time = None;
        }
    }
    assert!(!work_precision_svg(&study).contains("wall time"));
    assert!(
        study
            .sweeps
            .iter()
            .any(|sweep| sweep.parameter == Parameter::None)
    );
}
