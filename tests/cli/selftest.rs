//! `volref selftest` on a small suite. `scripts/check.sh` runs it on the real one.

use crate::folder::Folder;

/// Every mistake for which a classified volume or a plot gives occasion is caught, and exit code
/// and matrix say so.
#[test]
fn a_small_suite_catches_what_it_can() {
    let folder = Folder::with_goldens();
    let run = folder.volref("selftest smoke plots --json");
    let json = run.json();
    assert_eq!(json["schema"], "volref/selftest/1");
    let rows = json["mistakes"].as_array().unwrap();
    let row = |name: &str| {
        let found = rows.iter().find(|row| row["name"] == name);
        found
            .unwrap_or_else(|| panic!("{name} is in the catalogue"))
            .clone()
    };
    for name in [
        "mirrored",
        "nearest-for-trilinear",
        "shadow-left-out",
        "opacity-uncorrected",
    ] {
        assert_ne!(row(name)["caught_by"], serde_json::json!([]), "{name}");
    }
    assert_eq!(
        row("shadow-left-out")["caught_by"],
        serde_json::json!(["smoke/shadow"])
    );
    assert_eq!(row("phase-reversed")["caught_by"], serde_json::json!([]));
    assert_eq!(json["summary"]["benign_rejected"], 0);
    let run = folder.volref("selftest plots smoke --quick");
    assert!(run.stdout.contains("mistakes caught"), "{}", run.stdout);
}

/// A suite without media cannot catch mistakes about them: asked as a whole it fails.
#[test]
fn a_whole_suite_must_catch_all() {
    let folder = Folder::with_goldens();
    let run = folder.volref("selftest --quick");
    run.prints(6, "phase-reversed is caught by no case");
}

/// A case that promises what it does not hold.
#[test]
fn promises_are_kept() {
    let folder = Folder::with_goldens();
    let manifest = "fixtures/cases/plots/curve.toml";
    folder.write(
        manifest,
        folder.text(manifest) + "mistakes = [\"mirrored\", \"shadow-left-out\"]\n",
    );
    let run = folder.volref("selftest plots");
    run.prints(
        6,
        "not caught, although its manifest requires it: plots/curve: shadow-left-out",
    );
    folder.write(
        manifest,
        folder.text(manifest).replace("mirrored", "mirorred"),
    );
    let run = folder.volref("selftest plots");
    run.expect(2, "did you mean \"mirrored\"?");
}
