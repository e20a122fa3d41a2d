//! Outline of a suite: its families in the order of their use, and its core set.

use super::case::{CASES, text_of};
use super::{Case, Suite, SuiteError};
use crate::scene::SceneResult;
use crate::scene::format::{Key, Kind, Table};
use crate::scene::reader::{Document, Reader};
use std::cell::RefCell;
use std::path::Path;

/// The file, relative to the root of the suite; without it families are in the order of their names.
const FILE: &str = "fixtures/suite.toml";
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

/// What the file says.
#[derive(Clone, Debug, Default)]
pub(super) struct Outline {
    core: Vec<String>,
    /// Name of a family, and what it asks.
    families: Vec<(String, String)>,
}

/// Some cases of a family.
#[derive(Clone, Debug)]
pub struct Family<'s> {
    /// Name of the family.
    pub name: &'s str,
    /// What it asks of a renderer, where the suite says so.
    pub asks: Option<&'s str>,
    /// The cases.
    pub cases: Vec<&'s Case>,
}

impl Suite {
    /// Names of the cases that a renderer is asked first.
    pub fn core(&self) -> &[String] {
        &self.outline.core
    }

    /// `cases` by families, in the order of their use.
    pub fn families<'s>(&'s self, cases: &[&'s Case]) -> Vec<Family<'s>> {
        let said = &self.outline.families;
        let place = |name: &str| said.iter().position(|(other, _)| other == name);
        let mut families: Vec<Family<'s>> = Vec::new();
        for case in cases {
            match families.iter_mut().find(|it| it.name == case.family) {
                Some(family) => family.cases.push(case),
                None => families.push(Family {
                    name: &case.family,
                    asks: place(&case.family).map(|at| said[at].1.as_str()),
                    cases: vec![case],
                }),
            }
        }
        families.sort_by_key(|family| (place(family.name).unwrap_or(said.len()), family.name));
        families
    }

    /// The filters, with the names of its cases in place of the word [`CORE`].
    pub(super) fn with_core(&self, filters: &[String]) -> Vec<String> {
        let core = self.core();
        let names = |filter: &String| {
            // A filter that begins with ! excludes what the rest of it names.
            let mark = filter
                .strip_suffix(CORE)
                .filter(|it| matches!(*it, "" | "!"));
            match mark {
                Some(mark) if !core.is_empty() => {
                    core.iter().map(|name| format!("{mark}{name}")).collect()
                }
                _ => vec![filter.clone()],
            }
        };
        filters.iter().flat_map(names).collect()
    }

    /// Reads the outline, once the cases are known.
    pub(super) fn read_outline(&mut self) -> Result<(), SuiteError> {
        let path = self.root.join(FILE);
        let is_own = self
            .own
            .as_ref()
            .is_none_or(|own| own.contains(Path::new(FILE)));
        if is_own && path.exists() {
            let read = self.outline_in(&path);
            self.outline = read.map_err(SuiteError::Manifest)?;
        }
        Ok(())
    }

    fn outline_in(&self, path: &Path) -> SceneResult<Outline> {
        let shown = path.display().to_string();
        let text = text_of(path);
        let document = Document {
            path: &shown,
            text: text.as_deref().unwrap_or(""),
        };
        if let Err(message) = &text {
            return Err(document.error(None, message.clone(), None));
        }
        let root = document.parse()?;
        let log = RefCell::default();
        let reader = Reader::new(&document, &OUTLINE, &root, &log)?;
        let core = reader.words("core")?;
        if let Some(name) = core.iter().find(|name| !self.has_manifest(name)) {
            let message = format!("the core set names {name:?}, which is no case of this suite");
            let help = format!("remove it from `core`, or add its manifest, {CASES}/{name}.toml");
            return Err(reader.mistake("core", message, help));
        }
        let family = |table: &Reader| Ok((table.text("name")?, table.text("asks")?));
        let families = reader.tables_as("family", family)?;
        Ok(Outline { core, families })
    }
}
