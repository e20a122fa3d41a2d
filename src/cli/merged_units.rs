//! Units of goldens of several machines, brought together.

use super::failure::{Exit, Failure, bad_input};
use super::progress;
use super::suite::Selection;
use crate::suite::{AddError, Added, CaseUnits, Suite, Unit, UnitFolder, read_unit};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Units brought together.
#[derive(Default)]
pub struct JoinedUnits {
    folder: PathBuf,
    added: usize,
    cases: Vec<UnitsOfCase>,
    /// Files that cannot be used, each with what is wrong with it.
    damaged: Vec<String>,
}

/// How much of the rendering of a case there is.
struct UnitsOfCase {
    case: String,
    all: usize,
    missing: Vec<Unit>,
}

/// Brings the units in `files` to where `accept` finds them. All are looked at before any is copied.
pub fn joined_units(
    files: &[PathBuf],
    suite: &Suite,
    selection: &Selection,
) -> Result<JoinedUnits, Failure> {
    let to = UnitFolder::open(selection.kept_folder(suite));
    let bar = progress::counted("files", 2 * files.len());
    let mut joined = JoinedUnits {
        folder: to.path(),
        ..JoinedUnits::default()
    };
    let mut of_cases: BTreeMap<String, (CaseUnits<'_>, Vec<&PathBuf>)> = BTreeMap::new();
    for file in files {
        bar.inc(1);
        let unit = match read_unit(file) {
            Ok((unit, _)) => unit,
            Err(reason) => {
                joined.damaged.push(format!("{}: {reason}", file.display()));
                continue;
            }
        };
        if !of_cases.contains_key(&unit.case) {
            let case = suite.cases().iter().find(|case| case.name == unit.case);
            let case = case.ok_or_else(|| {
                refused(
                    file,
                    &format!("of {}, which is no case of this suite", unit.case),
                )
            })?;
            let loaded = CaseUnits::of(case).map_err(|error| Failure {
                exit: Exit::BadInput,
                report: error.into(),
            })?;
            of_cases.insert(unit.case.clone(), (loaded, Vec::new()));
        }
        let (of, files) = of_cases.get_mut(&unit.case).expect("inserted above");
        of.matching(&unit).map_err(|what| refused(file, &what))?;
        files.push(file);
    }
    for (case, (of, files)) in of_cases {
        for file in files {
            bar.inc(1);
            let (unit, film) = read_unit(file).map_err(bad_input)?;
            match to.add(&unit, &film) {
                Ok(Added::New) => joined.added += 1,
                Ok(Added::WasHere) => {}
                Err(error) => return Err(not_added(file, &to.path().join(unit.file()), error)),
            }
        }
        let missing = of.units().filter(|unit| !to.is_intact(unit)).cloned();
        joined.cases.push(UnitsOfCase {
            case,
            all: of.units().count(),
            missing: missing.collect(),
        });
    }
    bar.finish_and_clear();
    Ok(joined)
}

fn refused(file: &Path, what: &str) -> Failure {
    let message = format!("{} is {what}: nothing was copied", file.display());
    let help =
        "remove it, or leave its folder out; `volref units --compute` computes what is missing";
    Failure::new(Exit::BadInput, message, Some(help))
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
            0 if !self.cases.is_empty() => Exit::Passed,
            _ => Exit::Undecided,
        }
    }

    pub fn text(&self) -> String {
        let widest = self.cases.iter().map(|of| of.case.len()).max().unwrap_or(0);
        let mut text = String::new();
        for damaged in &self.damaged {
            text.push_str(&format!("not used: {damaged}\n"));
        }
        for of in &self.cases {
            let kept = of.all - of.missing.len();
            text.push_str(&format!(
                "{:<widest$}  {kept} of {} units\n",
                of.case, of.all
            ));
            for unit in &of.missing {
                let [first, end] = unit.rows;
                text.push_str(&format!(
                    "    missing: {} of the {} rendering, rows {first} to {}\n",
                    &unit.id[..12],
                    unit.rendering,
                    end - 1
                ));
            }
        }
        let added = self.added;
        text.push_str(&format!(
            "\n{added} units copied to {}\n",
            self.folder.display()
        ));
        let whole = self.cases.iter().filter(|of| of.missing.is_empty());
        let whole: Vec<&str> = whole.map(|of| of.case.as_str()).collect();
        if !whole.is_empty() {
            let words = ["volref", "accept"].into_iter().chain(whole);
            text.push_str(&format!(
                "\nTo accept them:\n  {} --reason TEXT\n",
                shell_words::join(words)
            ));
        }
        if self.missing() > 0 {
            text.push_str("\nTo compute what is missing:\n  volref units --compute\n");
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
            "damaged": self.damaged,
        })
    }
}
