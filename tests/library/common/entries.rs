//! Questions with known answers: the entries of `fixtures/known-answers/*.json`.

use glam::DVec3;
use serde_json::Value;

/// One question of a file, with what is needed to say which number is wrong.
pub struct Entry(pub Value);

impl Entry {
    pub fn all(text: &str) -> Vec<Entry> {
        let mut file: Value = serde_json::from_str(text).unwrap();
        let Value::Array(entries) = file["entries"].take() else {
            panic!("no entries")
        };
        entries.into_iter().map(Entry).collect()
    }

    pub fn id(&self) -> &str {
        self.0["id"].as_str().unwrap()
    }

    /// A seed for one use of this entry, another for each: entries are sampled independently.
    pub fn seed(&self, purpose: u64) -> u64 {
        let digits = self.id().trim_start_matches(|c: char| !c.is_ascii_digit());
        let number: u64 = digits.parse().unwrap();
        purpose << 32 | number
    }

    pub fn case(&self) -> &str {
        self.text("case")
    }

    pub fn text(&self, name: &str) -> &str {
        self.0["inputs"][name].as_str().unwrap()
    }

    pub fn input(&self, name: &str) -> f64 {
        self.given(name).unwrap_or_else(|| panic!("no {name}"))
    }

    /// An input that not every entry has.
    pub fn given(&self, name: &str) -> Option<f64> {
        self.0["inputs"][name].as_f64()
    }

    pub fn inputs(&self, name: &str) -> Vec<f64> {
        numbers(&self.0["inputs"][name])
    }

    pub fn vector(&self, name: &str) -> DVec3 {
        DVec3::from_slice(&self.inputs(name))
    }

    pub fn expected(&self, name: &str) -> f64 {
        self.answer(name).unwrap_or_else(|| panic!("no {name}"))
    }

    /// An answer that not every entry has.
    pub fn answer(&self, name: &str) -> Option<f64> {
        self.0["expected"][name].as_f64()
    }

    pub fn answers(&self, name: &str) -> Vec<f64> {
        numbers(&self.0["expected"][name])
    }

    /// The relative error up to which an answer is to be trusted.
    pub fn digits(&self) -> f64 {
        let digits = self.0["digits"].as_u64().unwrap();
        format!("1e-{digits}").parse().unwrap()
    }

    #[track_caller]
    pub fn is(&self, name: &str, found: f64) {
        self.is_within(name, found, 0.0);
    }

    /// To the entry's digits, or to `absolute` where that allows more.
    #[track_caller]
    pub fn is_within(&self, name: &str, found: f64, absolute: f64) {
        self.compare(name, found, self.expected(name), absolute);
    }

    #[track_caller]
    pub fn are(&self, name: &str, found: impl IntoIterator<Item = f64>) {
        let expected = self.answers(name);
        let found: Vec<f64> = found.into_iter().collect();
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.into_iter().zip(expected) {
            self.compare(name, found, expected, 0.0);
        }
    }

    #[track_caller]
    pub fn compare(&self, name: &str, found: f64, expected: f64, absolute: f64) {
        let magnitude = if expected == 0.0 { 1.0 } else { expected.abs() };
        let tolerance = (self.digits() * magnitude).max(absolute);
        let error = (found - expected).abs();
        assert!(
            error <= tolerance,
            "{} {name}: {found:e} is not {expected:e}, {} of the tolerance",
            self.id(),
            error / tolerance
        );
    }
}

pub fn numbers(value: &Value) -> Vec<f64> {
    let numbers = value.as_array().unwrap().iter();
    numbers.map(|number| number.as_f64().unwrap()).collect()
}
