//! Cost of accuracy, as text, CSV, JSON, plot and page.

use roxmltree::{Document, Node};
use volref::cost::advice::Recommendation;
use volref::cost::effects::EffectPrice;
use volref::cost::norms::Norms;
use volref::cost::order::{ExpectedOrder, order};
use volref::cost::timing::{Machine, Times};
use volref::cost::{Cost, Level, MeanWork, Parameter, Reference, Sweep};
use volref::render::Event;
use volref::report::{cost_csv, cost_json, cost_plot, cost_text};

fn machine() -> Machine {
    Machine {
        processor: "AMD EPYC 9R14".to_owned(),
        threads: 1,
        platform: "linux x86_64".to_owned(),
        compiler: "rustc 1.89.0".to_owned(),
        profile: "release",
        target_features: "fxsr, sse, sse2".to_owned(),
    }
}

fn times(median: f64) -> Times {
    Times {
        runs: 10,
        median,
        min: 0.8 * median,
        max: 1.5 * median,
        is_noisy: median > 1e-6,
    }
}

/// A sweep of the step: errors h²/16 above `floor`, work 8/h.
fn sweep(name: &'static str, floor: f64) -> Sweep {
    let level = |value: f64| Level {
        setting: Parameter::Step.words(value),
        value,
        work: MeanWork::from([(Event::DensityLookup, 8.0 / value)]),
        error: Norms {
            l2: value * value / 16.0 + floor,
            uncertainty: 0.02,
        },
        time: Some(times(128e-9 / value)),
    };
    let levels: Vec<Level> = [1.0, 0.5, 0.25, 0.125].map(level).into();
    let points = levels.iter().map(|level| (level.value, level.error));
    Sweep {
        name,
        parameter: Parameter::Step,
        own: 0.5,
        size: [16, 12],
        reference: Reference {
            method: "the same image with steps of 0.0078125 voxels".to_owned(),
            bound: 1e-5,
        },
        order: order(points.collect(), ExpectedOrder::of_step(2.0), 1e-5),
        levels,
        cut: None,
    }
}

fn sample() -> Cost {
    let effect = |effect: &str, lookups: f64, times_lookups: f64| EffectPrice {
        effect: effect.to_owned(),
        work: MeanWork::from([(Event::DensityLookup, lookups)]),
        time: Some(times(1e-9 * lookups)),
        times_lookups: Some(times_lookups),
    };
    let mut dear = sweep("step without light", 1e-3);
    dear.cut = Some("the budget was used up after 4 of 9 settings".to_owned());
    Cost {
        scene: "plume".to_owned(),
        panel: Some("left half".to_owned()),
        sweeps: vec![sweep("step", 0.0), dear],
        effects: vec![
            effect("absorption and emission", 16.0, 1.0),
            effect("with volume shadow", 200.0, 12.5),
        ],
        recommendations: vec![Recommendation {
            error: 1e-2,
            text: "for an error of 1 %: steps of 0.25 voxels, 2 times the work".to_owned(),
            command: Some("volref render plume -o image.exr --step \"0.25 voxels\"".to_owned()),
        }],
        notes: vec!["`early_termination` is left out".to_owned()],
    }
}

/// Values at the edge of what may come: errors that are zero or no number, nothing counted, nothing tried.
pub fn extremes() -> Cost {
    let mut odd = sweep("step", 0.0);
    odd.levels[0].error.l2 = f64::INFINITY;
    odd.levels[1].error.l2 = 0.0;
    odd.levels[2].work = MeanWork::default();
    let mut empty = sweep("samples", 0.0);
    empty.levels.clear();
    empty.order = order(Vec::new(), ExpectedOrder::OF_SAMPLES, 0.0);
    Cost {
        scene: "nowhere".to_owned(),
        sweeps: vec![odd, empty],
        ..Cost::default()
    }
}

#[test]
fn text_says_what_to_take_then_how_errors_fall_then_what_effects_cost() {
    insta::assert_snapshot!(cost_text(&[sample()], Some(&machine())), @r#"
    plume: left half
    ================

    recommended settings
      for an error of 1 %: steps of 0.25 voxels, 2 times the work
        volref render plume -o image.exr --step "0.25 voxels"

    step: 16 × 12 pixels by the distance between samples along a ray
      setting       lookups  RMS error  order             time per pixel
      1 voxel          8.00    6.25e-2      –           128 (102–192) ns
      0.5 voxels       16.0    1.56e-2   2.00           256 (205–384) ns
      0.25 voxels      32.0    3.91e-3   2.00           512 (410–768) ns
      0.125 voxels     64.0  ° 9.77e-4   2.00  1.02 (0.82–1.54) µs noisy
      reference: the same image with steps of 0.0078125 voxels; its own error at most 1.00e-5
      order 2.00, expected 2: ✓ as expected
      ° too near to the error of the reference: not above 1.00e-3

    step without light: 16 × 12 pixels by the distance between samples along a ray
      setting       lookups  RMS error  order             time per pixel
      1 voxel          8.00    6.35e-2      –           128 (102–192) ns
      0.5 voxels       16.0    1.66e-2   1.93           256 (205–384) ns
      0.25 voxels      32.0    4.91e-3   1.76           512 (410–768) ns
      0.125 voxels     64.0    1.98e-3   1.31  1.02 (0.82–1.54) µs noisy
      reference: the same image with steps of 0.0078125 voxels; its own error at most 1.00e-5
      order 1.68, expected 2: ? undecided: too few settings count, or the order still changes
      ended early: the budget was used up after 4 of 9 settings

    price of each effect by itself, per pixel
      effect                   lookups  × work                 time  × time
      absorption and emission     16.0     1.0  16.0 (12.8–24.0) ns     1.0
      with volume shadow           200    12.5     200 (160–300) ns    12.5

    notes
      `early_termination` is left out

    times: AMD EPYC 9R14, 1 thread, linux x86_64, rustc 1.89.0, release, target features fxsr, sse, sse2
    "#);
    let text = cost_text(&[sample(), extremes()], Some(&machine()));
    for line in text.lines().filter(|line| !line.contains("volref render")) {
        assert!(line.chars().count() <= 100, "{line}");
        assert_eq!(line.trim_end(), line);
    }
}

#[test]
fn csv_has_a_row_for_each_setting_and_each_effect() {
    let mut cost = sample();
    cost.scene = "a, \"b\"\nc".to_owned();
    let [(sweeps, settings), (effects, prices)] = cost_csv(&[cost]);
    assert_eq!([sweeps, effects], ["sweeps.csv", "effects.csv"]);
    for (text, rows) in [(&settings, 8), (&prices, 2)] {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let heads = reader.headers().unwrap().clone();
        let records: Vec<_> = reader.records().map(Result::unwrap).collect();
        assert_eq!(records.len(), rows);
        assert_eq!(&records[0][0], "a, \"b\"\nc");
        // All times, and nothing but times, are in the last columns.
        let of_runs = ["runs", "is_noisy"];
        let is_time = |head: &str| head.contains("seconds") || of_runs.contains(&head);
        let times: Vec<bool> = heads.iter().map(is_time).collect();
        assert!(times.is_sorted(), "{heads:?}");
    }
    let rows = settings.replace("\"a, \"\"b\"\"\nc\"", "plume");
    let rows: Vec<&str> = rows.lines().take(3).collect();
    insta::assert_snapshot!(rows.join("\n"), @"
    scene,panel,sweep,parameter,setting,value,density_lookups,gradient_lookups,gradients_computed,cells_walked,shadow_rays,phase_evaluations,null_collisions,surface_tests,random_draws,attenuations,channel_attenuations,emission_terms,first_scatterings,further_scatterings,l2,l2_uncertainty,local_order,fitted_order,expected_order,verdict,reference_bound,runs,median_seconds,min_seconds,max_seconds,is_noisy
    plume,left half,step,step,1 voxel,1.0,8.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0625,0.02,,2.0,2.0,as-expected,0.00001,10,1.28e-7,1.0240000000000002e-7,1.9200000000000003e-7,false
    plume,left half,step,step,0.5 voxels,0.5,16.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.0,0.015625,0.02,1.9999999999999996,2.0,2.0,as-expected,0.00001,10,2.56e-7,2.0480000000000003e-7,3.8400000000000005e-7,false
    ");
}

#[test]
fn json_has_a_schema() {
    let value = cost_json(&[sample()], Some(&machine()));
    assert_eq!(value["schema"], "volref/cost/1");
    assert_eq!(value["machine"]["threads"], 1);
    let sweep = &value["costs"][0]["sweeps"][0];
    assert_eq!(sweep["parameter"], "step");
    assert_eq!(sweep["order"]["verdict"], "as-expected");
    assert_eq!(sweep["levels"][1]["work"]["density_lookups"], 16.0);
    assert_eq!(sweep["levels"][1]["time"]["runs"], 10);
}

fn texts<'a>(document: &'a Document<'_>) -> Vec<Node<'a, 'a>> {
    let nodes = document.descendants();
    nodes.filter(|node| node.has_tag_name("text")).collect()
}

/// Each curve has a mark with its setting and a line of its own in the legend; no text begins or ends beyond the edges.
#[test]
fn a_plot_has_every_setting() {
    let mut cost = sample();
    let svg = cost_plot(&cost);
    let document = Document::parse(&svg).unwrap();
    let nodes = texts(&document);
    let said: Vec<&str> = nodes.iter().filter_map(|node| node.text()).collect();
    for setting in ["1", "1/2", "1/4", "1/8"] {
        let count = said.iter().filter(|text| **text == setting).count();
        assert!(count >= 2, "{setting}: {said:?}");
    }
    assert!(
        said.contains(&"step [voxels]: order 2.00, expected 2"),
        "{said:?}"
    );
    assert!(said.contains(&"lookups per pixel"), "{said:?}");
    for node in nodes {
        let number = |name: &str| -> f64 { node.attribute(name).unwrap().parse().unwrap() };
        // No letter is narrower than half of its size, on average.
        let length = 0.5 * 11.5 * node.text().unwrap().chars().count() as f64;
        let share = match node.attribute("text-anchor") {
            Some("middle") => 0.5,
            Some("end") => 1.0,
            _ => 0.0,
        };
        let ends = [-share, 1.0 - share].map(|share| number("x") + share * length);
        assert!(ends[0] >= 0.0 && ends[1] <= 800.0, "{node:?}: {ends:?}");
    }
    // Where nothing is looked up, random numbers are counted, and called so.
    for level in cost.sweeps.iter_mut().flat_map(|sweep| &mut sweep.levels) {
        level.work[Event::RandomDraw] = std::mem::take(&mut level.work[Event::DensityLookup]);
    }
    let svg = cost_plot(&cost);
    assert!(svg.contains("random numbers per pixel") && !svg.contains("lookups"));
}

#[test]
fn what_cannot_be_drawn_is_left_out() {
    let svg = cost_plot(&extremes());
    Document::parse(&svg).unwrap();
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
}
