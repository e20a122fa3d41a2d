//! `volref sensitivity`, and what `validate` says of numbers.

use crate::folder::Folder;

const CASE: &str = "known-answers/absorbing-grid";

#[test]
fn numbers_are_listed_and_differentiated() {
    let folder = Folder::new();
    let value = folder.volref(&["sensitivity", CASE, "--json"]).json();
    let names: Vec<&str> = value["numbers"]
        .as_array()
        .unwrap()
        .iter()
        .map(|it| it["name"].as_str().unwrap())
        .collect();
    assert!(
        names.contains(&"density") && names.contains(&"environment"),
        "{names:?}"
    );

    let run = folder.volref(&[
        "sensitivity",
        CASE,
        "--of",
        "density",
        "-o",
        "d.exr",
        "--json",
    ]);
    let value = run.json();
    assert_eq!(
        (value["unit"].as_str(), value["central"].as_bool()),
        (Some("of itself"), Some(true))
    );
    // The grid absorbs: denser is darker.
    assert!(value["mean"].as_f64().unwrap() < 0.0);
    // A derivative is compared with itself as an image is.
    assert_eq!(folder.volref("compare d.exr d.exr --gate exact").code, 0);
    assert_eq!(
        folder
            .volref(&["sensitivity", CASE, "--of", "density", "-o", "d.png"])
            .code,
        0
    );
}

#[test]
fn what_is_wrong_is_said() {
    let folder = Folder::new();
    for (line, words) in [
        (
            "sensitivity CASE --of densty -o d.exr",
            "did you mean \"density\"",
        ),
        ("sensitivity CASE --of density", "--output"),
        ("sensitivity CASE -o d.exr", "--of NAME"),
        ("sensitivity CASE --of density -o d.tif", ".exr or .npy"),
        ("sensitivity CASE --of density -o d.exr --step 0", "above 0"),
        (
            "sensitivity CASE --of density -o d.exr --step nan",
            "above 0",
        ),
        (
            "sensitivity figures/figure-2 --of density -o d.exr",
            "it has none",
        ),
        ("sensitivity CASE --all -o d.exr", "random"),
        ("render CASE -o a.exr --change density", "NAME=CHANGE"),
        ("render CASE -o a.exr --change densiti=1", "did you mean"),
        ("render CASE -o a.exr --change density=inf", "finite"),
        (
            "render CASE -o a.exr --change density=-2",
            "cannot change by -2",
        ),
    ] {
        let line = line.replace("CASE", CASE);
        let arguments: Vec<&str> = line.split(' ').collect();
        folder.volref(&arguments).expect(2, &[words]);
    }
    assert!(!folder.path("d.exr").exists() && !folder.path("a.exr").exists());
}

/// A density that is off by more than what the verdict of a right image says would be seen.
#[test]
fn a_wrong_density_is_named() {
    let folder = Folder::new();
    let scene = "smoke/cornell";
    let judged = |change: &str| {
        std::fs::create_dir_all(folder.path("images/smoke")).unwrap();
        let image = "images/smoke/cornell.exr";
        assert_eq!(
            folder
                .volref(&[
                    "render", scene, "-o", image, "--spp", "8", "--seed", "3", "--change", change
                ])
                .code,
            0
        );
        let run = folder.volref("validate smoke/cornell --outputs images --explain 0 --json");
        run.json()["cases"][0].clone()
    };
    let right = judged("density=0");
    assert_ne!(right["verdict"], "fail", "{right}");
    let seen = right["detectable"].as_array().unwrap();
    let of_density = seen.iter().find(|it| it["name"] == "density").unwrap();
    let size = 2.0 * of_density["change"].as_f64().unwrap();
    let wrong = judged(&format!("density={size}"));
    assert_eq!(wrong["verdict"], "fail");
    let first = &wrong["changes"][0];
    // Nearly all of the smoke that is seen is the black one: that it is both cannot be told.
    let name = first["name"].as_str().unwrap();
    assert!(
        ["density", "density.1", "sigma_a"].contains(&name),
        "{wrong}"
    );
    let [change, error] = ["change", "error"].map(|key| first[key].as_f64().unwrap());
    assert!(
        (change - size).abs() < 4.0 * error,
        "{change} {error} {size}"
    );
}
