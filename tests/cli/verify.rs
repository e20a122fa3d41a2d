//! `volref verify`

use crate::folder::{CLOUD, Folder, assert_shown};
use serde_json::Value;

#[test]
fn a_suite_that_passes() {
    let suite = Folder::with_goldens();
    let before = suite.files();
    assert_shown!(suite.volref("verify").shown(), @r"
    exit code 0
    --- stdout
    plots  1 of 1 pass [seconds]
    smoke  3 of 3 pass [seconds]

    4 cases: 4 passed
    ");
    assert_shown!(suite.volref("verify --verbose").shown(), @r"
    exit code 0
    --- stdout
    pass          plots/curve [seconds]
    pass          smoke/nearest [seconds]
    pass          smoke/plain [seconds]
    pass          smoke/shadow [seconds]

    4 cases: 4 passed
    ");
    assert_eq!(suite.files(), before, "verify writes nothing");
}

/// The contract, to the letter: other programs read this.
#[test]
fn json_has_the_promised_keys() {
    let suite = Folder::with_goldens();
    suite.remove("golden/smoke/plain.exr");
    let json = suite.volref("verify --json").json();
    let keys = |value: &Value| -> Vec<String> {
        let mut keys: Vec<_> = value.as_object().unwrap().keys().cloned().collect();
        keys.sort();
        keys
    };
    assert_eq!(json["schema"], "volref/verify/1");
    assert_eq!(keys(&json), ["cases", "schema", "summary"]);
    assert_eq!(
        keys(&json["summary"]),
        [
            "convention",
            "error",
            "fail",
            "inconclusive",
            "missing",
            "pass"
        ]
    );
    let cases = json["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 4);
    for case in cases {
        let mut always = keys(case);
        always.retain(|key| *key != "notes");
        assert_eq!(
            always,
            [
                "class",
                "family",
                "gate",
                "looks_like",
                "metrics",
                "name",
                "reason",
                "seconds",
                "verdict",
                "work"
            ]
        );
        for (name, value) in case["metrics"].as_object().unwrap() {
            assert!(value.is_number(), "{name} is {value}");
        }
    }
    let counted: u64 = json["summary"]
        .as_object()
        .unwrap()
        .values()
        .map(|count| count.as_u64().unwrap())
        .sum();
    assert_eq!(counted, 4);
}

#[test]
fn json_and_junit_in_files() {
    let suite = Folder::with_goldens();
    suite.remove("golden/plots/curve.exr");
    suite.remove("golden/plots/curve.png");
    suite.remove("golden/plots/curve.toml");
    suite.edit("fixtures/volumes/cloud.obj", "v 1 0.5 0.5", "v 1 0.5 0.6");
    let arguments = [
        "verify",
        "curve",
        "plain",
        "--json=out.json",
        "--junit",
        "out.xml",
    ];
    let run = suite.volref(&arguments);
    run.prints(3, "2 cases: 0 passed, 1 failed, 1 missing");
    let json = suite.json("out.json");
    assert_eq!(json["summary"]["missing"], 1);
    assert_shown!(suite.text("out.xml"), @r#"
    <?xml version="1.0" encoding="UTF-8"?>
    <testsuites name="volref" tests="2" skipped="0" failures="1" errors="1">
        <testsuite name="volref/plots" tests="1" skipped="0" failures="0" errors="1">
            <testcase name="plots/curve" classname="plots" time="[seconds]">
                <error message="there is no golden yet; look at the image (volref render fixtures/scenes/plots/curve.toml -o now.exr), then accept it (volref accept plots/curve --reason ...)" type="missing"/>
            </testcase>
        </testsuite>
        <testsuite name="volref/smoke" tests="1" skipped="0" failures="1" errors="0">
            <testcase name="smoke/plain" classname="smoke" time="[seconds]">
                <failure message="12 of 120 pixels differ in colour and 12 in opacity; the largest difference of a channel is 1.953e-1 (beyond the tolerance for other renderers); input changed since the golden was made: ../../volumes/cloud.obj" type="fail"/>
            </testcase>
        </testsuite>
    </testsuites>
    "#);
}

/// One voxel of the smoke: one point moved by less than a voxel.
#[test]
fn a_changed_voxel_names_the_figures_it_moved() {
    let suite = Folder::with_goldens();
    assert!(CLOUD.contains("v 0 0.5 0.5\n"));
    suite.edit(
        "fixtures/volumes/cloud.obj",
        "v 0 0.5 0.5\n",
        "v 0 0.5 0.5 1.01\n",
    );
    assert_shown!(suite.volref("verify").shown(), @"
    exit code 1
    --- stdout
    plots  1 of 1 pass [seconds]

    fail          smoke/nearest [seconds]
                  4 of 120 pixels differ in colour and 4 in opacity; the largest difference of a channel is 5.822e-3 (beyond the tolerance for other renderers); input changed since the golden was made: ../../volumes/cloud.obj
    fail          smoke/plain [seconds]
                  12 of 120 pixels differ in colour and 12 in opacity; the largest difference of a channel is 1.902e-3 (beyond the tolerance for other renderers); input changed since the golden was made: ../../volumes/cloud.obj
    fail          smoke/shadow [seconds]
                  14 of 120 pixels differ in colour and 12 in opacity; the largest difference of a channel is 1.311e-3 (beyond the tolerance for other renderers); input changed since the golden was made: ../../volumes/cloud.obj

    4 cases: 1 passed, 3 failed

    To see what changed:
      volref verify smoke/nearest --report report
    ");
}

#[test]
fn the_hint_of_a_failure_can_be_followed() {
    let suite = Folder::with_goldens();
    suite.edit("fixtures/volumes/cloud.obj", "0.5 0.5 2", "0.5 0.5 3");
    let run = suite.volref("verify smoke/plain");
    let mut commands = run
        .stdout
        .lines()
        .filter_map(|line| line.strip_prefix("  volref "));
    assert_eq!(suite.volref(commands.next().unwrap()).code, 1);
    assert!(suite.path("report/index.html").is_file());
}

#[test]
fn a_scene_that_no_longer_loads_is_bad_input() {
    let suite = Folder::with_goldens();
    suite.edit(
        "fixtures/scenes/smoke/plain.toml",
        "width = 12",
        "width = 0",
    );
    let run = suite.volref("verify");
    assert_eq!(run.code, 2, "{}", run.stdout);
    assert_shown!(run.shown(), @r"
    exit code 2
    --- stdout
    plots  1 of 1 pass [seconds]
    smoke  2 of 3 pass [seconds]

    error         smoke/plain [seconds]
                  fixtures/scenes/smoke/plain.toml:2:9: `width` must lie in [1, 16384], got 0

    4 cases: 3 passed, 1 error
    ");
}
