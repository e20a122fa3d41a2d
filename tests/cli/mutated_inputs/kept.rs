//! Results that one process leaves for another.

use super::kinds::Workshop;
use volref::judging::ResultFolder;

/// Folder of the workshop with results of `verify`.
pub const RESULTS: &str = "parts";
/// Folder of the workshop with results of `selftest`.
pub const TRIALS: &str = "trials";

/// The files of parts below `folder` of the workshop.
fn files(workshop: &Workshop, folder: &str) -> Vec<String> {
    let files = workshop.folder.files().into_keys();
    let is_part = |name: &String| {
        name.starts_with(folder) && name.ends_with(".json") && !name.ends_with("run.json")
    };
    files.filter(is_part).collect()
}

/// The one of them that mutants take the place of.
pub fn place(workshop: &Workshop, folder: &str) -> String {
    files(workshop, folder).swap_remove(0)
}

pub fn seeds(workshop: &Workshop, folder: &str) -> Vec<Vec<u8>> {
    let files = files(workshop, folder).into_iter();
    files.map(|name| workshop.folder.read(&name)).collect()
}

/// The results of `folder` while `bytes` stand in place of a part.
pub fn read_results(workshop: &Workshop, folder: &str, bytes: &[u8]) -> Result<(), String> {
    let place = workshop.place(folder, ".json");
    workshop.folder.write(place, bytes);
    let results = ResultFolder::open(workshop.folder.path(folder));
    let read = || {
        for run in results.runs()?.into_keys() {
            for part in results.parts(&run) {
                part?;
            }
        }
        Ok(())
    };
    let read = read();
    workshop.restore(place);
    read
}
