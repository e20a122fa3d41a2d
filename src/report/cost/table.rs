//! The tables of a scene, for a terminal and a page.

use super::words;
use crate::cost::effects::EffectPrice;
use crate::cost::{Cost, Event, Level, MeanWork, Parameter, Sweep};
use serde::Serialize;

/// Rows of text: the first column begins at the left, the others end at the right.
#[derive(Serialize)]
pub(super) struct Table {
    pub title: String,
    pub heads: Vec<&'static str>,
    pub rows: Vec<Vec<String>>,
    /// Sentences below it.
    pub notes: Vec<String>,
}

/// The tables of `cost`: each sweep, then the effects.
pub(super) fn tables(cost: &Cost) -> Vec<Table> {
    let mut tables: Vec<Table> = cost.sweeps.iter().map(sweep).collect();
    if !cost.effects.is_empty() {
        tables.push(effects(&cost.effects));
    }
    tables
}

impl Table {
    /// Plain text, two blanks before each line and between columns.
    pub fn text(&self) -> String {
        let heads: Vec<String> = self.heads.iter().map(|head| (*head).to_owned()).collect();
        let lines = || std::iter::once(&heads).chain(&self.rows);
        let width = |at: usize| lines().map(|line| line[at].chars().count()).max();
        let widths: Vec<usize> = (0..heads.len()).filter_map(width).collect();
        let mut text = String::new();
        for line in lines() {
            for (at, (cell, width)) in line.iter().zip(&widths).enumerate() {
                text.push_str(&match at {
                    0 => format!("  {cell:<width$}"),
                    _ => format!("  {cell:>width$}"),
                });
            }
            text.truncate(text.trim_end().len());
            text.push('\n');
        }
        text
    }

    /// Adds a column; none of no values.
    fn column(&mut self, head: &'static str, values: impl Iterator<Item = Option<String>>) {
        let values: Vec<Option<String>> = values.collect();
        if values.iter().all(Option::is_none) {
            return;
        }
        self.heads.push(head);
        for (row, value) in self.rows.iter_mut().zip(values) {
            row.push(value.unwrap_or_else(|| "–".to_owned()));
        }
    }
}

/// Rows of a first column alone.
fn rows<'n>(names: impl Iterator<Item = &'n String>) -> Vec<Vec<String>> {
    names.map(|name| vec![name.clone()]).collect()
}

/// The settings of a sweep.
fn sweep(sweep: &Sweep) -> Table {
    let (levels, known) = (&sweep.levels, sweep.order.known);
    let [width, height] = sweep.size;
    let varied = match sweep.parameter {
        Parameter::Step => "distance between samples along a ray",
        Parameter::ShadowStep => "distance between samples along a shadow ray",
        Parameter::Samples => "samples per pixel",
    };
    let reference = &sweep.reference;
    let mut notes = vec![format!(
        "reference: {}; its own error at most {}",
        reference.method,
        words::error(reference.bound)
    )];
    notes.push(words::order(&sweep.order));
    if levels.iter().any(|level| level.error.l2 <= known) {
        let known = words::error(known);
        notes.push(format!(
            "° too near to the error of the reference: not above {known}"
        ));
    }
    notes.extend(sweep.cut.iter().map(|why| format!("ended early: {why}")));
    let mut table = Table {
        title: format!("{}: {width} × {height} pixels by the {varied}", sweep.name),
        heads: vec!["setting"],
        rows: rows(levels.iter().map(|level| &level.setting)),
        notes,
    };
    let work = levels.iter().map(|level| &level.work);
    columns_of_work(&mut table, work.collect());
    let error = |level: &Level| {
        let mark = if level.error.l2 <= known { "° " } else { "" };
        Some(format!("{mark}{}", words::error(level.error.l2)))
    };
    table.column("RMS error", levels.iter().map(error));
    let local = std::iter::once(&None).chain(&sweep.order.local);
    table.column(
        "order",
        local.map(|order| Some(format!("{:.2}", (*order)?))),
    );
    let times = levels.iter().map(|level| level.time.as_ref());
    table.column("time per pixel", times.map(|time| time.map(words::times)));
    table
}

/// Lookups and random numbers, where there are any.
fn columns_of_work(table: &mut Table, work: Vec<&MeanWork>) {
    type Count = fn(&MeanWork) -> f64;
    let counts: [(_, Count); 2] = [
        ("lookups", MeanWork::lookups),
        ("random", |work| work[Event::RandomDraw]),
    ];
    for (head, count) in counts {
        let is_counted = work.iter().any(|work| count(work) > 0.0);
        let shown = |work: &&MeanWork| is_counted.then(|| words::count(count(work)));
        table.column(head, work.iter().map(shown));
    }
}

/// Cost of each effect.
fn effects(effects: &[EffectPrice]) -> Table {
    let mut table = Table {
        title: "price of each effect by itself, per pixel".to_owned(),
        heads: vec!["effect"],
        rows: rows(effects.iter().map(|effect| &effect.effect)),
        notes: vec![],
    };
    let work = effects.iter().map(|effect| &effect.work);
    columns_of_work(&mut table, work.collect());
    let factor = |times: f64| format!("{times:.1}");
    let lookups = effects.iter().map(|effect| effect.times_lookups);
    table.column("× work", lookups.map(|times| times.map(factor)));
    let times = || effects.iter().map(|effect| effect.time.as_ref());
    table.column("time", times().map(|time| time.map(words::times)));
    let first = times().next().flatten().map(|time| time.median);
    let times = times().map(|time| Some(factor(time?.median / first?)));
    table.column("× time", times);
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned_and_empty_ones_left_out() {
        let mut table = Table {
            title: String::new(),
            heads: vec!["name"],
            rows: vec![vec!["a".to_owned()], vec!["longer".to_owned()]],
            notes: vec![],
        };
        table.column("empty", [None, None].into_iter());
        table.column("count", [Some("12".to_owned()), None].into_iter());
        assert_eq!(
            table.text(),
            "  name    count\n  a          12\n  longer      –\n"
        );
    }
}
