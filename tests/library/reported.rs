//! Public reports of wrong volume images: the table of `src/guide/reported.md`, held row by row. The
//! fault of a row is made in its case, and what is said of the image is what the row says.

use crate::common::simulated::edited;
use crate::common::suite::{
    case_of, cases_of, explained, film_with, root, silent, suite, uninterrupted, validated,
};
use std::time::Duration;

use rayon::prelude::*;
use toml::{Table, Value};
use volref::film::Film;
use volref::judging::{CaseResult, Verdict};
use volref::naming::{ConventionSearch, Predictions};
use volref::scene::Scene;
use volref::suite::Case;
use volref::variations::mistakes;

const PAGE: &str = "src/guide/reported.md";

/// Seconds of search for conventions and for mistakes behind an image: more than any row takes.
const SECONDS: f64 = 60.0;

/// Samples per pixel of a faulty image, where there are any.
const SAMPLES: u32 = 256;

/// An edit of an image.
type Edit = fn(&Film) -> Film;

/// Faults that are edits of the image, by their words in the table.
const EDITS: [(&str, Edit); 3] = [
    ("a pixel in 50 is NaN", |film| {
        let pixel = |at: usize, of: [f32; 3]| if at % 50 == 7 { [f32::NAN; 3] } else { of };
        by_pixel(film, pixel)
    }),
    ("black beside the medium", |film| {
        let white = |of: &[f32; 3]| of.iter().all(|value| (value - 1.0).abs() < 1e-6);
        by_pixel(film, |_, of| if white(&of) { [0.0; 3] } else { of })
    }),
    ("floating point of 11, 11 and 10 bits, cut", |film| {
        by_pixel(film, |_, [r, g, b]| [cut(r, 6), cut(g, 6), cut(b, 5)])
    }),
];

fn by_pixel(film: &Film, edit: impl Fn(usize, [f32; 3]) -> [f32; 3]) -> Film {
    edited(&silent(film), |x, y, of| edit(x + film.width() * y, of))
}

/// With so many bits behind the point of its mantissa, the others cut off.
fn cut(value: f32, bits: u32) -> f32 {
    f32::from_bits(value.to_bits() & (u32::MAX << (23 - bits)))
}

/// A row of the table.
struct Report {
    /// Links, symptom and cause.
    words: String,
    case: String,
    /// Parts of the fault: a mistake, an edit of the image, or `key = value` in the scene.
    faults: Vec<String>,
    /// The answer of volref, or why there is none.
    told: String,
}

/// Parts of a text between backticks.
fn quoted(text: &str) -> Vec<String> {
    text.split('`')
        .skip(1)
        .step_by(2)
        .map(str::to_owned)
        .collect()
}

fn reports() -> Vec<Report> {
    let page = std::fs::read_to_string(root().join(PAGE)).unwrap();
    let rows = page.lines().filter(|line| line.starts_with("| ["));
    let report = |line: &str| {
        let cells: Vec<&str> = line.trim_matches('|').split(" | ").map(str::trim).collect();
        let [links, symptom, case, fault, told] = cells[..] else {
            panic!("a row has five cells: {line}");
        };
        Report {
            words: format!("{links}: {symptom}"),
            case: quoted(case).into_iter().next().unwrap_or_default(),
            faults: quoted(fault),
            told: told.to_owned(),
        }
    };
    rows.map(report).collect()
}

/// Sets `key`, such as `radiative.light.1.point.intensity`, to `value` in a scene.
fn set(table: &mut Table, key: &str, value: Value) {
    let (first, rest) = key.split_once('.').unwrap_or((key, ""));
    if rest.is_empty() {
        table.insert(first.to_owned(), value);
        return;
    }
    let inner = table.entry(first).or_insert_with(|| Table::new().into());
    match (inner, rest.split_once('.')) {
        (Value::Table(inner), _) => set(inner, rest, value),
        (Value::Array(items), Some((index, rest))) => {
            let item = &mut items[index.parse::<usize>().unwrap()];
            set(item.as_table_mut().unwrap(), rest, value);
        }
        _ => panic!("{key} is no table"),
    }
}

/// The image of the case with the fault of `report`.
fn faulty(report: &Report, case: &Case) -> Film {
    let mut table: Table = std::fs::read_to_string(&case.scene)
        .unwrap()
        .parse()
        .unwrap();
    for assignment in report.faults.iter().filter(|fault| fault.contains(" = ")) {
        let (key, value) = assignment.split_once(" = ").unwrap();
        let value: Table = format!("value = {value}").parse().unwrap();
        set(&mut table, key, value["value"].clone());
    }
    let text = toml::to_string(&table).unwrap();
    let mut scene = Scene::parse(&text, &case.scene).unwrap();
    let named = |fault: &&String| mistakes::named(fault);
    let mistakes: Vec<_> = report
        .faults
        .iter()
        .filter_map(|fault| named(&fault))
        .collect();
    for mistake in mistakes.iter().filter(|mistake| !mistake.is_of_the_image()) {
        scene = mistake
            .in_scene(&scene)
            .expect("the case has occasion for it");
    }
    let mut film = film_with(&scene, SAMPLES, 0x7265_706f_7274);
    for mistake in mistakes.iter().filter(|mistake| mistake.is_of_the_image()) {
        film = mistake
            .in_image(&film)
            .expect("the image has occasion for it");
    }
    for (_, edit) in EDITS
        .iter()
        .filter(|(words, _)| report.faults.iter().any(|it| it == words))
    {
        film = edit(&film);
    }
    film
}

/// The answer to an image of `case`.
fn answer(case: &Case, film: Film, predictions: &Predictions) -> CaseResult {
    let mut judged = validated(case, film);
    let search = ConventionSearch::default();
    search.explain_mismatch(case, &suite().store(), &mut judged, SECONDS, false);
    let budget = Some(Duration::from_secs_f64(SECONDS));
    explained(case, judged, &uninterrupted(budget, predictions))
}

/// True if the answer is the one of the row.
fn is_told(report: &Report, result: &CaseResult) -> bool {
    let is_caught = matches!(result.verdict, Verdict::Fail | Verdict::Convention);
    let texts = [
        std::slice::from_ref(&result.reason),
        &result.difference,
        &result.conventions,
        &result.notes,
    ]
    .concat();
    let is_named = result.looks_like.first() == Some(&report.faults.join(" + "));
    let sentences: Vec<&str> = report.told.split(['“', '”']).skip(1).step_by(2).collect();
    let is_said = |words: &&str| texts.iter().any(|text| text.contains(*words));
    let are_said = !sentences.is_empty() && sentences.iter().all(is_said);
    is_caught
        && match report.told.split([' ', ':']).next() {
            Some("named") => is_named,
            Some("described" | "caught") => are_said,
            Some("convention") => result.verdict == Verdict::Convention && are_said,
            _ => false,
        }
}

#[test]
fn every_report_is_told() {
    let predictions = Predictions::default();
    let reports = reports();
    let wanted = std::env::var("VOLREF_REPORT").unwrap_or_default();
    let (open, made): (Vec<_>, Vec<_>) = reports
        .iter()
        .filter(|report| report.words.contains(&wanted))
        .partition(|report| report.told.starts_with("not yet"));
    let judge = |report: &&Report| {
        let case = case_of(&report.case);
        let begun = std::time::Instant::now();
        let result = answer(case, faulty(report, case), &predictions);
        let is_told = is_told(report, &result);
        let Report {
            words,
            case,
            faults,
            told,
        } = *report;
        println!(
            "{} {words}\n  {case}, {faults:?}, {:.1} s\n  {told}\n  {:?} {:?} {:?}\n  {}\n  {}",
            if is_told { "ok" } else { "WRONG" },
            begun.elapsed().as_secs_f64(),
            result.verdict,
            result.looks_like,
            result.conventions,
            result.reason,
            result.difference.join("\n  ")
        );
        (!is_told).then(|| words.clone())
    };
    let wrong: Vec<_> = made.par_iter().with_max_len(1).filter_map(judge).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(!wanted.is_empty() || open.len() < 6 && made.len() > 60);
}

/// Links stand in the manifests of the cases, too.
#[test]
fn manifests_of_reported_cases_have_the_links() {
    let reports = reports();
    for case in cases_of("reported") {
        let of_case: Vec<_> = reports.iter().filter(|it| it.case == case.name).collect();
        assert!(!of_case.is_empty(), "{} has no row", case.name);
        for report in of_case {
            let links = report
                .words
                .split(['(', ')'])
                .filter_map(|it| it.strip_prefix("https://"));
            for link in links {
                assert!(case.source.contains(link), "{}: {link}", case.name);
            }
        }
    }
}
