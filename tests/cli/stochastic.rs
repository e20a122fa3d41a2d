//! Stochastic cases, from the manifest to the verdict, with the real renderer.

use crate::folder::{Folder, MANIFEST, ROOM, assert_holds};
use volref::film::Film;

/// A suite of one stochastic case, with a manifest that promises little.
fn room() -> Folder {
    Folder::with_room("converged_samples = 128\nresolution = 0.9")
}

#[test]
fn accepted_and_verified() {
    let folder = room();
    let run = folder.volref("accept '*' --reason first");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_eq!(
        folder.files().len(),
        6,
        "nothing is left beside the goldens, but for what hides their lock"
    );
    let run = folder.volref("verify --json");
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
    assert_eq!(folder.volref("verify").code, 3);
}

/// Both renderings can be made again by hand.
#[test]
fn samples_and_seeds_on_the_command_line() {
    let folder = room();
    assert_eq!(folder.volref("accept '*' --reason first").code, 0);
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

    let compare = |gate: &str| {
        folder.volref(&[
            "compare",
            "golden/fog/room.exr",
            "now.exr",
            "--gate",
            gate,
            "--resolution",
            "99",
        ])
    };
    assert_eq!(
        compare("stochastic").code,
        0,
        "{}",
        compare("stochastic").stdout
    );
    assert_eq!(compare("exact").code, 1);
    // One sample says nothing of its noise; the other image's is enough.
    hash("1", "5");
    let run = compare("stochastic");
    assert_holds(&run.stdout, &["no difference beyond noise"]);
    let run = folder.volref("compare now.exr now.exr --gate stochastic");
    run.expect(2, "needs the noise of at least one image");
}

#[test]
fn class_and_scene_must_agree() {
    let folder = room();
    folder.write("fixtures/cases/fog/room.toml", MANIFEST);
    folder
        .volref("accept '*' --reason first")
        .expect(2, "fog/room … rendered as class = \"stochastic\"");
    let folder = Folder::with_suite();
    let sampling = "class = \"stochastic\"\nconverged_samples = 128";
    let manifest = MANIFEST.replace("class = \"deterministic\"", sampling);
    folder.write("fixtures/cases/plots/curve.toml", manifest);
    folder
        .volref("accept '*' --reason first")
        .expect(2, "plots/curve … rendered as class = \"deterministic\"");
}

#[test]
fn manifests_with_mistakes() {
    for (old, new, parts) in [
        (
            "class = \"stochastic\"",
            "class = \"deterministic\"",
            ["converged_samples", "has no effect in a deterministic case"],
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
        folder.volref("list").expect(2, &parts);
    }
}

/// A room of `side` pixels with a golden of so many samples, of which a bias of that share of the
/// mean is promised to be seen.
fn promising(side: u32, converged: u32, promise: f64) -> Folder {
    let folder = room();
    let scene = ROOM.replace("= 256", &format!("= {side}"));
    folder.write("fixtures/scenes/fog/room.toml", scene);
    let sampling = format!("converged_samples = {converged}\nmean_resolution = {promise}");
    folder.edit(
        "fixtures/cases/fog/room.toml",
        "converged_samples = 128",
        &sampling,
    );
    folder.accept_all();
    folder
}

fn render(folder: &Folder, samples: u64, seed: u64) -> Film {
    let [samples, seed] = [samples, seed].map(|number| number.to_string());
    let scene = "fixtures/scenes/fog/room.toml";
    let run = folder.volref(&[
        "render", scene, "-o", "now.exr", "--spp", &samples, "--seed", &seed,
    ]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    folder.film("now.exr")
}

/// A renderer that was asked for a number of samples has that many, though its image does not say.
#[cfg(unix)]
#[test]
fn samples_that_were_asked_for_are_known() {
    let folder = promising(16, 512, 0.2);
    let advice = |command: &str| {
        let run = folder.volref(&[
            "validate", "--run", command, "--spp", "8", "--format", "pfm", "--json",
        ]);
        assert_eq!(run.code, 5, "{}{}", run.stdout, run.stderr);
        run.json()["cases"][0]["reason"]
            .as_str()
            .unwrap()
            .to_owned()
    };
    // A renderer that has made its image long ago.
    folder.write("made.pfm", render(&folder, 8, 3).to_pfm());
    let path = |name: &str| folder.path(name).display().to_string();
    let made = path("made.pfm");
    let said = advice(&format!("cp '{made}' {{output}}"));
    assert_holds(&said, "times as many samples per pixel would decide");
    folder.write("with_spp.sh", format!("cp '{made}' \"$2\"\n"));
    let said = advice(&format!("sh '{}' {{spp}} {{output}}", path("with_spp.sh")));
    assert_holds(&said, " in all");
    for number in 0..3 {
        let film = render(&folder, 8, 4 + number);
        folder.write(&format!("made.{number}.pfm"), film.to_pfm());
    }
    let script = "for i in 0 1 2; do cp \"$3/made.$i.pfm\" \"${2%.pfm}.$i.pfm\"; done\n";
    folder.write("with_spp.sh", script);
    let here = path(".");
    let said = advice(&format!(
        "sh '{}' {{spp}} {{output}} '{here}'",
        path("with_spp.sh")
    ));
    assert_holds(&said, " in all");
}

/// What `validate` calls inconclusive is no pass of `compare`, which takes the gate for noise by
/// itself where an image states its noise, and says so.
#[test]
fn compare_promises_what_the_suite_does() {
    let folder = promising(16, 512, 0.02);
    render(&folder, 4, 3);
    let compare = |more: &[&str]| {
        let arguments = ["compare", "golden/fog/room.exr", "now.exr"];
        folder.volref(&[&arguments[..], more].concat())
    };
    let run = compare(&[]);
    assert_eq!(run.code, 5, "{}", run.stdout);
    let first = run.stdout.lines().next().unwrap();
    assert_eq!(
        first,
        "inconclusive  (stochastic gate, since an image includes its variance)"
    );
    for part in [
        "detectable bias of the mean",
        "required 2.00 %",
        "would decide",
    ] {
        assert!(run.stdout.contains(part), "{}", run.stdout);
    }
    assert_eq!(
        compare(&["--json"]).json()["cases"][0]["verdict"],
        "inconclusive"
    );
    let run = compare(&["--resolution", "99"]);
    assert_holds(&run.stdout, &["pass  (stochastic gate"]);
    assert_eq!(run.code, 0);
    for wrong in ["0", "100", "-3", "nan", "much"] {
        let run = compare(&["--resolution", wrong]);
        assert_eq!(run.code, 2, "{wrong}: {}", run.stdout);
    }
    // A silent image is judged by the noise of the other, on either side.
    folder.write("silent.pfm", render(&folder, 4, 4).to_pfm());
    for (pair, why) in [
        (
            ["golden/fog/room.exr", "silent.pfm"],
            "since an image includes its variance",
        ),
        (
            ["silent.pfm", "golden/fog/room.exr"],
            "since an image includes its variance",
        ),
    ] {
        let run = folder.volref(&["compare", pair[0], pair[1]]);
        assert!(run.stdout.contains(why), "{}", run.stdout);
        assert_eq!(run.code, 5, "{}", run.stdout);
    }
    // Codes for a display have no noise to speak of, and a gate that is named is taken.
    let run = folder.volref("compare golden/fog/room.exr golden/fog/room.png");
    assert!(run.stdout.contains("(perceptual gate)"), "{}", run.stdout);
    let run = compare(&["--gate", "deterministic"]);
    assert_holds(&run.stdout, &["(deterministic gate)"]);
    assert_eq!(run.code, 1);
}
