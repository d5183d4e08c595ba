//! Printing of texts that may come from a service: control characters, which a terminal would obey, are escaped.
//!
//! Printing to a closed pipe: in `fathom query | head`, the unread rest is dropped and the exit status is that of the command. The
//! macros replace those of the standard library, which panic.

use std::borrow::Cow;
use std::fmt;
use std::io::{ErrorKind, Write};

/// Prints a line to standard output.
#[macro_export]
macro_rules! println {
    ($($line:tt)*) => {
        $crate::print::line(&mut std::io::stdout().lock(), format_args!($($line)*))
    };
}

/// Prints a line to standard error.
#[macro_export]
macro_rules! eprintln {
    ($($line:tt)*) => {
        $crate::print::line(&mut std::io::stderr().lock(), format_args!($($line)*))
    };
}

/// Writes a line with visible characters only; ends the process if it cannot be written to a reader who is still there, such as a full disk.
pub fn line(out: &mut impl Write, text: fmt::Arguments<'_>) {
    let text = text.to_string();
    if let Err(error) = writeln!(out, "{}", visible(&text))
        && error.kind() != ErrorKind::BrokenPipe
    {
        // Standard error may be what cannot be written.
        let _ = writeln!(std::io::stderr(), "fathom: cannot print: {error}");
        std::process::exit(1);
    }
}

/// The text with control characters and changes of direction as `\u001b`, which is also their escape in JSON. Line feeds and tabs stay.
pub fn visible(text: &str) -> Cow<'_, str> {
    if !text.contains(is_hidden) {
        return text.into();
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for character in text.chars() {
        if is_hidden(character) {
            shown.push_str(&format!("\\u{:04x}", u32::from(character)));
        } else {
            shown.push(character);
        }
    }
    shown.into()
}

/// Control characters, and those that change the direction of text (Unicode, bidirectional formatting).
fn is_hidden(character: char) -> bool {
    (character.is_control() && !matches!(character, '\n' | '\t'))
        || matches!(character, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_character_reaches_the_terminal_as_a_command() {
        assert_eq!(visible("a\tb\nc – µ"), "a\tb\nc – µ");
        assert_eq!(visible("\u{1b}]0;x\u{7}"), "\\u001b]0;x\\u0007");
        assert_eq!(
            visible("\r\u{9b}2J\u{202e}\u{7f}"),
            "\\u000d\\u009b2J\\u202e\\u007f"
        );
        let json = serde_json::json!("a\u{9b}\u{7f}").to_string();
        let read: String = serde_json::from_str(&visible(&json)).unwrap();
        assert_eq!(read, "a\u{9b}\u{7f}");
    }
}
