//! Foreign text made harmless: names of files, keys, output of another renderer.
//!
//! A terminal obeys control characters: they colour, erase, and set its title or the clipboard.
//! Characters that change the direction of writing make a text look like another.

/// `text` with a symbol in place of every control character other than newline and tab: `␛` for
/// escape, `�` if there is no symbol. Each is one character, so columns are unchanged.
pub fn visible(text: &str) -> String {
    text.chars().map(visible_char).collect()
}

/// The symbol that [`visible`] writes for a character.
fn visible_char(letter: char) -> char {
    let code = u32::from(letter);
    match letter {
        '\n' | '\t' => letter,
        // The pictures of control characters stand in their order from U+2400 on.
        '\0'..='\x1f' => char::from_u32(0x2400 + code).unwrap_or('�'),
        '\x7f' => '␡',
        '\u{80}'..='\u{9f}' => '�',
        // Marks, embeddings, overrides and isolates of direction; separators of lines and
        // paragraphs.
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => {
            '�'
        }
        _ => letter,
    }
}

/// [`visible`] text of as many bytes, so that places in it stay: with `?`, `¿` and `�`, and a space for `\r`.
pub(crate) fn visible_in_place(text: &str) -> String {
    let shown = |letter: char| match letter.len_utf8() {
        _ if visible_char(letter) == letter => letter,
        1 if letter == '\r' => ' ',
        1 => '?',
        2 => '¿',
        _ => '�',
    };
    text.chars().map(shown).collect()
}

/// [`visible`] text as XML 1.0 holds it, within an element or an attribute.
pub(crate) fn xml_text(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => escaped.push('�'),
            _ => escaped.push(visible_char(letter)),
        }
    }
    escaped
}

/// JSON `text` with the characters that [`visible`] replaces as escapes: the same data. JSON has
/// them within strings alone; those below U+0020 it escapes anyway.
pub(crate) fn visible_json(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match visible_char(letter) {
            // All of them have four digits: none lies beyond U+FFFF.
            other if other != letter => {
                escaped.push_str(&format!("\\u{:04x}", u32::from(letter)));
            }
            _ => escaped.push(letter),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_obeyed_is_seen() {
        assert_eq!(visible("a\x1b[31m\tb\r\n\u{9b}\x7f\0"), "a␛[31m\tb␍\n�␡␀");
        assert_eq!(visible("invoice\u{202e}gnp.exe"), "invoice�gnp.exe");
        assert_eq!(visible_in_place("ä\x1b\u{9b}\u{202e}\r\n"), "ä?¿� \n");
        assert_eq!(visible("ünïcode – ☃ 🎲"), "ünïcode – ☃ 🎲");
    }

    #[test]
    fn json_stays_what_it_is() {
        let text: String = ('\0'..='\u{ffff}').collect();
        let json = visible_json(&serde_json::to_string(&text).unwrap());
        assert_eq!(visible(&json), json);
        assert_eq!(serde_json::from_str::<String>(&json).unwrap(), text);
    }
}
