//! The texts that a filter compares a column with.

use std::ops::Range;

use super::lexer::{Token, tokens};

/// Words between a column and its values.
const OPERATORS: [&str; 4] = ["not", "in", "between", "and"];

/// A text in a filter.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ComparedText {
    /// Bytes of the filter, with the quotes.
    pub range: Range<usize>,
    /// The text without quotes and escapes.
    pub value: String,
}

/// The texts that a filter compares a column with. None for a filter that cannot be read.
#[must_use]
pub fn find_texts(filter: &str, column: &str) -> Vec<ComparedText> {
    let tokens = tokens(filter).unwrap_or_default();
    let bytes: Vec<usize> = filter.char_indices().map(|(byte, _)| byte).collect();
    let byte_of = |place: usize| bytes.get(place).copied().unwrap_or(filter.len());
    let mut is_column = false;
    let mut texts = Vec::new();
    for (index, (place, token)) in tokens.iter().enumerate() {
        match token {
            Token::Word(word) if OPERATORS.iter().any(|known| known.eq_ignore_ascii_case(word)) => {}
            Token::Word(word) => is_column = word == column,
            Token::Text(value) if is_column => {
                let start = byte_of(*place);
                let end = tokens
                    .get(index + 1)
                    .map_or(filter.len(), |(next, _)| byte_of(*next));
                texts.push(ComparedText {
                    range: start..start + filter[start..end].trim_end().len(),
                    value: value.clone(),
                });
            }
            _ => {}
        }
    }
    texts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_values_of_the_column_are_found() {
        let found = |filter: &str| -> Vec<(String, String)> {
            let texts = find_texts(filter, "job").into_iter();
            texts
                .map(|text| (filter[text.range].to_owned(), text.value))
                .collect()
        };
        let pair = |quoted: &str, value: &str| (quoted.to_owned(), value.to_owned());
        assert_eq!(
            found(r#"job == "job_01" and uiqm > 0.5"#),
            [pair("\"job_01\"", "job_01")]
        );
        assert_eq!(
            found("style = 'é' or job not in ('job_01' , \"job_02\" )"),
            [pair("'job_01'", "job_01"), pair("\"job_02\"", "job_02")]
        );
        assert_eq!(found(r#"labels.job = "job_01" or site = 'job = "x"'"#), []);
        assert_eq!(
            found(r#"job = "a\"b" and site = "job_01""#),
            [pair(r#""a\"b""#, "a\"b")]
        );
        for broken in ["job = \"", "job = 'é", "job = \"\\", "'"] {
            assert_eq!(found(broken), [], "{broken}");
        }
    }
}
