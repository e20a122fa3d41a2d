//! The word that somebody meant.

/// Longest word that is compared: the distance takes time in proportion to both lengths.
const LONGEST: usize = 64;

/// The name that `word` may be a misspelling of, big letters or small; `None` if none is near.
pub fn nearest<'n>(word: &str, names: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    if word.len() > LONGEST {
        return None;
    }
    let word = word.to_lowercase();
    let near = names.into_iter().filter_map(|name| {
        let lower = name.to_lowercase();
        let edits = strsim::damerau_levenshtein(&lower, &word);
        // Half the letters wrong is no misspelling any more.
        let is_near = 2 * edits <= name.len() && are_near_numbers(&lower, &word);
        is_near.then_some((edits, name))
    });
    near.min().map(|(_, name)| name)
}

/// One digit may be wrong, missing or too many, or two exchanged: with more, another number is meant.
fn are_near_numbers(one: &str, other: &str) -> bool {
    let digits = |text: &str| text.replace(|letter: char| !letter.is_ascii_digit(), "");
    strsim::damerau_levenshtein(&digits(one), &digits(other)) <= 1
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

    #[test]
    fn another_number_is_not_a_misspelling() {
        let names = ["figure-1", "figure-12", "frame-0001"];
        assert_eq!(nearest("figure-20001", names), None);
        assert_eq!(nearest("figure-345", names), None);
        assert_eq!(nearest("frame-2345", names), None);
        assert_eq!(nearest("figure-21", names), Some("figure-1"));
        assert_eq!(nearest("figure-122", names), Some("figure-12"));
        assert_eq!(nearest("figure-9", names), Some("figure-1"));
        assert_eq!(nearest("firgure-1", names), Some("figure-1"));
        assert_eq!(nearest("frame-0010", names), Some("frame-0001"));
        assert_eq!(nearest("figuer", names), Some("figure-1"));
        assert_eq!(nearest("frame0001", names), Some("frame-0001"));
    }
}
