//! Units of goldens from several machines, copied to one place.

use super::failure::{Exit, Failure, bad_input};
use super::output::number_of;
use super::progress;
use super::suite::Selection;
use crate::report::widest;
use crate::runs::{AddError, Added, CaseUnits, Unit, UnitFile, UnitFolder};
use crate::suite::Suite;
use serde_json::{Value, json};
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Units of several folders, joined.
#[derive(Default)]
pub struct JoinedUnits {
    folder: PathBuf,
    /// Arguments that name the suite.
    suite: Vec<String>,
    added: usize,
    cases: Vec<UnitsOfCase>,
    /// Files that are not used, each with the reason.
    unused: Vec<String>,
    /// True if a file cannot be read, and no other file has its name.
    has_damage: bool,
}

/// Units of a case, and those that are missing.
struct UnitsOfCase {
    case: String,
    all: usize,
    missing: Vec<Unit>,
}

/// Copies the units in `files` to the folder in which `accept` looks for them. All are checked
/// before any is copied.
pub fn joined_units(
    files: &[PathBuf],
    suite: &Suite,
    selection: &Selection,
) -> Result<JoinedUnits, Failure> {
    let to = UnitFolder::open(selection.kept_folder(suite));
    let bar = progress::counted("files", 2 * files.len());
    let mut joined = JoinedUnits {
        folder: to.path(),
        suite: selection.words(),
        ..JoinedUnits::default()
    };
    let mut sorted = SortedFiles::of(files, suite, &bar)?;
    if let (true, Some((file, what))) = (sorted.of_cases.is_empty(), sorted.refused.first()) {
        let message = format!("{} is {what}: nothing was copied", file.display());
        let help = "give folders of this suite, by this build of volref; `volref units --compute` computes what is \
                    missing";
        return Err(Failure::new(Exit::BadInput, message, Some(help)));
    }
    let words = sorted.refused.iter();
    let words = words.map(|(file, what)| format!("{} is {what}", file.display()));
    joined.unused = sorted.damaged.into_iter().chain(words).collect();
    for (case, (of, files)) in sorted.of_cases {
        let mut here = BTreeSet::new();
        for file in files {
            bar.inc(1);
            let kept = UnitFile::read(file).map_err(bad_input)?;
            let film = kept.film().map_err(bad_input)?;
            let unit = kept.unit;
            match to.add(&unit, &film) {
                Ok(Added::New) => joined.added += 1,
                Ok(Added::WasHere) => {}
                Err(error) => return Err(not_added(file, &to.path().join(unit.file()), error)),
            }
            if let Some(name) = file.file_name() {
                sorted.damaged_names.remove(name);
            }
            here.insert(unit.id);
        }
        let is_missing = |unit: &&Unit| !here.contains(&unit.id) && !to.is_intact(unit);
        let missing = of.units().filter(is_missing).cloned();
        joined.cases.push(UnitsOfCase {
            case,
            all: of.units().count(),
            missing: missing.collect(),
        });
    }
    bar.finish_and_clear();
    joined.has_damage = !sorted.damaged_names.is_empty();
    Ok(joined)
}

/// Files of units, checked.
#[derive(Default)]
struct SortedFiles<'s, 'f> {
    /// Files that are used, by name of their case.
    of_cases: BTreeMap<String, (CaseUnits<'s>, Vec<&'f PathBuf>)>,
    /// Files of other suites, cases or programs, with what each is.
    refused: Vec<(&'f PathBuf, String)>,
    /// Files that cannot be read, each with the reason.
    damaged: Vec<String>,
    damaged_names: BTreeSet<&'f OsStr>,
}

impl<'s, 'f> SortedFiles<'s, 'f> {
    fn of(
        files: &'f [PathBuf],
        suite: &'s Suite,
        bar: &progress::Bar,
    ) -> Result<SortedFiles<'s, 'f>, Failure> {
        let mut sorted = SortedFiles::default();
        for file in files {
            bar.inc(1);
            let kept = match UnitFile::read(file) {
                Ok(kept) => kept,
                Err(reason) => {
                    sorted.add_damaged(file, &reason);
                    continue;
                }
            };
            let unit = &kept.unit;
            let (of, files) = match sorted.of_cases.entry(unit.case.clone()) {
                Entry::Occupied(of_case) => of_case.into_mut(),
                Entry::Vacant(of_case) => {
                    let Some(case) = suite.case(&unit.case) else {
                        let what = format!("of {}, which is not a case of this suite", unit.case);
                        sorted.refused.push((file, what));
                        continue;
                    };
                    of_case.insert((CaseUnits::of(case)?, Vec::new()))
                }
            };
            // Only now: an image is as large as the unit says, and this is one of the case.
            match of.matching(unit).map(|_| kept.film()) {
                Ok(Ok(_)) => files.push(file),
                Ok(Err(reason)) => sorted.add_damaged(file, &reason),
                Err(what) => sorted.refused.push((file, what)),
            }
        }
        let of_cases = &mut sorted.of_cases;
        of_cases.retain(|_, (_, files)| !files.is_empty());
        Ok(sorted)
    }

    fn add_damaged(&mut self, file: &'f Path, reason: &str) {
        let sentence = format!("{}: {reason}", file.display());
        self.damaged.push(sentence);
        self.damaged_names.extend(file.file_name());
    }
}

fn not_added(file: &Path, here: &Path, error: AddError) -> Failure {
    let exit = match error {
        AddError::OtherBits => Exit::Mismatch,
        AddError::Keep(_) => Exit::BadInput,
    };
    let message = match error {
        AddError::OtherBits => format!("{} and {}: {error}", file.display(), here.display()),
        AddError::Keep(_) => error.to_string(),
    };
    Failure::new(exit, message, None)
}

impl JoinedUnits {
    fn missing(&self) -> usize {
        self.cases.iter().map(|of| of.missing.len()).sum()
    }

    pub fn exit(&self) -> Exit {
        match self.missing() {
            // A file that cannot be read may be of a case of which nothing else is here.
            0 if !self.cases.is_empty() && !self.has_damage => Exit::Passed,
            _ => Exit::Undecided,
        }
    }

    pub fn text(&self) -> String {
        let widest = widest(self.cases.iter().map(|of| &of.case));
        let mut text = String::new();
        for unused in &self.unused {
            text.push_str(&format!("not used: {unused}\n"));
        }
        for of in &self.cases {
            let kept = of.all - of.missing.len();
            text.push_str(&format!(
                "{:<widest$}  {kept} of {} units\n",
                of.case, of.all
            ));
            for unit in &of.missing {
                text.push_str(&format!(
                    "    missing: {} of the {} rendering, {}\n",
                    unit.short_id(),
                    unit.rendering,
                    unit.rows_in_words(),
                ));
            }
        }
        let copied = number_of(self.added as u64, "unit");
        text.push_str(&format!("\n{copied} copied to {}\n", self.folder.display()));
        let command = |before: [&str; 2], is_of: fn(&UnitsOfCase) -> bool, after: &str| {
            let cases = self.cases.iter().filter(|of| is_of(of));
            let cases: Vec<&str> = cases.map(|of| of.case.as_str()).collect();
            let words = before.into_iter().chain(cases.iter().copied());
            let words = words.chain(self.suite.iter().map(String::as_str));
            let command = format!("  {} {after}\n", shell_words::join(words));
            (!cases.is_empty()).then_some(command)
        };
        let is_whole = |of: &UnitsOfCase| of.missing.is_empty();
        if let Some(accept) = command(["volref", "accept"], is_whole, "--reason TEXT") {
            text.push_str(&format!("\nTo accept them:\n{accept}"));
        }
        let has_gaps = |of: &UnitsOfCase| !of.missing.is_empty();
        if let Some(compute) = command(["volref", "units"], has_gaps, "--compute") {
            text.push_str(&format!("\nTo compute what is missing:\n{compute}"));
        }
        text
    }

    pub fn json(&self) -> Value {
        let of_case =
            |of: &UnitsOfCase| json!({ "name": of.case, "units": of.all, "missing": of.missing });
        json!({
            "folder": self.folder,
            "copied": self.added,
            "cases": self.cases.iter().map(of_case).collect::<Vec<_>>(),
            "not_used": self.unused,
        })
    }
}
