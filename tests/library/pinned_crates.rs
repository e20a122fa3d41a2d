//! What we promise about other crates.

use crate::needs::tried;
use std::path::Path;
use std::process::Command;
use toml::Table;
use volref::suite::LIBM_VERSION;

/// Goldens remember which `libm` they were made with; it must be the one that is linked.
#[test]
fn the_libm_of_the_goldens_is_the_pinned_one() {
    let manifest: Table = include_str!("../../Cargo.toml").parse().unwrap();
    let pin = manifest["dependencies"]["libm"]["version"]
        .as_str()
        .unwrap();
    assert_eq!(pin, format!("={LIBM_VERSION}"));

    assert_eq!(locked("libm"), [LIBM_VERSION]);
}

/// Messages are wrapped without ICU, whose two dozen crates take longer to compile than any other
/// part of the command line.
#[test]
fn lines_are_broken_without_icu() {
    assert_eq!(locked("textwrap"), ["0.16.2"]);
    assert_eq!(locked("icu_segmenter"), [""; 0]);
}

/// The output of cargo; `None` where the tests run on another machine than the one that compiled them.
fn cargo(arguments: &[&str]) -> Option<String> {
    let cargo = Path::new(env!("CARGO"));
    if !cargo.exists() {
        return None;
    }
    let folder = env!("CARGO_MANIFEST_DIR");
    let run = Command::new(cargo)
        .args(arguments)
        .current_dir(folder)
        .output();
    let run = run.unwrap();
    assert!(
        run.status.success(),
        "{}",
        String::from_utf8_lossy(&run.stderr)
    );
    Some(String::from_utf8(run.stdout).unwrap())
}

/// `(MIT OR Apache-2.0) AND Unicode-3.0`, of older crates also `MIT/Apache-2.0`: of each part one licence is needed.
fn is_allowed(licence: &str, allowed: &[&str]) -> bool {
    let is_one = |part: &str| part.split(" OR ").any(|one| allowed.contains(&one.trim()));
    let parts = licence.replace(['(', ')'], "").replace('/', " OR ");
    parts.split(" AND ").all(is_one)
}

/// Of what is built for this machine; of all others cargo-deny checks it, by the same file.
#[test]
fn licences_of_dependencies_are_accepted() {
    let deny: Table = include_str!("../../deny.toml").parse().unwrap();
    let allowed = deny["licenses"]["allow"].as_array().unwrap().iter();
    let allowed: Vec<&str> = allowed.filter_map(|licence| licence.as_str()).collect();
    assert!(is_allowed("(MIT OR GPL-3.0) AND Unicode-3.0", &allowed));
    assert!(!is_allowed("MIT AND GPL-3.0", &allowed) && !is_allowed("GPL-3.0", &allowed));
    let version = cargo(&["--version", "--verbose"]);
    let need = "the cargo that compiled the tests";
    tried(version.is_some(), need, "licences of dependencies");
    let Some(version) = version else {
        return;
    };
    let host = version
        .lines()
        .find_map(|line| line.strip_prefix("host: "))
        .unwrap();
    let metadata = [
        "metadata",
        "--offline",
        "--locked",
        "--format-version",
        "1",
        "--filter-platform",
        host,
    ];
    let metadata: serde_json::Value = serde_json::from_str(&cargo(&metadata).unwrap()).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    assert!(packages.len() > 100);
    for package in packages {
        let licence = package["license"].as_str().unwrap_or("none");
        assert!(
            is_allowed(licence, &allowed),
            "{}: {licence}",
            package["name"]
        );
    }
}

/// Versions of a package in Cargo.lock.
fn locked(name: &str) -> Vec<String> {
    let lock: Table = include_str!("../../Cargo.lock").parse().unwrap();
    let packages = lock["package"].as_array().unwrap().iter();
    packages
        .filter(|package| package["name"].as_str() == Some(name))
        .map(|package| package["version"].as_str().unwrap().to_owned())
        .collect()
}
