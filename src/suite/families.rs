//! Cases of a suite by families, in the order of their use.

use super::{Case, Suite};

/// Some cases of a family.
#[derive(Clone, Debug)]
pub struct Family<'s> {
    /// Name of the family.
    pub name: &'s str,
    /// What it asks of a renderer, where the suite says so.
    pub asks: Option<&'s str>,
    /// The cases.
    pub cases: Vec<&'s Case>,
}

impl Suite {
    /// Names of the cases that a renderer is asked first.
    pub fn core(&self) -> &[String] {
        &self.outline.core
    }

    /// `cases` by families, in the order of their use.
    pub fn families<'s>(&'s self, cases: &[&'s Case]) -> Vec<Family<'s>> {
        let said = &self.outline.families;
        let place = |name: &str| said.iter().position(|(other, _)| other == name);
        let mut families: Vec<Family<'s>> = Vec::new();
        for case in cases {
            match families.iter_mut().find(|it| it.name == case.family) {
                Some(family) => family.cases.push(case),
                None => families.push(Family {
                    name: &case.family,
                    asks: place(&case.family).map(|at| said[at].1.as_str()),
                    cases: vec![case],
                }),
            }
        }
        families.sort_by_key(|family| (place(family.name).unwrap_or(said.len()), family.name));
        families
    }
}
