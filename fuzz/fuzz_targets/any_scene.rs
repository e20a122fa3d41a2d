//! Any bytes are the decisions by which a valid scene is written; what is demanded of it is what
//! `tests/library/any_scene` demands, whose generator this is.
#![no_main]

#[path = "../../tests/library/any_scene/bounds.rs"]
mod bounds;
#[path = "../../tests/library/any_scene/check.rs"]
mod check;
#[path = "../../tests/library/any_scene/choices.rs"]
mod choices;
#[path = "../../tests/library/any_scene/scenes.rs"]
mod scenes;

use libfuzzer_sys::fuzz_target;
use rayon::ThreadPool;
use std::sync::LazyLock;
use tempfile::TempDir;

static PLACE: LazyLock<(TempDir, [ThreadPool; 2])> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("a folder for the files of a scene");
    (folder, check::pools())
});

fuzz_target!(|bytes: &[u8]| {
    let words = bytes
        .chunks_exact(4)
        .map(|word| word.try_into().expect("four bytes"));
    let list: Vec<u32> = words.map(u32::from_le_bytes).collect();
    let written = scenes::written(&list);
    let (folder, pools) = &*PLACE;
    if let Err(why) = check::check(&written, folder.path(), pools) {
        panic!("{why}\n{written:?}");
    }
});
