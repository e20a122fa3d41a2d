//! `volref units [CASE…]`

use super::failure::{Exit, Failure};
use super::output::{self, Json, number_of};
use super::partition::PartitionArgument;
use super::suite::Selection;
use super::{Outcome, progress, render};
use crate::report::widest;
use crate::runs::{AcceptWatch, CaseUnits, StepsOfWork, Unit, UnitError, UnitFolder};
use rayon::prelude::*;
use serde_json::{Value, json};

/// List the work units of goldens, or compute some of them
///
/// A unit is some rows of the rendering of a stochastic case. Any process anywhere may compute any unit;
/// its file in .volref/units is the same. volref merge brings units together, and volref accept uses them.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Families, cases, or patterns over them such as 'fog/*'; those with ! before them are left out
    /// [default: all cases]
    #[arg(value_name = "CASE")]
    cases: Vec<String>,
    /// Compute the units that are missing
    #[arg(long)]
    compute: bool,
    /// The unit whose identifier begins with ID; repeat for several [default: all]
    #[arg(long = "unit", value_name = "ID")]
    units: Vec<String>,
    #[command(flatten)]
    selection: Selection,
    #[command(flatten)]
    partition: PartitionArgument,
    /// Threads to use; the images are the same for any number [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    #[command(flatten)]
    json: Json,
}

/// A unit and its case.
type UnitOfCase<'u> = (&'u CaseUnits<'u>, &'u Unit);

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    let suite = if arguments.compute {
        arguments.selection.open_to_change()?
    } else {
        arguments.selection.open()?
    };
    output::check(&[arguments.json.file()], &[])?;
    let cases = suite.select(&arguments.cases)?;
    let of_cases = cases.into_iter().map(CaseUnits::of);
    let of_cases = of_cases.collect::<Result<Vec<CaseUnits<'_>>, _>>()?;
    let all = of_cases
        .iter()
        .flat_map(|of| of.units().map(move |unit| (of, unit)));
    let mut units: Vec<UnitOfCase<'_>> = all.collect();
    if units.is_empty() {
        let message = "none of these cases is rendered from samples: there are no units";
        let help = "`volref list` says which are stochastic";
        return Err(Failure::new(Exit::Undecided, message, Some(help)));
    }
    check_chosen(&arguments.units, &units)?;
    if !arguments.units.is_empty() {
        units.retain(|(_, unit)| arguments.units.iter().any(|id| unit.id.starts_with(id)));
    }
    arguments
        .partition
        .retain(&mut units, "units", |(_, unit)| unit.id.clone())?;
    let folder = UnitFolder::open(arguments.selection.kept_folder(&suite));
    let is_kept = units.par_iter().map(|(_, unit)| {
        let film = folder.get(unit);
        film.map(|film| film.is_some()).unwrap_or_else(|reason| {
            progress::note(&format!("counted as missing: {reason}"));
            false
        })
    });
    let mut is_kept: Vec<bool> = is_kept.collect();
    let mut computed = None;
    if arguments.compute {
        of_cases.iter().for_each(|of| folder.sweep(&of.case.name));
        let missing = units.iter().zip(&is_kept).filter(|(_, is_kept)| !**is_kept);
        let missing: Vec<&UnitOfCase<'_>> = missing.map(|(unit, _)| unit).collect();
        render::with_threads(arguments.threads, || compute(&missing, &folder))??;
        computed = Some(missing.len());
        is_kept.fill(true);
    }
    let units: Vec<(&Unit, bool)> = units.iter().map(|(_, unit)| *unit).zip(is_kept).collect();
    let text = listed(&units, &folder, computed);
    let entries = units
        .iter()
        .map(|(unit, is_kept)| entry(unit, *is_kept, &folder));
    let entries: Vec<Value> = entries.collect();
    let value = json!({
        "schema": "volref/units/1",
        "folder": folder.path(),
        "units": entries,
    });
    arguments.json.instead_of(text, &value).map(Outcome::from)
}

/// Fails if an identifier fits no unit, or several.
fn check_chosen(chosen: &[String], units: &[UnitOfCase<'_>]) -> Result<(), Failure> {
    for id in chosen {
        let found = units
            .iter()
            .filter(|(_, unit)| unit.id.starts_with(id))
            .count();
        if found != 1 {
            let message = match found {
                0 => format!("there is no unit {id:?}"),
                _ => format!("{found} units begin with {id:?}"),
            };
            let help = "`volref units --json` lists them; their identifiers change with the scene, the \
                        samples and the build of volref";
            return Err(Failure::new(Exit::BadInput, message, Some(help)));
        }
    }
    Ok(())
}

/// Computes the units that are missing. One that fails does not hold up the others.
fn compute(missing: &[&UnitOfCase<'_>], folder: &UnitFolder) -> Result<(), Failure> {
    let bar = progress::work();
    bar.begin_all(missing.iter().map(|(_, unit)| unit.paths).sum());
    let computed = missing.par_iter().map(|(of, unit)| {
        bar.begin_case(&unit.case);
        let steps = StepsOfWork::new(&bar, unit.paths);
        of.compute(unit, folder, &steps)
    });
    let computed: Vec<Result<(), UnitError>> = computed.collect();
    bar.finish_and_clear();
    computed.into_iter().collect::<Result<(), UnitError>>()?;
    Ok(())
}

impl From<UnitError> for Failure {
    fn from(error: UnitError) -> Failure {
        Failure {
            exit: Exit::BadInput,
            report: error.into(),
        }
    }
}

/// A line for each unit, and whether it is kept, and how many are missing.
fn listed(units: &[(&Unit, bool)], folder: &UnitFolder, computed: Option<usize>) -> String {
    let widest = widest(units.iter().map(|(unit, _)| &unit.case));
    let mut text = String::new();
    for (unit, is_kept) in units {
        text.push_str(&format!(
            "{}  {:<widest$}  {:<9}  {:>6} samples  {}  {}\n",
            unit.short_id(),
            unit.case,
            unit.rendering,
            unit.samples,
            unit.rows_in_words(),
            if *is_kept { "kept" } else { "missing" },
        ));
    }
    let missing = || units.iter().filter(|(_, is_kept)| !is_kept);
    let paths: u64 = missing().map(|(unit, _)| unit.paths).sum();
    let all = number_of(units.len() as u64, "unit");
    let left = match missing().count() {
        0 => "none missing".to_owned(),
        count => format!("{count} missing, {:.1} million paths", paths as f64 / 1e6),
    };
    let computed = computed.map_or(String::new(), |computed| {
        format!("{computed} computed now, ")
    });
    text + &format!(
        "\n{all}: {computed}{left}, in {}\n",
        folder.path().display()
    )
}

fn entry(unit: &Unit, is_kept: bool, folder: &UnitFolder) -> Value {
    let mut value = json!(unit);
    value["file"] = json!(folder.path().join(unit.file()));
    value["kept"] = json!(is_kept);
    value
}
