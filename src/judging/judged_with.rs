//! Settings that loosen the judgements of a run, for whoever reads its results.

use super::{CaseResult, Verdict};
use crate::conventions::Profile;
use crate::suite::refusal;
use serde::Serialize;
use std::collections::BTreeMap;

/// Names of the settings that loosen judgements, as runs store them.
const LOOSENING: [&str; 4] = ["accept conventions", "alpha", "bits", "resolution"];

/// Settings of a run that loosen its judgements, and the cases that it did not judge.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct JudgedWith {
    /// Values of the settings, by name; `true` of a flag.
    settings: BTreeMap<String, String>,
    /// Names of the cases that were skipped, for they have no image.
    skipped: Vec<String>,
    /// Names of the cases that the renderer, or a format, cannot express.
    cannot: Vec<String>,
}

impl JudgedWith {
    /// Everything that loosens `results` under the `settings` of a run and a `profile`. `skipped` are the names of cases
    /// without a result, with a reason.
    pub fn of(
        settings: &BTreeMap<String, String>,
        profile: Option<&Profile>,
        skipped: impl IntoIterator<Item = (String, String)>,
        results: &[CaseResult],
    ) -> JudgedWith {
        let given = LOOSENING.iter().filter_map(|name| {
            let value = settings.get(*name).filter(|value| *value != "false")?;
            Some((name.replace(' ', "_"), value.clone()))
        });
        let profile = profile.map(|profile| ("profile".to_owned(), profile.name.clone()));
        let (mut without_image, mut cannot) = (Vec::new(), Vec::new());
        for (name, reason) in skipped {
            match refusal(&reason) {
                Some(_) => cannot.push(name),
                None => without_image.push(name),
            }
        }
        let missing = results
            .iter()
            .filter(|it| it.verdict == Verdict::Missing && refusal(&it.reason).is_some());
        cannot.extend(missing.map(|it| it.name.clone()));
        cannot.sort();
        JudgedWith {
            settings: profile.into_iter().chain(given).collect(),
            skipped: without_image,
            cannot,
        }
    }

    /// Everything that loosens the judgements of any of the runs. A setting with several values has the last one.
    pub fn of_runs(runs: Vec<JudgedWith>) -> JudgedWith {
        let mut all = JudgedWith::default();
        for run in runs {
            all.settings.extend(run.settings);
            all.skipped.extend(run.skipped);
            all.cannot.extend(run.cannot);
        }
        all
    }

    /// In one line, such as `--bits 8, profile vtkjs; 3 skipped, 2 cannot be rendered`; empty where nothing
    /// loosens.
    pub fn in_words(&self) -> String {
        let option = |(name, value): (&String, &String)| match name.as_str() {
            "profile" => format!("profile {value}"),
            name => {
                let option = format!("--{} {value}", name.replace('_', "-"));
                // A flag has no value.
                option.replacen(" true", "", 1)
            }
        };
        let settings: Vec<String> = self.settings.iter().map(option).collect();
        let counts = [
            (self.skipped.len(), "skipped"),
            (self.cannot.len(), "cannot be rendered"),
        ];
        let present = counts.into_iter().filter(|(count, _)| *count > 0);
        let unjudged: Vec<String> = present
            .map(|(count, what)| format!("{count} {what}"))
            .collect();
        let parts = [settings.join(", "), unjudged.join(", ")];
        let parts: Vec<String> = parts.into_iter().filter(|part| !part.is_empty()).collect();
        parts.join("; ")
    }

    /// Names and values, for build servers.
    pub fn properties(&self) -> Vec<(String, String)> {
        let lists = [("skipped", &self.skipped), ("cannot", &self.cannot)];
        let lists = lists.into_iter().filter(|(_, names)| !names.is_empty());
        let lists = lists.map(|(name, names)| (name.to_owned(), names.join(" ")));
        self.settings.clone().into_iter().chain(lists).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_all_that_loosens() {
        let settings = [
            ("bits", "8"),
            ("accept conventions", "true"),
            ("samples", "64"),
        ];
        let settings = settings.map(|(name, value)| (name.to_owned(), value.to_owned()));
        let skipped = ["no image", "not rendered: fog", "no image"].map(str::to_owned);
        let skipped = skipped.into_iter().map(|reason| ("a/b".to_owned(), reason));
        let of = JudgedWith::of(&settings.into(), None, skipped, &[]);
        let said = "--accept-conventions, --bits 8; 2 skipped, 1 cannot be rendered";
        assert_eq!(of.in_words(), said);
        let both = JudgedWith::of_runs(vec![of.clone(), JudgedWith::default()]);
        assert_eq!(both.in_words(), said);
        assert_eq!(JudgedWith::of_runs(vec![of.clone()]), of);
        let strict = [("accept conventions".to_owned(), "false".to_owned())];
        let strict = JudgedWith::of(&strict.into(), None, [], &[]);
        assert_eq!(
            (strict.in_words().as_str(), strict),
            ("", JudgedWith::default())
        );
    }
}
