//! Suggestions for misspelt words.

use strsim::damerau_levenshtein;

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
        is_near(&lower, &word).then(|| (damerau_levenshtein(&lower, &word), name))
    });
    near.min().map(|(_, name)| name)
}

/// The remedy for a `message` of TOML on an escape.
pub fn escape_remedy(message: &str) -> Option<&'static str> {
    message.contains("escape").then_some(
        "a backslash in double quotes begins an escape: write paths with slashes, or in 'single quotes'",
    )
}

/// True if few letters differ. Words with half the letters wrong are other words, and so are
/// numbers with more than one digit wrong, missing or added, or two exchanged.
fn is_near(name: &str, word: &str) -> bool {
    let [digits, letters] = [true, false].map(|is_digit| {
        let part = |text: &str| text.replace(|c: char| c.is_ascii_digit() != is_digit, "");
        let (name, word) = (part(name), part(word));
        (damerau_levenshtein(&name, &word), name.len())
    });
    digits.0 <= 1 && 2 * letters.0 <= letters.1
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
