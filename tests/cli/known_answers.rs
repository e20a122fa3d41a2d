//! Cases whose golden is a known answer: accepted, verified, refused.

use crate::folder::{Folder, MANIFEST};

/// A ball of absorbing fog with the eye in its middle: e^(−1), e^(−2) and e^(−3) in every pixel.
const BALL: &str = "\
film = { width = 8, height = 8 }
camera = { eye = [0, 0, 0], target = [0, 0, 1], up = [0, 1, 0], vertical_fov = 40 }

[radiative]
environment = 1

[[radiative.medium]]
sphere = { centre = [0, 0, 0], radius = 1 }
sigma_a = [1, 2, 3]
";

const TRUTH: &str = "truth = \"emission-absorption\"\n";

fn suite(further: &str) -> Folder {
    let folder = Folder::new();
    folder.write("fixtures/scenes/known-answers/ball.toml", BALL);
    let manifest = format!("{MANIFEST}{further}");
    folder.write("fixtures/cases/known-answers/ball.toml", manifest);
    folder
}

#[test]
fn the_answer_is_the_golden() {
    let suite = suite(TRUTH);
    let accepted = suite.volref("accept ball --reason first");
    assert_eq!(accepted.code, 0, "{}", accepted.stderr);
    let verified = suite.volref("verify ball --json");
    assert_eq!(verified.code, 0, "{}", verified.stdout);
    let case = &verified.json()["cases"][0];
    let reason = case["reason"].as_str().unwrap();
    for part in [
        "the same bits as the quick rendering",
        "and against the known answer \"emission-absorption\": ",
    ] {
        assert!(reason.contains(part), "{reason}");
    }
    assert_eq!(case["metrics"]["same_bits"], 1.0);
    // Accepted again, nothing changes; with another formula, the golden is stale.
    let again = suite.volref("accept ball --reason again");
    assert!(again.stdout.contains("unchanged"), "{}", again.stdout);
    let manifest = format!("{MANIFEST}truth = \"furnace\"\n");
    suite.write("fixtures/cases/known-answers/ball.toml", manifest);
    let stale = suite.volref("verify ball");
    stale.prints(3, "the truth of the case has changed");
}

#[test]
fn manifests_that_say_too_much_or_the_wrong_thing_are_refused() {
    let stochastic = "truth = \"furnace\"\nconverged_samples = 64\n";
    let mut said = String::new();
    for (further, class) in [
        ("truth = \"furnance\"\n", "deterministic"),
        (
            "truth = \"furnace\"\nanswer = 1\nanswer_within = 1e-6\n",
            "deterministic",
        ),
        (stochastic, "stochastic"),
    ] {
        let suite = suite(further);
        let manifest = format!("{}{further}", MANIFEST.replace("deterministic", class));
        suite.write("fixtures/cases/known-answers/ball.toml", manifest);
        let run = suite.volref("verify ball");
        assert_eq!(run.code, 2, "{further}");
        said.push_str(&format!("{}\n", run.message()));
    }
    // The scene is none for the formula.
    let run = suite("truth = \"furnace\"\n").volref("accept ball --reason first");
    assert_eq!(run.code, 2);
    said.push_str(&run.message());
    insta::assert_snapshot!(said, @r#"
    fixtures/cases/known-answers/ball.toml:5:9: `truth` must be one of "furnace", "emission-absorption", "absorbing-grid", "airlight", "lit-body", "half-space", "slab", but is "furnance" help: did you mean "furnace"?
    fixtures/cases/known-answers/ball.toml:6:10: the `truth` is the answer: leave one of them out help: `answer`: Radiance that every pixel has, where it is known beforehand. `volref verify` compares the image with it, beside the golden; of a stochastic case the golden itself, in the mean of the whole image, to four standard errors. `volref validate` compares images that state their noise with it, in place of the golden.
    fixtures/cases/known-answers/ball.toml:6:21: `converged_samples` has no effect with a `truth`: that takes no samples help: `converged_samples`: Stochastic cases without a `truth`, and required there: samples per pixel of the golden image.
    known-answers/ball: the truth "furnace" does not fit the scene: a medium does not emit its absorption times the environment's radiance help: nothing was accepted, not even the other cases
    "#);
}
