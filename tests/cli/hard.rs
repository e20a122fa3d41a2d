//! Hard cases: images with a known answer, rays that are ended early.

use crate::folder::{Folder, MANIFEST, assert_shown};

/// A fog that lets e^(−1), e^(−2) and e^(−3) through, in every pixel: its box has the eye inside and
/// the far face as far away in all directions as a narrow view can tell.
const FOG: &str = "\
film = { width = 8, height = 8 }
camera = { eye = [0, 0, 0], target = [0, 0, 1], up = [0, 1, 0], vertical_fov = 0.001 }

[radiative]
scattering = \"none\"
environment = 1

[[radiative.medium]]
box = { min = [-1, -1, -1], max = [1, 1, 1] }
sigma_a = [1, 2, 3]
sigma_s = 0
";

/// The manifest of [`FOG`].
fn manifest(further: &str) -> String {
    format!("{MANIFEST}{further}\n")
}

const ANSWER: &str = "answer = [0.3678794411714423, 0.1353352832366127, 0.04978706836786394]";

fn suite(manifest: &str) -> Folder {
    let folder = Folder::new();
    folder.write("fixtures/scenes/hard/g4-inside.toml", FOG);
    folder.write("fixtures/cases/hard/g4-inside.toml", manifest);
    folder
}

#[test]
fn images_with_an_answer_state_how_close_they_are() {
    let suite = suite(&manifest(&format!("{ANSWER}\nanswer_within = 1e-6")));
    assert_eq!(suite.volref("accept hard --reason first").code, 0);
    let run = suite.volref("verify --verbose");
    assert_shown!(run.shown(), @r"
    exit code 0
    --- stdout
    pass          hard/g4-inside [seconds]

    1 case: 1 passed
    ");
    let json = suite.volref("verify hard --json").json();
    let cases = json["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 1);
    let share = cases[0]["metrics"]["error_of_tolerance"].as_f64().unwrap();
    assert!((0.0..=1.0).contains(&share), "{json}");
    assert!(suite.volref("list --json").json().get("rows").is_none());
}

#[test]
fn a_golden_that_is_not_the_answer_is_not_accepted_and_does_not_pass() {
    let wrong = ANSWER.replace("0.1353352832366127", "0.13534");
    let suite = suite(&manifest(&format!("{wrong}\nanswer_within = 1e-6")));
    let accepted = suite.volref("accept hard --reason first");
    let wrong_green = "known answer: green of pixel (0, 0)";
    accepted.expect(2, &["hard/g4-inside", wrong_green, "Nothing was accepted"]);
    // Accepted while nothing was known, and known since.
    suite.write("fixtures/cases/hard/g4-inside.toml", manifest(""));
    assert_eq!(suite.volref("accept hard --reason first").code, 0);
    suite.write(
        "fixtures/cases/hard/g4-inside.toml",
        manifest(&format!("{wrong}\nanswer_within = 1e-6")),
    );
    // The golden was judged without an answer: it has to be accepted anew, which the answer forbids.
    let run = suite.volref("verify g4-inside");
    assert_eq!(run.code, 3);
    assert!(
        run.stdout.contains("the answer of the case"),
        "{}",
        run.stdout
    );
    let accepted = suite.volref("accept hard --reason known");
    accepted.expect(2, &[wrong_green, "Nothing was accepted"]);
}

#[test]
fn answers_that_say_too_little_or_too_much() {
    let mut said = String::new();
    for further in [
        ANSWER,
        "answer_within = 1e-6",
        "answer = -1\nanswer_within = 1e-6",
        "answer = 1\nanswer_within = 1",
    ] {
        let run = suite(&manifest(further)).volref("verify hard");
        assert_eq!(run.code, 2, "{further}");
        said.push_str(&format!("{}\n", run.message()));
    }
    let stochastic = MANIFEST.replace("deterministic", "stochastic");
    let manifest = format!("{stochastic}converged_samples = 64\n{ANSWER}\nanswer_within = 1e-6\n");
    let run = suite(&manifest).volref("verify hard");
    assert_eq!(run.code, 2);
    said.push_str(&format!("{}\n", run.message()));
    insta::assert_snapshot!(said, @r#"
    fixtures/cases/hard/g4-inside.toml:5:10: a deterministic case with an `answer` needs `answer_within` help: `answer`: Radiance that every pixel has, where it is known beforehand. `volref verify` compares the image with it, beside the golden; of a stochastic case the golden itself, in the mean of the whole image, to four standard errors. `volref validate` compares images that state their noise with it, in place of the golden.
    fixtures/cases/hard/g4-inside.toml:5:17: `answer_within` without an `answer` help: `answer_within`: Deterministic cases with an `answer`, and required there: how far from it a pixel may be, relative to it.
    fixtures/cases/hard/g4-inside.toml:5:10: `answer` must be finite and at least 0 in every channel, got [-1, -1, -1] help: `answer`: Radiance that every pixel has, where it is known beforehand. `volref verify` compares the image with it, beside the golden; of a stochastic case the golden itself, in the mean of the whole image, to four standard errors. `volref validate` compares images that state their noise with it, in place of the golden.
    fixtures/cases/hard/g4-inside.toml:6:17: `answer_within` must lie in (0, 1), got 1 help: `answer_within`: Deterministic cases with an `answer`, and required there: how far from it a pixel may be, relative to it.
    fixtures/cases/hard/g4-inside.toml:7:17: volref tests the answer of a stochastic case to four standard errors: remove `answer_within` help: `answer_within`: Deterministic cases with an `answer`, and required there: how far from it a pixel may be, relative to it.
    "#);
}

#[test]
fn early_termination_is_an_approximation_with_a_bound() {
    let folder = Folder::with_scenes();
    let asked = "[classified]\nearly_termination = 0.01\n";
    folder.edit("scene.toml", "[classified]\n", asked);
    let plan = folder.volref("plan scene.toml");
    let mut lines = plan.stdout.lines();
    let kernel = lines.find(|line| line.starts_with("kernel")).unwrap();
    let said = plan
        .stdout
        .lines()
        .skip_while(|line| !line.starts_with("approximations"));
    let said: Vec<_> = said.take(2).collect();
    insta::assert_snapshot!(format!("{kernel}\n{}", said.join("\n")), @r#"
    kernel     ray caster, over empty space by leaps
    approximations requested
      without light behind a transmittance below 0.01: pixels are off by less than 1.000e-2  (classified.early_termination, line 9)
    "#);
    let json = folder.volref("plan scene.toml --json").json();
    let bias = json["panels"][0]["approximations"][0]["bias"]
        .as_f64()
        .unwrap();
    assert!(bias > 0.0 && bias <= 0.01, "{bias}");

    folder.edit(
        "scene.toml",
        asked,
        &format!("{asked}compositing = \"back-to-front\"\n"),
    );
    let run = folder.volref("plan scene.toml");
    run.expect(
        2,
        "scene.toml: … back to front, a ray cannot be ended early",
    );
}
