//! What we promise about other crates.

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

/// Versions of a package in Cargo.lock.
fn locked(name: &str) -> Vec<String> {
    let lock: Table = include_str!("../../Cargo.lock").parse().unwrap();
    let packages = lock["package"].as_array().unwrap().iter();
    packages
        .filter(|package| package["name"].as_str() == Some(name))
        .map(|package| package["version"].as_str().unwrap().to_owned())
        .collect()
}
