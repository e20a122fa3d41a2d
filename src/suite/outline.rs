//! Outline of a suite: its families in the order of their use, and its core set.

use crate::files::regular_file;
use crate::scene::SceneResult;
use crate::scene::format::{Key, Kind, Table};
use crate::scene::reader::{Document, Reader};
use std::cell::RefCell;
use std::path::Path;

/// The file, relative to the root of the suite; without it families are in the order of their names.
pub(super) const FILE: &str = "fixtures/suite.toml";
/// Longest manifest read: 1 MiB, far more than any needs.
const MOST_BYTES: u64 = 1 << 20;
/// The filter that selects the core set.
pub(crate) const CORE: &str = "core";

/// The declaration of the file.
const OUTLINE: Table = Table::new("A suite: which cases come first, and what its families ask.").keys(&[
    Key::optional("core", Kind::Words)
        .doc("The core set, by names of cases: what a renderer is asked first. The filter `core` selects it."),
    Key::optional("family", Kind::Tables(&FAMILY))
        .doc("Families in the order of their use. Others follow, by name."),
]);

const FAMILY: Table = Table::new("A family of cases.").keys(&[
    Key::required("name", Kind::Text).doc("Folder of its manifests in fixtures/cases."),
    Key::required("asks", Kind::Text).doc("What it asks of a renderer, in one short line."),
]);

/// Contents of the file.
#[derive(Clone, Debug, Default)]
pub(super) struct Outline {
    /// Names of the cases that a renderer is asked first.
    pub core: Vec<String>,
    /// Name of a family, and what it asks.
    pub families: Vec<(String, String)>,
}

impl Outline {
    /// The outline in a file, whose core set names cases of the suite only.
    pub fn read(path: &Path, is_case: impl Fn(&str) -> bool) -> SceneResult<Outline> {
        read_file(path, &OUTLINE, |reader| {
            let core: Vec<String> = reader.optional("core")?.unwrap_or_default();
            if let Some(name) = core.iter().find(|name| !is_case(name)) {
                let message =
                    format!("the core set names {name:?}, which is no case of this suite");
                let help = format!(
                    "remove it from `core`, or add its manifest, fixtures/cases/{name}.toml"
                );
                return Err(reader.mistake("core", message, help));
            }
            let family = |table: &Reader| Ok((table.get("name")?, table.get("asks")?));
            let families = reader.tables_as("family", family)?;
            Ok(Outline { core, families })
        })
    }

    /// The filters, with the names of its cases in place of the word [`CORE`].
    pub fn with_core(&self, filters: &[String]) -> Vec<String> {
        let names = |filter: &String| {
            // A filter that begins with ! excludes what the rest of it names.
            let mark = filter
                .strip_suffix(CORE)
                .filter(|mark| matches!(*mark, "" | "!"));
            match mark {
                Some(mark) if !self.core.is_empty() => {
                    let named = self.core.iter().map(|name| format!("{mark}{name}"));
                    named.collect()
                }
                _ => vec![filter.clone()],
            }
        };
        filters.iter().flat_map(names).collect()
    }
}

/// The value that `read` makes of the table in a file of the suite.
pub(super) fn read_file<T>(
    path: &Path,
    declaration: &'static Table,
    read: impl FnOnce(&Reader) -> SceneResult<T>,
) -> SceneResult<T> {
    let shown = path.display().to_string();
    let document = |text| Document { path: &shown, text };
    let failed = |message: String| document("").error(None, message, None);
    let bytes = regular_file::read(path, MOST_BYTES)
        .map_err(|error| failed(format!("cannot read the manifest: {error}")))?;
    let text = String::from_utf8(bytes)
        .map_err(|_| failed("the manifest is not UTF-8 text".to_owned()))?;
    let document = document(&text);
    let root = document.parse()?;
    let log = RefCell::default();
    read(&Reader::new(&document, declaration, &root, &log)?)
}
