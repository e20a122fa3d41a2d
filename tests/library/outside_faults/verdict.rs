//! The judge: what is said of an image with a fault, against the truth.

use super::faults::{Fault, Kind, Truth};
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
    /// Of intervals for numbers that are off, whether each holds the truth within two standard errors.
    pub intervals: Vec<bool>,
    /// True if something was measured of the difference: its place, or what a change would leave of it.
    pub is_measured: bool,
    /// Names, reason, measurements.
    pub text: String,
}

/// Words of a sentence that asserts something, with its label in [`Truth::words`].
pub const CLAIMS: &[(&str, &str)] = &[
    ("they look cut off there", "cut off"),
    ("a NaN replaced by 0", "black"),
];

/// Largest error of a change, as a share of it, with which a sentence still describes the fault; its interval is
/// judged by itself.
const NEAR: f64 = 0.1;

/// Likewise of a change that is "about" so large.
const ROUGH: f64 = 0.5;

/// Words of a map from the golden to the image, which the gate has found to hold.
const MAP: &str = "the image is the golden";

/// Sentences that say that nothing was measured.
const NOTHING: [&str; 1] = ["noise hides the difference"];

/// Words of measurements, true of any image; where the label is in [`Truth::words`], they tell the fault.
const MEASUREMENTS: &[(&str, &str)] = &[
    ("the golden times", "gain"),
    ("of the squared relative difference is in", "channel"),
    ("relative difference lies in columns", "place"),
    ("exactly 0 among neighbours", "black"),
    ("pixels are black", "black"),
    ("pixel is black", "black"),
    ("noise that is stated", "noise"),
    ("stated variance", "noise"),
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
const ALIKE: &[(&str, [&str; 2])] = &[
    ("smoke/cornell", ["exposure", "lamp"]),
    ("smoke/cornell", ["sigma_a", "density.1"]),
    ("smoke/cornell", ["sigma_s", "density.2"]),
    ("smoke/cornell", ["g", "g.2"]),
    ("fog/forward", ["exposure", "light"]),
    ("fog/spotlight", ["exposure", "light"]),
    ("fog/rate-0.1", ["exposure", "lamp"]),
    ("fog/absorption", ["exposure", "lamp"]),
    ("fog/rate-0.3", ["exposure", "lamp"]),
    ("fog/heterogeneous", ["exposure", "light"]),
    ("fog/dense-body", ["exposure", "light"]),
    ("procedural/absorbing-grid", ["exposure", "environment"]),
    ("procedural/emissive-grid", ["exposure", "emission"]),
];

/// Names and words of the numbers of `scene`, and of the values of images.
fn all_numbers(scene: &Scene) -> Vec<(String, String)> {
    let of_scene = numbers(scene).into_iter();
    let of_scene = of_scene.map(|number| (number.name(), number.words()));
    let of_values = [
        ("exposure", "exposure"),
        ("gain.red", "gain of red"),
        ("gain.green", "gain of green"),
        ("gain.blue", "gain of blue"),
        ("offset", "offset of all values"),
        ("gamma", "exponent of all values"),
    ];
    let of_values = of_values.map(|(name, words)| (name.to_owned(), words.to_owned()));
    of_scene.chain(of_values).collect()
}

/// A change that a sentence states.
#[derive(Debug, PartialEq)]
struct Claim {
    number: String,
    change: f64,
    /// Nothing where the change is "about" so large.
    error: Option<f64>,
}

/// The changes in `sentence`: `density 2.1 ± 0.3 % too large`, `g off by −0.1 ± 0.02`.
fn changes(sentence: &str, numbers: &[(String, String)]) -> Vec<Claim> {
    let mut found = Vec::new();
    for (name, words) in numbers {
        for (at, _) in sentence.match_indices(words.as_str()) {
            let is_word = sentence[..at]
                .chars()
                .next_back()
                .is_none_or(|c| !c.is_alphanumeric());
            let after = sentence[at + words.len()..].strip_prefix(' ');
            if let Some(after) = after.filter(|_| is_word)
                && let Some((change, error)) = change(after)
            {
                found.push((
                    at,
                    Claim {
                        number: name.clone(),
                        change,
                        error,
                    },
                ));
            }
        }
    }
    found.sort_by_key(|(at, _)| *at);
    found.into_iter().map(|(_, claim)| claim).collect()
}

/// `2.1 ± 0.3 % too small…`, `about 2 % too small…`, `off by −0.1 ± 0.02…` or `off by about −0.1…`.
fn change(text: &str) -> Option<(f64, Option<f64>)> {
    let (is_absolute, text) = match text.strip_prefix("off by ") {
        Some(text) => (true, text),
        None => (false, text),
    };
    let (is_rough, text) = match text.strip_prefix("about ") {
        Some(text) => (true, text),
        None => (false, text),
    };
    let mut words = text
        .split([' ', ',', ';', ')'])
        .filter(|word| !word.is_empty());
    let size: f64 = words.next()?.replace('−', "-").parse().ok()?;
    let mut error = None;
    if !is_rough {
        (words.next()? == "±").then_some(())?;
        error = Some(words.next()?.trim_end_matches('.').parse().ok()?);
    }
    if is_absolute {
        return Some((size, error));
    }
    (words.next()? == "%" && words.next()? == "too").then_some(())?;
    let side = if words.next()?.starts_with("small") {
        -0.01
    } else {
        0.01
    };
    Some((side * size, error.map(|error: f64| 0.01 * error)))
}

/// The sentences of a text that assert something.
fn assertions(text: &str) -> impl Iterator<Item = &str> {
    let sentences = text.split(". ").flat_map(|sentence| sentence.split('\n'));
    sentences.map(|sentence| {
        let hedges = HEDGES.iter().filter_map(|words| sentence.find(words));
        &sentence[..hedges.min().unwrap_or(sentence.len())]
    })
}

impl Truth {
    /// The true change of the number of that name.
    fn change(&self, case: &str, number: &str) -> Option<f64> {
        let is = |name: &str, of: &str| {
            let mut alike = ALIKE.iter().filter(|(it, _)| *it == case);
            name == of || alike.any(|(_, two)| two.contains(&name) && two.contains(&of))
        };
        let known = self.numbers.iter().find(|(name, _)| is(name, number));
        known.map(|(_, change)| *change)
    }
}

/// Judges what `result` says of an image with `fault`.
pub fn judge(fault: &Fault, scene: &Scene, result: &CaseResult) -> Judgement {
    let truth = &fault.truth;
    let mut named = Vec::new();
    if let Some(name) = result.looks_like.first() {
        named.push(truth.names.contains(name));
    }
    if result.verdict == Verdict::Convention {
        let is_true = |said: &String| truth.conventions.iter().any(|words| said.contains(words));
        named.push(result.conventions.iter().all(is_true));
    }
    let is_caught = matches!(result.verdict, Verdict::Fail | Verdict::Convention);
    let all = all_numbers(scene);
    let (mut statements, mut intervals) = (Vec::new(), Vec::new());
    let mut of_numbers = |claims: &[Claim]| {
        let right = claims.iter().map(|claim| {
            let Some(change) = truth.change(fault.case, &claim.number) else {
                return false;
            };
            let off = (change - claim.change).abs();
            let Some(error) = claim.error else {
                return off <= ROUGH * change.abs();
            };
            intervals.push(off <= 2.0 * error);
            off <= 2.0 * error || off <= NEAR * change.abs()
        });
        let right: Vec<bool> = right.collect();
        right.into_iter().all(|right| right)
    };
    if is_caught {
        let texts: Vec<&str> = std::iter::once(&result.reason)
            .chain(&result.difference)
            .flat_map(|text| assertions(text))
            .collect();
        for sentence in &texts {
            // What an image cannot tell from another change asserts one of them.
            let alternatives = sentence
                .split("; this image cannot tell it from ")
                .flat_map(|part| part.split(", or "));
            let claims: Vec<Vec<Claim>> = alternatives
                .map(|part| changes(part, &all))
                .filter(|claims| !claims.is_empty())
                .collect();
            if !claims.is_empty() {
                let right: Vec<bool> = claims.iter().map(|claims| of_numbers(claims)).collect();
                statements.push(right.contains(&true));
            }
        }
        statements.extend(texts.iter().filter(|text| text.contains(MAP)).map(|_| true));
        let is_said = |words: &str| texts.iter().any(|text| text.contains(words));
        let claims = CLAIMS.iter().filter(|(words, _)| is_said(words));
        statements.extend(claims.map(|(_, label)| truth.words.contains(label)));
        let tells = |(words, label): &(&str, &str)| is_said(words) && truth.words.contains(label);
        statements.extend(MEASUREMENTS.iter().filter(|it| tells(it)).map(|_| true));
    }
    let names = [&result.looks_like[..], &result.conventions]
        .concat()
        .join(", or ");
    let said = [
        std::slice::from_ref(&result.reason),
        &result.difference[..],
        &result.notes,
    ]
    .concat();
    let is_nothing = |said: &&String| NOTHING.iter().any(|words| said.contains(words));
    let is_measured_by_gate = result.reason.contains(IN_NOISE);
    Judgement {
        verdict: result.verdict,
        is_measured: is_measured_by_gate || !result.difference.iter().all(|said| is_nothing(&said)),
        named: if is_caught {
            Said::of(&named)
        } else {
            Said::Nothing
        },
        described: Said::of(&statements),
        intervals,
        text: format!("{names}\n        {}", said.join("\n        ")),
    }
}

impl Judgement {
    pub fn is_caught(&self) -> bool {
        matches!(self.verdict, Verdict::Fail | Verdict::Convention)
    }

    /// Neither a name nor a description.
    fn is_open(&self) -> bool {
        self.is_caught() && self.named == Said::Nothing && self.described == Said::Nothing
    }

    /// Neither a name nor a description, but measurements that are true of the images.
    pub fn is_measured_alone(&self) -> bool {
        self.is_open() && self.is_measured
    }

    /// Nothing beyond the numbers of the gate.
    pub fn is_silent(&self) -> bool {
        self.is_open() && !self.is_measured
    }

    /// One line: verdict, name, description, intervals.
    pub fn in_words(&self) -> String {
        let held = self.intervals.iter().filter(|&&holds| holds).count();
        let outcome = match self.verdict {
            Verdict::Fail | Verdict::Convention => "caught",
            other => other.name(),
        };
        format!(
            "{outcome}; named {:?}; described {:?}; {held} of {} intervals",
            self.named,
            self.described,
            self.intervals.len()
        )
    }
}

/// The table in Markdown, by kind of fault.
pub fn table(judged: &[(Kind, Judgement)]) -> String {
    let mut text = String::from(
        "| fault | images | caught | passed | undecided | named rightly | wrongly | described rightly | wrongly | measured | silent | intervals that hold |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    let kinds = Kind::ALL.map(|(kind, words)| (Some(kind), words));
    for (kind, words) in kinds.into_iter().chain([(None, "all")]) {
        let of: Vec<&Judgement> = judged
            .iter()
            .filter(|(of, _)| kind.is_none_or(|kind| kind == *of))
            .map(|(_, it)| it)
            .collect();
        if of.is_empty() {
            continue;
        }
        let count = |is: &dyn Fn(&Judgement) -> bool| of.iter().filter(|it| is(it)).count();
        let intervals: Vec<bool> = of
            .iter()
            .flat_map(|it| it.intervals.iter().copied())
            .collect();
        let held = intervals.iter().filter(|&&holds| holds).count();
        let counts = [
            of.len(),
            count(&Judgement::is_caught),
            count(&|it| it.verdict == Verdict::Pass),
            count(&|it| it.verdict == Verdict::Inconclusive),
            count(&|it| it.named == Said::Rightly),
            count(&|it| it.named == Said::Wrongly),
            count(&|it| it.described == Said::Rightly),
            count(&|it| it.described == Said::Wrongly),
            count(&Judgement::is_measured_alone),
            count(&Judgement::is_silent),
        ];
        let cells: Vec<String> = counts.iter().map(usize::to_string).collect();
        text.push_str(&format!(
            "| {words} | {} | {held} of {} |\n",
            cells.join(" | "),
            intervals.len()
        ));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_read_from_sentences() {
        let numbers = [
            ("density", "density"),
            ("density.1", "density of medium 1"),
            ("g", "g of the phase function"),
        ];
        let numbers = numbers.map(|(name, words)| (name.to_owned(), words.to_owned()));
        let claim = |number: &str, change, error| Claim {
            number: number.to_owned(),
            change,
            error: Some(error),
        };
        for (sentence, expected) in [
            (
                "density of medium 1 10.0 ± 0.5 % too small",
                vec![claim("density.1", -0.1, 0.005)],
            ),
            (
                "looks like this: density 10.0 ± 0.5 % too large; and g of the phase function off by −0.10 ± 0.02 (8 standard errors)",
                vec![claim("density", 0.1, 0.005), claim("g", -0.1, 0.02)],
            ),
            ("the density of the fog", vec![]),
        ] {
            assert_eq!(changes(sentence, &numbers), expected, "{sentence}");
        }
        let hedged =
            "it differs. The difference is as if this were so: density 10.0 ± 0.5 % too large";
        assert!(assertions(hedged).all(|sentence| changes(sentence, &numbers).is_empty()));
    }
}
