//! The judge: what is said of an image with a fault, against the truth.

use super::faults::{Fault, Kind};
use volref::judging::{CaseResult, Verdict};
use volref::scene::Scene;
use volref::sensitivity::numbers;

/// Whether a name or a description is given, and right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Said {
    Nothing,
    Rightly,
    Wrongly,
}

impl Said {
    /// Of statements that are right or not: one that is wrong is what people follow.
    fn of(statements: &[bool]) -> Said {
        match statements {
            [] => Said::Nothing,
            all if all.iter().all(|&right| right) => Said::Rightly,
            _ => Said::Wrongly,
        }
    }
}

/// The judgement on a verdict.
pub struct Judgement {
    pub verdict: Verdict,
    /// Mistakes or conventions.
    pub named: Said,
    /// Sentences.
    pub described: Said,
    /// For each interval whether it holds the truth within two standard errors.
    pub intervals: Vec<bool>,
    /// True if something was measured of the difference: its place, or what a change would leave of it.
    pub is_measured: bool,
    /// Names, reason, measurements.
    pub text: String,
}

/// Words of a sentence that asserts something, with its label in [`Fault::truth`].
pub const CLAIMS: &[(&str, &str)] = &[("a NaN replaced by 0", "black")];

/// Words of measurements, true of any image; where the label is in [`Fault::truth`], they tell the fault.
const MEASUREMENTS: &[(&str, &str)] = &[
    ("the golden times", "gain"),
    ("of the squared relative difference is in", "channel"),
    ("relative difference lies in columns", "place"),
    ("pixels are black", "black"),
    ("pixel is black", "black"),
    ("noise that is stated", "noise"),
    ("stated variance", "noise"),
];

/// Largest error of a change, as a share of it, with which a sentence still describes the fault; its
/// interval is judged by itself.
const NEAR: f64 = 0.1;

/// The same for a change that is "about" so large.
const ROUGH: f64 = 0.5;

/// Words of a map from the golden to the image, which the gate has found to hold.
const MAP: &str = "the image is the golden";

/// Sentences that say that nothing was measured.
const NOTHING: [&str; 2] = [
    "no gain and no shift by a pixel or less accounts",
    "no single mistake that was tried",
];

/// Words of a change that leaves no more than noise, in images of too much of it to tell if it is the cause.
const IN_NOISE: &str = "as far as the noise tells";

/// Words of a sentence that asserts nothing of what follows them.
const HEDGES: &[&str] = &[
    "as if",
    "close to",
    IN_NOISE,
    "too large for derivatives",
    "no small change of a number",
];

/// Numbers of a case that change its image alike: of its only source of light, of its only medium that
/// absorbs or scatters.
const ALIKE: &[(&str, &str, &str)] = &[
    ("smoke/cornell", "exposure", "lamp"),
    ("smoke/cornell", "sigma_a", "density.1"),
    ("smoke/cornell", "sigma_s", "density.2"),
    ("smoke/cornell", "g", "g.2"),
    ("fog/forward", "exposure", "light"),
    ("fog/spotlight", "exposure", "light"),
    ("fog/rate-0.1", "exposure", "lamp"),
    ("fog/absorption", "exposure", "lamp"),
    ("fog/dense-body", "exposure", "light"),
    ("procedural/absorbing-grid", "exposure", "environment"),
];

/// Names and words of numbers that values of images have.
const OF_VALUES: [(&str, &str); 6] = [
    ("exposure", "exposure"),
    ("gain.red", "gain of red"),
    ("gain.green", "gain of green"),
    ("gain.blue", "gain of blue"),
    ("offset", "offset of all values"),
    ("gamma", "exponent of all values"),
];

/// A change that a sentence states: name of the number, size, and error unless it is "about" so large.
type Claim = (String, f64, Option<f64>);

/// The changes in `sentence`: `density 2.1 ± 0.3 % too large`, `g off by −0.1 ± 0.02`.
fn changes(sentence: &str, numbers: &[(String, String)]) -> Vec<Claim> {
    let mut found = Vec::new();
    for (name, words) in numbers {
        for (at, _) in sentence.match_indices(words.as_str()) {
            let is_word = !sentence[..at].ends_with(char::is_alphanumeric);
            let after = sentence[at + words.len()..].strip_prefix(' ');
            if let Some((size, error)) = after.filter(|_| is_word).and_then(change) {
                found.push((at, (name.clone(), size, error)));
            }
        }
    }
    found.sort_by_key(|(at, _)| *at);
    found.into_iter().map(|(_, claim)| claim).collect()
}

/// `2.1 ± 0.3 % too small…`, `about 2 % too small…`, `off by −0.1 ± 0.02…` or `off by about −0.1…`.
fn change(text: &str) -> Option<(f64, Option<f64>)> {
    let absolute = text.strip_prefix("off by ");
    let text = absolute.unwrap_or(text);
    let rough = text.strip_prefix("about ");
    let words = rough.unwrap_or(text).split([' ', ',', ';', ')']);
    let mut words = words.filter(|word| !word.is_empty());
    let size: f64 = words.next()?.replace('−', "-").parse().ok()?;
    let mut error = None;
    if rough.is_none() {
        (words.next()? == "±").then_some(())?;
        error = Some(words.next()?.trim_end_matches('.').parse::<f64>().ok()?);
    }
    if absolute.is_some() {
        return Some((size, error));
    }
    (words.next()? == "%" && words.next()? == "too").then_some(())?;
    let is_small = words.next()?.starts_with("small");
    let side = if is_small { -0.01 } else { 0.01 };
    Some((side * size, error.map(|error| 0.01 * error)))
}

/// The sentences of a text that assert something.
fn assertions(text: &str) -> impl Iterator<Item = &str> {
    let sentences = text.split(". ").flat_map(|sentence| sentence.split('\n'));
    sentences.map(|sentence| {
        let hedges = HEDGES.iter().filter_map(|words| sentence.find(words));
        &sentence[..hedges.min().unwrap_or(sentence.len())]
    })
}

impl Fault {
    fn is(&self, label: &str) -> bool {
        self.truth.iter().any(|it| it == label)
    }

    /// The true change of the number of that name.
    fn change(&self, number: &str) -> Option<f64> {
        let is = |name: &str| {
            let mut alike = ALIKE.iter().filter(|it| it.0 == self.case);
            name == number
                || alike.any(|it| [(name, number), (number, name)].contains(&(it.1, it.2)))
        };
        let mut stated = self.truth.iter().filter_map(|it| it.split_once(' '));
        stated.find_map(|(name, change)| change.parse().ok().filter(|_| is(name)))
    }
}

/// Judges what `result` says of an image with `fault`.
pub fn judge(fault: &Fault, scene: &Scene, result: &CaseResult) -> Judgement {
    let mut named = Vec::new();
    named.extend(result.looks_like.first().map(|name| fault.is(name)));
    if result.verdict == Verdict::Convention {
        let is_true = |said: &String| fault.truth.iter().any(|words| said.contains(words));
        named.push(result.conventions.iter().all(is_true));
    }
    let of_scene = numbers(scene).into_iter();
    let of_scene = of_scene.map(|number| (number.name(), number.words()));
    let of_values = OF_VALUES.map(|(name, words)| (name.to_owned(), words.to_owned()));
    let all: Vec<(String, String)> = of_scene.chain(of_values).collect();
    let mut intervals = Vec::new();
    let mut is_right = |(number, size, error): &Claim| {
        let Some(change) = fault.change(number) else {
            return false;
        };
        let off = (change - size).abs();
        let Some(error) = error else {
            return off <= ROUGH * change.abs();
        };
        intervals.push(off <= 2.0 * error);
        off <= 2.0 * error || off <= NEAR * change.abs()
    };
    let texts = std::iter::once(&result.reason).chain(&result.difference);
    let texts: Vec<&str> = texts.flat_map(|text| assertions(text)).collect();
    let mut statements = Vec::new();
    for sentence in &texts {
        // What an image cannot tell from another change asserts one of them.
        let alternatives = sentence.split("; this image cannot tell it from ");
        let alternatives = alternatives.flat_map(|part| part.split(", or "));
        let claims = alternatives.map(|part| changes(part, &all));
        let claims = claims.filter(|claims| !claims.is_empty());
        let right: Vec<bool> = claims
            .map(|claims| {
                // All of them, for their intervals.
                let right: Vec<bool> = claims.iter().map(&mut is_right).collect();
                !right.contains(&false)
            })
            .collect();
        if !right.is_empty() {
            statements.push(right.contains(&true));
        }
    }
    statements.extend(texts.iter().filter(|text| text.contains(MAP)).map(|_| true));
    let is_said = |words: &str| texts.iter().any(|text| text.contains(words));
    let claims = CLAIMS.iter().filter(|(words, _)| is_said(words));
    statements.extend(claims.map(|(_, label)| fault.is(label)));
    let tells = |(words, label): &&(&str, &str)| is_said(words) && fault.is(label);
    statements.extend(MEASUREMENTS.iter().filter(tells).map(|_| true));
    let names = [&result.looks_like[..], &result.conventions].concat();
    let reason = std::slice::from_ref(&result.reason);
    let said = [reason, &result.difference, &result.notes].concat();
    let is_nothing = |said: &String| NOTHING.iter().any(|words| said.contains(words));
    let mut judgement = Judgement {
        verdict: result.verdict,
        is_measured: result.reason.contains(IN_NOISE) || !result.difference.iter().all(is_nothing),
        named: Said::of(&named),
        described: Said::of(&statements),
        intervals,
        text: format!(
            "{}\n        {}",
            names.join(", or "),
            said.join("\n        ")
        ),
    };
    if !judgement.is_caught() {
        (judgement.named, judgement.described) = (Said::Nothing, Said::Nothing);
        judgement.intervals.clear();
    }
    judgement
}

impl Judgement {
    pub fn is_caught(&self) -> bool {
        matches!(self.verdict, Verdict::Fail | Verdict::Convention)
    }

    /// Neither a name nor a description.
    fn is_open(&self) -> bool {
        self.is_caught() && self.named == Said::Nothing && self.described == Said::Nothing
    }

    fn held(&self) -> usize {
        self.intervals.iter().filter(|&&holds| holds).count()
    }

    /// One line: verdict, name, description, intervals.
    pub fn in_words(&self) -> String {
        format!(
            "{}; named {:?}; described {:?}; {} of {} intervals",
            self.verdict.name(),
            self.named,
            self.described,
            self.held(),
            self.intervals.len()
        )
    }
}

/// A column of the table, and whether a judgement counts in it.
type Column = (&'static str, fn(&Judgement) -> bool);

/// Columns of the table.
const COLUMNS: [Column; 10] = [
    ("images", |_| true),
    ("caught", Judgement::is_caught),
    ("passed", |it| it.verdict == Verdict::Pass),
    ("undecided", |it| it.verdict == Verdict::Inconclusive),
    ("named rightly", |it| it.named == Said::Rightly),
    ("named wrongly", |it| it.named == Said::Wrongly),
    ("described rightly", |it| it.described == Said::Rightly),
    ("described wrongly", |it| it.described == Said::Wrongly),
    ("measured", |it| it.is_open() && it.is_measured),
    ("silent", |it| it.is_open() && !it.is_measured),
];

/// The table in Markdown, by kind of fault.
pub fn table(judged: &[(Kind, Judgement)]) -> String {
    let heads = COLUMNS.map(|(words, _)| words).join(" | ");
    let mut text = format!(
        "| fault | {heads} | intervals that hold |\n|{}\n",
        " --- |".repeat(12)
    );
    let mut kinds: Vec<Kind> = judged.iter().map(|(kind, _)| *kind).collect();
    kinds.sort();
    kinds.dedup();
    for kind in kinds.into_iter().map(Some).chain([None]) {
        let of = judged
            .iter()
            .filter(|(of, _)| kind.is_none_or(|kind| kind == *of));
        let of: Vec<&Judgement> = of.map(|(_, it)| it).collect();
        let counts = COLUMNS.map(|(_, is)| of.iter().filter(|it| is(it)).count().to_string());
        let words = kind.map_or("all".to_owned(), |kind| format!("{kind:?}"));
        let held: usize = of.iter().map(|it| it.held()).sum();
        let stated: usize = of.iter().map(|it| it.intervals.len()).sum();
        text += &format!(
            "| {words} | {} | {held} of {stated} |\n",
            counts.join(" | ")
        );
    }
    text
}

#[test]
fn changes_are_read_from_sentences() {
    let numbers = [
        ("density", "density"),
        ("density.1", "density of medium 1"),
        ("g", "g of the phase function"),
    ];
    let numbers = numbers.map(|(name, words)| (name.to_owned(), words.to_owned()));
    let of = |number: &str, change, error| (number.to_owned(), change, Some(error));
    let two = "looks like this: density 10.0 ± 0.5 % too large; and g of the phase function off by −0.10 ± 0.02 (8 standard errors)";
    for (sentence, expected) in [
        (
            "density of medium 1 10.0 ± 0.5 % too small",
            vec![of("density.1", -0.1, 0.005)],
        ),
        (two, vec![of("density", 0.1, 0.005), of("g", -0.1, 0.02)]),
        ("the density of the fog", vec![]),
    ] {
        assert_eq!(changes(sentence, &numbers), expected, "{sentence}");
    }
    let hedged = "it differs. The difference is as if this were so: density 10.0 ± 0.5 % too large";
    assert!(assertions(hedged).all(|sentence| changes(sentence, &numbers).is_empty()));
}
