//! Text from files, made safe for a terminal.

use std::borrow::Cow;

/// Escapes control characters except line ends, and characters that change the direction of writing: a name in a file
/// could move the cursor, colour or hide output.
pub fn escape_controls(text: &str) -> Cow<'_, str> {
    if !text.chars().any(is_odd) {
        return Cow::Borrowed(text);
    }
    let escaped = |c: char| if is_odd(c) { c.escape_unicode().to_string() } else { c.to_string() };
    Cow::Owned(text.chars().map(escaped).collect())
}

fn is_odd(c: char) -> bool {
    c.is_control() && c != '\n'
        || matches!(c, '\u{061c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_but_text_and_line_ends_reaches_the_terminal() {
        assert!(matches!(escape_controls("Küche, 3 µm\nund \"so\""), Cow::Borrowed(_)));
        assert_eq!(escape_controls("a\x1b[2Jb\r\u{9b}31m\u{202e}"), "a\\u{1b}[2Jb\\u{d}\\u{9b}31m\\u{202e}");
        for c in (0..=0x10ffff).filter_map(char::from_u32) {
            let text = String::from(c);
            let shown = escape_controls(&text);
            assert!(shown.chars().all(|c| c == '\n' || !c.is_control()));
        }
    }
}
