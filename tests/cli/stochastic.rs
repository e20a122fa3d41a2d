//! Stochastic cases, from the manifest to the verdict, with the real renderer.

use crate::folder::{Folder, MANIFEST};

const ROOM: &str = include_str!("../../fixtures/scenes/smoke/cornell.toml");

/// A suite of one stochastic case, with a manifest that promises little.
fn room() -> Folder {
    let folder = Folder::new();
    folder.write(
        "fixtures/scenes/fog/room.toml",
        ROOM.replace("= 256", "= 16"),
    );
    let sampling = "class = \"stochastic\"\nconverged_samples = 128\nresolution = 0.9";
    let manifest = MANIFEST.replace("class = \"deterministic\"", sampling);
    folder.write("fixtures/cases/fog/room.toml", manifest);
    folder
}

#[test]
fn accepted_and_verified() {
    let folder = room();
    let run = folder.volref(&["accept", "*", "--reason", "first"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_eq!(
        folder.files().len(),
        5,
        "nothing is left beside the goldens"
    );
    let run = folder.volref(&["verify", "--json"]);
    assert_eq!(run.code, 0, "{}", run.stdout);
    let case = &run.json()["cases"][0];
    assert_eq!(case["class"], "stochastic");
    assert_eq!(case["gate"], "stochastic");
    assert_eq!(case["metrics"]["same_bits"], 1.0);

    folder.edit(
        "fixtures/scenes/fog/room.toml",
        "sigma_t = 0.01\nalbedo = 0\n",
        "sigma_t = 0.02\nalbedo = 0\n",
    );
    assert_eq!(folder.volref(&["verify"]).code, 3);
}

/// Both renderings can be made again by hand.
#[test]
fn samples_and_seeds_on_the_command_line() {
    let folder = room();
    assert_eq!(folder.volref(&["accept", "*", "--reason", "first"]).code, 0);
    let golden: toml::Table = folder.text("golden/fog/room.toml").parse().unwrap();
    let hash = |spp: &str, seed: &str| {
        let scene = "fixtures/scenes/fog/room.toml";
        let run = folder.volref(&[
            "render", scene, "-o", "now.exr", "--spp", spp, "--seed", seed, "--json",
        ]);
        assert_eq!(run.code, 0, "{}", run.stderr);
        run.json()["hash"].as_str().unwrap().to_owned()
    };
    assert_eq!(hash("4", "0"), golden["quick"]["pixels"].as_str().unwrap());
    let converged = hash("128", "9223372036854775808");
    assert_eq!(converged, golden["pixels"].as_str().unwrap());
    assert_ne!(hash("4", "1"), hash("4", "0"));

    let compare =
        |gate: &str| folder.volref(&["compare", "golden/fog/room.exr", "now.exr", "--gate", gate]);
    assert_eq!(
        compare("stochastic").code,
        0,
        "{}",
        compare("stochastic").stdout
    );
    assert_eq!(compare("exact").code, 1);
    // One sample says nothing of its noise; the other image's is enough.
    hash("1", "5");
    assert_eq!(
        compare("stochastic").code,
        0,
        "{}",
        compare("stochastic").stdout
    );
    let run = folder.volref(&["compare", "now.exr", "now.exr", "--gate", "stochastic"]);
    run.expect(2, &["needs the noise of at least one image"]);
}

#[test]
fn class_and_scene_must_agree() {
    let folder = room();
    folder.write("fixtures/cases/fog/room.toml", MANIFEST);
    folder
        .volref(&["accept", "*", "--reason", "first"])
        .expect(2, &["fog/room", "with random numbers", "stochastic"]);
    let folder = Folder::with_suite();
    let sampling = "class = \"stochastic\"\nconverged_samples = 128";
    let manifest = MANIFEST.replace("class = \"deterministic\"", sampling);
    folder.write("fixtures/cases/plots/curve.toml", manifest);
    folder.volref(&["accept", "*", "--reason", "first"]).expect(
        2,
        &["plots/curve", "without random numbers", "deterministic"],
    );
}

#[test]
fn manifests_with_mistakes() {
    for (old, new, parts) in [
        (
            "class = \"stochastic\"",
            "class = \"deterministic\"",
            ["converged_samples", "means nothing to a deterministic case"],
        ),
        (
            "converged_samples = 128\n",
            "",
            ["stochastic case", "needs `converged_samples`"],
        ),
        (
            "= 128",
            "= 63",
            ["converged_samples", "must lie in [64, 16777216]"],
        ),
        ("= 0.9", "= 0", ["resolution", "(0, 1)"]),
    ] {
        let folder = room();
        folder.edit("fixtures/cases/fog/room.toml", old, new);
        folder.volref(&["list"]).expect(2, &parts);
    }
}
