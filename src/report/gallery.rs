//! Results of many renderers as one offline page: a matrix of verdicts, what is wrong and why, and every image.

mod cell;
mod mark;

use super::template::{Template, blue_to_red, rendered};
use crate::compare::Picture;
use crate::film::Film;
use crate::judging::{CaseResult, Judged};
use crate::suite::{Case, Family};
use cell::{Differences, bias, fault, small};
use mark::{Mark, legend};
use minijinja::{Value, context};
use serde::Deserialize;
use std::collections::BTreeMap;

/// A renderer and its run, as a file states them; what is missing is found elsewhere.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct GalleryAbout {
    /// Name.
    pub name: Option<String>,
    /// Version.
    pub version: Option<String>,
    /// Day of the run.
    pub date: Option<String>,
    /// Command that repeats the run.
    pub command: Option<String>,
    /// Machine on which it rendered.
    pub machine: Option<String>,
    /// False if its images cannot be judged again: the page repeats what the run said.
    pub as_judged: Option<bool>,
}

/// A renderer on the page.
#[derive(Clone, Debug, Default)]
pub(crate) struct GalleryRenderer {
    /// Facts that a file or the results state.
    pub about: GalleryAbout,
    /// Profile under whose conventions its images were judged.
    pub profile: Option<String>,
    /// Wall time of its images, by case, where it was measured.
    pub seconds: BTreeMap<String, f64>,
}

impl GalleryRenderer {
    /// Its name.
    pub fn name(&self) -> &str {
        self.about.name.as_deref().unwrap_or_default()
    }
}

/// Row of a case.
pub(crate) struct GalleryRow {
    /// `family/name`.
    name: String,
    /// What the template needs beside the cells.
    head: Value,
    /// A cell for each renderer, in their order.
    cells: Vec<Option<Cell>>,
}

impl GalleryRow {
    fn mark(&self, renderer: usize) -> &'static Mark {
        let cell = self.cells[renderer].as_ref();
        cell.map_or(Mark::of(None), |cell| cell.mark)
    }
}

/// Result of a renderer for a case, and its cell in a table.
struct Cell {
    result: CaseResult,
    mark: &'static Mark,
    shown: Value,
}

/// The row of a case, with its golden, or the reason why there is none, and what was judged of each renderer.
pub(crate) fn gallery_row(
    case: &Case,
    golden: Result<Film, String>,
    judged: Vec<Option<Judged>>,
) -> GalleryRow {
    // As it is displayed, if it has pixels.
    let displayed = |picture: Picture| picture.srgb(case.exposure).ok();
    let trouble = golden.as_ref().err().cloned();
    let golden = golden.ok();
    let golden = golden.and_then(|film| displayed(Picture::Radiance(film)));
    let images: Vec<_> = judged
        .iter()
        .map(|judged| {
            let evidence = &judged.as_ref()?.evidence;
            let image = displayed(evidence.test.clone()?)?;
            let right = evidence.golden.clone();
            let right = right.and_then(|film| displayed(Picture::Radiance(film)));
            let difference = right.and_then(|right| Differences::of(&right, &image));
            Some((image, difference))
        })
        .collect();
    let differences = || images.iter().flatten().filter_map(|(_, of)| of.as_ref());
    let scale = differences().map(Differences::scale).fold(1.0, f64::max);
    let cell = |(judged, image): (Option<Judged>, &Option<(_, Option<Differences>)>)| {
        let Judged { result, evidence } = judged?;
        let mark = Mark::of(Some(&result));
        let film = evidence.test.as_ref().and_then(Picture::radiance);
        let golden = evidence.golden.as_ref();
        let known = result.known.as_ref();
        let changes: Vec<_> = result.changes.iter().map(|it| it.words.clone()).collect();
        let shown = context! {
            fault => fault(&result),
            known => known.and_then(|known| known.reason.as_ref()),
            link => known.and_then(|known| known.link.as_ref()),
            bias => golden.and_then(|golden| bias(&result, golden, film, case.exposure)),
            seconds => evidence.rendering_seconds.map(|it| format!("{it:.2}")),
            reason => result.reason,
            lists => [&result.conventions, &result.difference, &changes, &result.notes],
            profile => result.profile,
            picture => image.as_ref().map(|(image, _)| small(image)),
            difference => image.as_ref().and_then(|(_, of)| Some(of.as_ref()?.picture(scale))),
        };
        Some(Cell {
            mark,
            shown,
            result,
        })
    };
    GalleryRow {
        name: case.name.clone(),
        head: context! {
            name => case.name,
            parts => case.name.split('/').collect::<Vec<_>>(),
            trouble,
            golden => golden.as_ref().map(small),
            scale => differences().next().map(|_| format!("{scale:.0}")),
        },
        cells: judged.into_iter().zip(&images).map(cell).collect(),
    }
}

const TEMPLATE: Template = Template {
    blocks: include_str!("gallery/template.html"),
    style: include_str!("gallery/page.css"),
    script: include_str!("gallery/page.js"),
};

/// The page as a complete HTML file. It loads nothing else and works from `file://`. The rows are in the order of the
/// `families`.
pub(crate) fn gallery_html(
    renderers: &[GalleryRenderer],
    families: &[Family<'_>],
    rows: &[GalleryRow],
) -> String {
    let all = rows.iter().flat_map(|row| row.cells.iter().flatten());
    let colours = (0..=16).map(|step| {
        let [red, green, blue] = blue_to_red(f64::from(step) / 8.0 - 1.0);
        format!("rgb({red} {green} {blue})")
    });
    let page = Page {
        renderers,
        families,
        rows,
    };
    let (path_tracers, ray_casters): (Vec<usize>, _) =
        (0..renderers.len()).partition(|renderer| page.is_path_tracer(*renderer));
    let groups = [
        ("ray-casters", "Ray casters", ray_casters),
        ("path-tracers", "Path tracers", path_tracers),
    ];
    let groups = groups
        .into_iter()
        .filter(|(.., columns)| !columns.is_empty());
    let groups: Vec<_> = groups.map(|group| (page.drawn(&group.2), group)).collect();
    let marks = groups.iter().flat_map(|(rows, (.., columns))| {
        let cells =
            move |row: &&GalleryRow| columns.iter().map(|at| row.mark(*at)).collect::<Vec<_>>();
        rows.iter().flat_map(cells)
    });
    let shown = groups
        .iter()
        .map(|(rows, (id, title, columns))| page.group(id, title, columns, rows));
    let renderer = |(at, of): (usize, &GalleryRenderer)| page.renderer(at, of);
    rendered(
        &TEMPLATE,
        context! {
            images => all.filter(|cell| cell.mark.is_compared()).count(),
            cases => rows.len(),
            legend => legend(marks),
            renderers => renderers.iter().enumerate().map(renderer).collect::<Vec<_>>(),
            groups => shown.collect::<Vec<_>>(),
            colours => colours.collect::<Vec<_>>().join(", "),
        },
    )
}

struct Page<'p> {
    renderers: &'p [GalleryRenderer],
    families: &'p [Family<'p>],
    rows: &'p [GalleryRow],
}

impl Page<'_> {
    /// The cells of a renderer with their rows.
    fn cells(&self, renderer: usize) -> impl Iterator<Item = (&GalleryRow, &Cell)> {
        let rows = self.rows.iter();
        rows.filter_map(move |row| Some((row, row.cells[renderer].as_ref()?)))
    }

    /// True of a renderer that drew an image of a scene with noise.
    fn is_path_tracer(&self, renderer: usize) -> bool {
        let is_noisy = |cell: &Cell| cell.mark.is_judged() && cell.result.class == "stochastic";
        self.cells(renderer).any(|(_, cell)| is_noisy(cell))
    }

    /// A renderer, with what is wrong with its images: one cause with all the cases that have it.
    fn renderer(&self, at: usize, of: &GalleryRenderer) -> Value {
        let count =
            |is: fn(&Mark) -> bool| self.cells(at).filter(|(_, cell)| is(cell.mark)).count();
        let mut causes: Vec<(Value, Vec<Value>)> = Vec::new();
        for (row, cell) in self.cells(at).filter(|(_, cell)| cell.mark.is_wrong()) {
            let known = cell.result.known.as_ref();
            let cause = context! {
                mark => cell.mark.shown(),
                words => known.and_then(|known| known.reason.clone()),
                link => known.and_then(|known| known.link.clone()),
            };
            let case = context! { name => row.name, address => address(of, row) };
            match causes.iter_mut().find(|(other, _)| *other == cause) {
                Some((_, cases)) => cases.push(case),
                None => causes.push((cause, vec![case])),
            }
        }
        let causes = causes.into_iter();
        let causes = causes.map(|(cause, cases)| context! { cases => cases, ..cause });
        context! {
            name => of.name(),
            version => of.about.version,
            date => of.about.date,
            command => of.about.command,
            machine => of.about.machine,
            profile => of.profile,
            is_judged_again => of.about.as_judged != Some(false),
            judged => count(Mark::is_judged),
            right => count(Mark::is_right),
            causes => causes.collect::<Vec<_>>(),
            seconds => median(of.seconds.values().copied()).map(|it| format!("{it:.2}")),
        }
    }

    /// The rows of which at least one of the renderers has an image.
    fn drawn(&self, renderers: &[usize]) -> Vec<&GalleryRow> {
        let is_drawn = |row: &&GalleryRow| renderers.iter().any(|at| row.mark(*at).is_judged());
        self.rows.iter().filter(is_drawn).collect()
    }

    /// Renderers that are asked the same cases, and the rows of these.
    fn group(&self, id: &str, title: &str, columns: &[usize], rows: &[&GalleryRow]) -> Value {
        let of_family = |family: &Family<'_>| -> Vec<&str> {
            let names = rows.iter().map(|row| &*row.name);
            let is_of_family = |name: &&str| family.cases.iter().any(|case| case.name == *name);
            names.filter(is_of_family).collect()
        };
        let begins = self.families.iter();
        let begins: Vec<&str> = begins
            .filter_map(|it| of_family(it).first().copied())
            .collect();
        let families = self.families.iter().map(|family| {
            let cases = of_family(family).len();
            context! { name => family.name, asks => family.asks, cases => cases }
        });
        let row = |row: &&GalleryRow| {
            let cell = |at: &usize| {
                let cell = row.cells[*at].as_ref();
                let address = address(&self.renderers[*at], row);
                let column = *at;
                let shown = cell.map(|cell| cell.shown.clone()).unwrap_or_default();
                context! { column => column, address => address, mark => row.mark(*at).shown(), ..shown }
            };
            let cells: Vec<Value> = columns.iter().map(cell).collect();
            context! { cells => cells, is_first => begins.contains(&&*row.name), ..row.head.clone() }
        };
        context! {
            id => id,
            title => title,
            columns => columns,
            families => families.collect::<Vec<_>>(),
            rows => rows.iter().map(row).collect::<Vec<_>>(),
        }
    }
}

/// The address of a cell within the page.
fn address(renderer: &GalleryRenderer, row: &GalleryRow) -> String {
    let name = format!("{}/{}", renderer.name(), row.name);
    name.replace(char::is_whitespace, "-")
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
