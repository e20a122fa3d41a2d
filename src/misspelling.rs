//! The word that somebody meant.

/// Longest word that is compared: the distance takes time in proportion to both lengths.
const LONGEST: usize = 64;

/// The name that `word` may be a misspelling of, big letters or small; `None` if none is near.
pub fn nearest<'n>(word: &str, names: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    if word.len() > LONGEST {
        return None;
    }
    let word = word.to_lowercase();
    let edits = |name: &str| strsim::damerau_levenshtein(&name.to_lowercase(), &word);
    let names = names.into_iter().map(|name| (edits(name), name));
    let (edits, name) = names.min()?;
    // Half the letters wrong is no misspelling any more.
    (2 * edits <= name.len()).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn a_near_name_is_meant_and_a_far_one_is_not() {
        let names = ["fog", "figures", "procedural"];
        assert_eq!(nearest("figure", names), Some("figures"));
        assert_eq!(nearest("FOG", names), Some("fog"));
        assert_eq!(nearest("nosuch", names), None);
        assert_eq!(nearest("fog", []), None);
        assert_eq!(nearest(&"fog".repeat(100), names), None);
    }
}
