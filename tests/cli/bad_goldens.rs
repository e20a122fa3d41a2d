//! Goldens that cannot be trusted: a failure with a reason, never a new golden.

use crate::folder::{Folder, assert_shown};
use volref::film::Film;

const EXR: &str = "golden/smoke/plain.exr";
const PNG: &str = "golden/smoke/plain.png";
const TOML: &str = "golden/smoke/plain.toml";

/// Verifies `smoke/plain` after `change`; returns what is said, seconds apart.
fn after(change: impl Fn(&Folder)) -> String {
    let suite = Folder::with_suite();
    let run = suite.volref("accept smoke/plain --reason first");
    assert_eq!(run.code, 0, "{}", run.stderr);
    change(&suite);
    let before = suite.files();
    let run = suite.volref("verify smoke/plain");
    assert_eq!(run.code, 3, "{}{}", run.stdout, run.stderr);
    assert_eq!(suite.files(), before, "verify writes nothing");
    let summary = run.stdout.rfind("\n\n").unwrap();
    run.stdout[..summary].to_owned() + "\n"
}

fn said(changes: &[&dyn Fn(&Folder)]) -> String {
    changes.iter().map(after).collect()
}

/// A line of the provenance replaced.
fn set(suite: &Folder, key: &str, value: &str) {
    let text = suite.text(TOML);
    let start = format!("{key} = ");
    let line = text.lines().find(|line| line.starts_with(&start)).unwrap();
    suite.edit(TOML, &format!("{line}\n"), &format!("{key} = {value}\n"));
}

#[test]
fn missing_and_incomplete() {
    let shown = said(&[
        &|suite| {
            [EXR, PNG, TOML]
                .map(|name| suite.remove(name))
                .into_iter()
                .collect()
        },
        &|suite| std::fs::remove_dir_all(suite.path("golden")).unwrap(),
        &|suite| suite.remove(EXR),
        &|suite| suite.remove(PNG),
        &|suite| suite.remove(TOML),
    ]);
    assert_shown!(shown, @r"
    missing       smoke/plain [seconds]
                  there is no golden yet; look at the image (volref render fixtures/scenes/smoke/plain.toml -o now.exr), then accept it (volref accept smoke/plain --reason ...)
    missing       smoke/plain [seconds]
                  there is no golden yet; look at the image (volref render fixtures/scenes/smoke/plain.toml -o now.exr), then accept it (volref accept smoke/plain --reason ...)
    error         smoke/plain [seconds]
                  the golden is incomplete: golden/smoke/plain.exr is missing; restore it from version control
    error         smoke/plain [seconds]
                  the golden is incomplete: golden/smoke/plain.png is missing; restore it from version control
    error         smoke/plain [seconds]
                  the golden is incomplete: golden/smoke/plain.toml is missing; restore it from version control
    ");
}

#[test]
fn images_that_were_changed() {
    let shown = said(&[
        // One pixel, by its last bit.
        &|suite| {
            let film = suite.film(EXR);
            let mut pixels: Vec<_> = film.radiance().to_vec();
            pixels[65][1] = pixels[65][1].next_up();
            let opacity = film.opacity().unwrap();
            let pixels = pixels
                .iter()
                .zip(opacity)
                .map(|(&[r, g, b], &a)| [r, g, b, a]);
            let film = Film::with_opacity(12, 10, pixels.collect());
            suite.write_film(EXR, &film);
        },
        // Opacity dropped.
        &|suite| {
            let film = Film::new(12, 10, suite.film(EXR).radiance().to_vec());
            suite.write_film(EXR, &film);
        },
        &|suite| {
            let mut png = suite.read(PNG);
            *png.last_mut().unwrap() ^= 1;
            suite.write(PNG, png);
        },
        // Another size, with the old hash.
        &|suite| suite.write(EXR, Film::new(6, 5, vec![[0.5; 3]; 30]).to_exr().unwrap()),
        // Another size, with hashes to match.
        &|suite| {
            let film = Film::new(6, 5, vec![[0.5; 3]; 30]);
            suite.write_film(EXR, &film);
            set(suite, "pixels", &format!("{:?}", film.pixel_hash()));
            set(suite, "width", "6");
            set(suite, "height", "5");
        },
    ]);
    assert_shown!(shown, @"
    error         smoke/plain [seconds]
                  golden/smoke/plain.exr has changed since it was accepted: its hash is [hash], the golden records [hash]; restore it from version control
    error         smoke/plain [seconds]
                  golden/smoke/plain.exr has changed since it was accepted: its hash is [hash], the golden records [hash]; restore it from version control
    error         smoke/plain [seconds]
                  golden/smoke/plain.png has changed since it was accepted: its hash is [hash], the golden records [hash]; restore it from version control
    error         smoke/plain [seconds]
                  golden/smoke/plain.exr: the image has 6 × 5 pixels, but golden/smoke/plain.toml says 12 × 10; restore it from version control
    error         smoke/plain [seconds]
                  golden/smoke/plain.toml has changed since it was accepted: its hash is [hash], the golden records [hash]; restore it from version control
    ");
}

#[test]
fn provenance_that_was_changed() {
    let zeros = "\"0000000000000000000000000000000000000000000000000000000000000000\"";
    let shown = said(&[
        &|suite| suite.write(TOML, "garbage"),
        &|suite| suite.write(TOML, [0xff, 0xfe, 0]),
        &|suite| suite.write(TOML, ""),
        &|suite| set(suite, "schema", "\"volref/golden/2\""),
        &|suite| set(suite, "width", "6"),
        &|suite| set(suite, "samples", "1\nsigned_off_by = \"nobody\""),
        &|suite| set(suite, "case", "\"smoke/nearest\""),
        &|suite| set(suite, "pixels", zeros),
        &|suite| set(suite, "preview", zeros),
        &|suite| set(suite, "scene", zeros),
        &|suite| set(suite, "plan", zeros),
    ]);
    assert_shown!(shown, @r#"
    error         smoke/plain [seconds]
                  golden/smoke/plain.toml: key with no value, expected `=`; restore it from version control
    error         smoke/plain [seconds]
                  golden/smoke/plain.toml: not UTF-8 text; restore it from version control
    error         smoke/plain [seconds]
                  golden/smoke/plain.toml: missing field `schema`; restore it from version control
    error         smoke/plain [seconds]
                  golden/smoke/plain.toml: its schema is "volref/golden/2", not known here; restore it from version control
    error         smoke/plain [seconds]
                  golden/smoke/plain.exr: the image has 12 × 10 pixels, but golden/smoke/plain.toml says 6 × 10; restore it from version control
    error         smoke/plain [seconds]
                  golden/smoke/plain.toml: unknown field `signed_off_by`, expected one of `schema`, `case`, `reason`, `record_reason`, `replaces`, `changed_pixels`, `pixels`, `preview`, `sensitivities`, `exposure`, `scene`, `plan`, `omitted`, `width`, `height`, `samples`, `seed`, `error_estimate`, `volref`, `libm`, `target`, `seal`, `inputs`, `judged_by`, `truth`, `quick`; restore it from version control
    error         smoke/plain [seconds]
                  golden/smoke/plain.toml has changed since it was accepted: its hash is [hash], the golden records [hash]; restore it from version control
    error         smoke/plain [seconds]
                  golden/smoke/plain.toml has changed since it was accepted: its hash is [hash], the golden records [hash]; restore it from version control
    error         smoke/plain [seconds]
                  golden/smoke/plain.toml has changed since it was accepted: its hash is [hash], the golden records [hash]; restore it from version control
    error         smoke/plain [seconds]
                  golden/smoke/plain.toml has changed since it was accepted: its hash is [hash], the golden records [hash]; restore it from version control
    error         smoke/plain [seconds]
                  golden/smoke/plain.toml has changed since it was accepted: its hash is [hash], the golden records [hash]; restore it from version control
    "#);
}

#[test]
fn stale() {
    let scene = "fixtures/scenes/smoke/plain.toml";
    let shown = said(&[
        &|suite| {
            suite.edit(
                scene,
                "[classified]",
                "[classified]\nstep = \"0.25 voxels\"",
            )
        },
        &|suite| suite.edit(scene, "[classified]", "[classified]\n[classified.phong]"),
        &|suite| suite.edit(scene, "width = 12", "width = 13"),
    ]);
    assert_shown!(shown, @r"
    error         smoke/plain [seconds]
                  stale: the scene has changed since the golden was accepted; look at the image (volref render fixtures/scenes/smoke/plain.toml -o now.exr), then accept it (volref accept smoke/plain --reason ...)
    error         smoke/plain [seconds]
                  stale: the scene has changed since the golden was accepted; look at the image (volref render fixtures/scenes/smoke/plain.toml -o now.exr), then accept it (volref accept smoke/plain --reason ...)
    error         smoke/plain [seconds]
                  stale: the scene has changed since the golden was accepted; look at the image (volref render fixtures/scenes/smoke/plain.toml -o now.exr), then accept it (volref accept smoke/plain --reason ...)
    ");
}

/// The scene says the same as before, and its file other values: so constant that less is simulated.
/// The golden is not one of that, whatever its pixels.
#[test]
fn a_changed_plan() {
    let suite = Folder::with_suite();
    let volume = |last: f32| {
        let mut values = [0.5; 27];
        values[26] = last;
        let grid = crate::bad_files::grid([3, 3, 3], [1.0; 3], &values);
        suite.write("fixtures/volumes/grid.bin", grid);
    };
    let scene = "[film]\nwidth = 6\nheight = 6\n[classified]\n\
                 [classified.volume]\nfile = \"../../volumes/grid.bin\"\n";
    suite.write("fixtures/scenes/smoke/grid.toml", scene);
    suite.write("fixtures/cases/smoke/grid.toml", crate::folder::MANIFEST);
    volume(0.6);
    suite.accept_all();
    volume(0.5);
    let run = suite.volref("verify smoke/grid");
    run.prints(3, "stale: the plan has changed");
}

#[test]
fn goldens_of_another_case() {
    let suite = Folder::with_goldens();
    for extension in ["exr", "png", "toml"] {
        let other = suite.read(&format!("golden/smoke/nearest.{extension}"));
        suite.write(&format!("golden/smoke/plain.{extension}"), other);
    }
    let run = suite.volref("verify smoke/plain");
    run.prints(3, "of the case \"smoke/nearest\"");
}

#[test]
fn a_folder_in_the_place_of_a_golden() {
    let suite = Folder::with_goldens();
    suite.remove(EXR);
    suite.write("golden/smoke/plain.exr/kept", "");
    let run = suite.volref("verify smoke/plain");
    run.prints(3, "cannot read golden/smoke/plain.exr");
    let before = suite.files();
    let run = suite.volref("accept smoke/plain --reason r");
    run.expect(2, "golden/smoke/plain.exr");
    assert_eq!(suite.files(), before);
}

#[test]
fn one_bad_golden_does_not_hide_the_other_cases() {
    let suite = Folder::with_goldens();
    suite.write(EXR, "");
    suite.edit("fixtures/volumes/cloud.obj", "0.5 0.5 2", "0.5 0.5 3");
    let json = suite.volref("verify --json").json();
    let summary = serde_json::json!({
        "pass": 1, "fail": 2, "convention": 0, "inconclusive": 0, "missing": 0, "error": 1
    });
    assert_eq!(json["summary"], summary);
}

#[test]
fn a_golden_without_a_case() {
    let suite = Folder::with_goldens();
    suite.remove("fixtures/cases/smoke/plain.toml");
    let run = suite.volref("verify");
    run.prints(3, "this golden belongs to no case");
    // Asked for by name, the other cases are nobody else's business.
    assert_eq!(suite.volref("verify plots").code, 0);
}

#[test]
fn another_exposure_makes_the_preview_stale_and_can_be_accepted() {
    let suite = Folder::with_goldens();
    let manifest = "fixtures/cases/smoke/plain.toml";
    let text = suite.text(manifest).replace("exposure", "# exposure");
    suite.write(manifest, format!("exposure = 3.5\n{text}"));
    let run = suite.volref("verify smoke/plain");
    run.prints(3, "stale: the exposure of the case");
    let run = suite.volref("accept smoke/plain --reason brighter");
    assert!(
        run.stdout.contains("recorded"),
        "{}{}",
        run.stdout,
        run.stderr
    );
    assert_eq!(suite.volref("verify").code, 0);
}

const SENSITIVITIES: &str = "golden/sensitivities/fog/room.exr";

/// Exit code of `verify` and `validate`, which have to agree, and what both say of the case.
fn checked(suite: &Folder) -> (i32, String) {
    let before = suite.files();
    let verified = suite.volref("verify fog/room --json");
    let validated = ["validate", "fog/room", "--outputs", "images", "--json"];
    let validated = suite.volref(&validated);
    assert_eq!(suite.files(), before, "nothing is written");
    let [verified_says, validated_says] = [&verified, &validated].map(|run| {
        let reason = &run.json()["cases"][0]["reason"];
        reason.as_str().unwrap().to_owned()
    });
    if verified.code == 0 {
        assert_eq!(validated.code, 0, "{validated_says}");
        return (0, String::new());
    }
    assert_eq!(
        verified.code, validated.code,
        "{verified_says}\n{validated_says}"
    );
    assert_eq!(verified_says, validated_says);
    (verified.code, verified_says)
}

/// A file of sensitivities is sealed as the image is.
#[test]
fn sensitivities_are_part_of_the_golden() {
    let suite =
        Folder::with_room("converged_samples = 256\nresolution = 0.9\nmean_resolution = 0.9");
    suite.accept_all();
    let scene = "fixtures/scenes/fog/room.toml";
    suite.write(
        "other.toml",
        suite.text(scene).replace("albedo = 0\n", "albedo = 0.1\n"),
    );
    std::fs::create_dir_all(suite.path("images/fog")).unwrap();
    let image = ["-o", "images/fog/room.exr", "--spp", "64", "--seed", "7"];
    suite
        .volref(&[&["render", scene], &image[..]].concat())
        .expect(0, "");
    assert_eq!(checked(&suite).0, 0);

    std::fs::create_dir_all(suite.path("golden/sensitivities/fog")).unwrap();
    for (scene, file) in [(scene, SENSITIVITIES), ("other.toml", "other.exr")] {
        let made = [
            "sensitivity",
            scene,
            "--all",
            "--spp",
            "1",
            "--pairs",
            "2",
            "-o",
            file,
        ];
        suite.volref(&made).expect(0, "");
    }
    let remedies = [
        format!("{SENSITIVITIES} "),
        "restore the golden from version control".to_owned(),
        format!("volref sensitivity {scene} --all -o FILE"),
        "volref accept fog/room --keep-images".to_owned(),
    ];
    let fails = |suite: &Folder, fault: &str| {
        let (code, said) = checked(suite);
        assert_eq!(code, 3, "{said}");
        for part in remedies.iter().map(String::as_str).chain([fault]) {
            assert!(said.contains(part), "{part:?} is not in: {said}");
        }
    };
    let accept = ["accept", "fog/room", "--keep-images", "--reason", "anew"];
    fails(&suite, "is not recorded by the golden");
    let run = suite.volref(&accept);
    assert!(
        run.stdout.starts_with("recorded "),
        "{}{}",
        run.stdout,
        run.stderr
    );
    assert_eq!(checked(&suite).0, 0);
    let run = suite.volref(&accept);
    assert!(run.stdout.starts_with("unchanged "), "{}", run.stdout);

    let whole = suite.read(SENSITIVITIES);
    let mut damaged = whole.clone();
    damaged[whole.len() / 2] ^= 1;
    for (bytes, fault, is_accepted) in [
        (Some(damaged), "has changed since it was accepted", None),
        (
            Some(whole[..100].to_owned()),
            "has changed since",
            Some("cannot be read"),
        ),
        (
            Some(suite.read("other.exr")),
            "has changed since",
            Some("made from another scene"),
        ),
        (None, "is missing", Some("is missing")),
    ] {
        match bytes {
            Some(bytes) => suite.write(SENSITIVITIES, bytes),
            None => suite.remove(SENSITIVITIES),
        }
        fails(&suite, fault);
        let before = suite.files();
        if let Some(words) = is_accepted {
            suite
                .volref(&accept)
                .expect(2, &["fog/room", SENSITIVITIES, words]);
            assert_eq!(suite.files(), before);
        }
        suite.write(SENSITIVITIES, &whole);
    }
    assert_eq!(checked(&suite).0, 0);
    // Recorded by hand, the seal of the record tells.
    let record = "golden/fog/room.toml";
    let text = suite.text(record);
    let kept = text
        .lines()
        .filter(|line| !line.starts_with("sensitivities"));
    let kept: Vec<&str> = kept.collect();
    assert_eq!(kept.len() + 1, text.lines().count());
    suite.write(record, kept.join("\n"));
    suite.remove(SENSITIVITIES);
    let (code, said) = checked(&suite);
    assert_eq!(code, 3);
    assert!(said.contains("golden/fog/room.toml has changed"), "{said}");

    // Of a scene that has changed, neither the image nor the sensitivities are left.
    suite.write(record, text);
    suite.write(scene, suite.read("other.toml"));
    suite.volref("accept fog/room --reason new").expect(0, "");
    suite.volref("verify fog/room").expect(0, "");
    assert!(!suite.text(record).contains("sensitivities"));
}

/// Whatever key of a manifest changes how images are judged, the golden knows its value.
#[test]
fn an_edit_of_the_manifest_that_changes_a_judgement_makes_the_golden_stale() {
    let suite = Folder::with_goldens();
    let manifest = "fixtures/cases/smoke/plain.toml";
    let before = suite.text(manifest);
    suite.write("out/smoke/plain.exr", suite.read("golden/smoke/plain.exr"));
    let validate = "validate smoke/plain --outputs out --explain 0";
    suite.volref(validate).expect(0, "");
    for (key, edited) in [
        ("opacity", format!("{before}opacity = true\n")),
        ("depth", format!("{before}depth = \"mean\"\n")),
        (
            "answer",
            format!("{before}answer = [0, 0, 0]\nanswer_within = 0.9\n"),
        ),
        ("exposure", format!("{before}exposure = 1.0\n")),
    ] {
        suite.write(manifest, edited);
        let said =
            format!("stale: the {key} of the case has changed since the golden was accepted");
        for command in [validate, "verify smoke/plain"] {
            let run = suite.volref(command);
            assert_eq!(run.code, 3, "{key}: {}{}", run.stdout, run.stderr);
            assert!(run.stdout.contains(&said), "{key}: {}", run.stdout);
        }
    }
    // Accepted with it, and edited back.
    suite.write(manifest, format!("{before}opacity = true\n"));
    let run = suite.volref(&["accept", "smoke/plain", "--reason", "opacity is asked for"]);
    run.prints(0, "recorded");
    suite.volref(validate).expect(0, "");
    suite.write(manifest, before);
    suite
        .volref(validate)
        .prints(3, "the opacity of the case has changed");
}

/// A bias that an image need not show is no detail of a manifest.
#[test]
fn a_required_resolution_is_sealed() {
    let suite =
        Folder::with_room("converged_samples = 256\nresolution = 0.9\nmean_resolution = 0.5");
    suite.accept_all();
    let manifest = "fixtures/cases/fog/room.toml";
    let looser = suite
        .text(manifest)
        .replace("mean_resolution = 0.5", "mean_resolution = 0.9");
    suite.write(manifest, looser);
    let run = suite.volref("verify fog/room");
    run.prints(3, "the mean_resolution of the case has changed");
}
