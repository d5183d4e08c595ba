//! Text in lines of a limited width.

/// A word wider than a line is broken after one of these characters.
const BREAKS: [char; 9] = ['.', ',', '/', '(', ')', '_', '-', '=', '&'];

/// The lines of a text, each of this width at most. They are broken between words; a word wider than a line is broken after one of
/// `BREAKS`, or else at the width.
pub(crate) fn wrap(text: &str, width: usize) -> Vec<String> {
    let width = width.max(1);
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let mut rest = word;
        loop {
            let (piece, after) = split_word(rest, width);
            let line = lines.last_mut().expect("one line");
            let is_first = rest.len() == word.len();
            if line.is_empty() {
                line.push_str(piece);
            } else if is_first && length(line) + 1 + length(word) <= width {
                line.push(' ');
                line.push_str(piece);
            } else {
                lines.push(piece.to_owned());
            }
            rest = after;
            if rest.is_empty() {
                break;
            }
        }
    }
    lines
}

/// The first part of a word that fits a line, and the rest.
fn split_word(word: &str, width: usize) -> (&str, &str) {
    let Some((end, _)) = word.char_indices().nth(width) else {
        return (word, "");
    };
    let end = word[..end].rfind(BREAKS).map_or(end, |last| last + 1);
    word.split_at(end)
}

/// A paragraph with a hanging indent: lines of at most `width`. Without a width it is one line.
pub(crate) fn paragraph(text: &str, indent: usize, width: Option<usize>) -> String {
    /// Least columns that an indented text keeps.
    const LEAST: usize = 24;
    let Some(width) = width else {
        return text.to_owned();
    };
    let lines = wrap(text.trim_start(), width.saturating_sub(indent).max(LEAST));
    let leading = &text[..text.len() - text.trim_start().len()];
    let lines = lines.into_iter().enumerate().map(|(number, line)| match number {
        0 => format!("{leading}{line}"),
        _ => format!("{}{line}", " ".repeat(indent)),
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// Width of a text in columns.
pub(crate) fn length(text: &str) -> usize {
    text.chars().count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_broken_between_words_and_in_words_that_are_wider() {
        assert_eq!(wrap("one two three", 7), ["one two", "three"]);
        assert_eq!(wrap("a chain.mask.radius", 11), ["a", "chain.mask.", "radius"]);
        assert_eq!(
            wrap("incomprehensible µµµ", 6),
            ["incomp", "rehens", "ible", "µµµ"]
        );
        assert_eq!(wrap("short", 0), ["s", "h", "o", "r", "t"]);
        assert_eq!(wrap("", 4), [""]);
    }

    #[test]
    fn further_lines_of_a_paragraph_are_indented() {
        let text = "  snow: discs of twelve millimeters at most";
        assert_eq!(
            paragraph(text, 4, Some(30)),
            "  snow: discs of twelve\n    millimeters at most"
        );
        assert_eq!(paragraph(text, 4, None), text);
    }
}
