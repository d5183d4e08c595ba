//! Filters of commands: a job may be named by the beginning of its id.

use std::ops::Range;

use client::Client;

use crate::exit::Failure;
use crate::known;

/// Words between a column and its values.
const OPERATORS: [&str; 4] = ["not", "in", "between", "and"];

/// The filter with whole ids in place of the beginnings that `job` is compared with, such as `job == "job_0198c0ffee00"`.
pub fn expand_jobs(client: &Client, filter: &str) -> Result<String, Failure> {
    let mut expanded = filter.to_owned();
    for range in job_values(filter).into_iter().rev() {
        let id = &filter[range.clone()];
        if id.starts_with("job_") && !known::is_job_id(id) {
            expanded.replace_range(range, &known::job(client, id)?.id);
        }
    }
    Ok(expanded)
}

/// The places of texts, without their quotes, that the column `job` is compared with; to the first text that is not closed.
fn job_values(filter: &str) -> Vec<Range<usize>> {
    let (mut values, mut is_job) = (Vec::new(), false);
    let mut start = 0;
    while let Some(first) = filter[start..].chars().next() {
        let rest = &filter[start..];
        let length = match first {
            '"' | '\'' => {
                let Some(length) = quoted_length(rest) else {
                    break;
                };
                if is_job {
                    values.push(start + 1..start + length - 1);
                }
                length
            }
            _ if is_name(first) => {
                let length = rest.find(|character| !is_name(character));
                let word = &rest[..length.unwrap_or(rest.len())];
                if !OPERATORS.iter().any(|known| known.eq_ignore_ascii_case(word)) {
                    is_job = word == "job";
                }
                word.len()
            }
            _ => first.len_utf8(),
        };
        start += length;
    }
    values
}

/// Whether a character belongs to the name of a column, a keyword or a number.
fn is_name(character: char) -> bool {
    character.is_alphanumeric() || "_.@-".contains(character)
}

/// Bytes of a text with its quotes; `None` if it is not closed.
fn quoted_length(text: &str) -> Option<usize> {
    let mut characters = text.char_indices();
    let quote = characters.next().map(|(_, quote)| quote);
    while let Some((index, character)) = characters.next() {
        if Some(character) == quote {
            return Some(index + 1);
        }
        if character == '\\' {
            characters.next();
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_values_of_job_are_found() {
        let found = |filter: &str| -> Vec<String> {
            let values = job_values(filter).into_iter();
            values.map(|range| filter[range].to_owned()).collect()
        };
        assert_eq!(found(r#"job == "job_01" and uiqm > 0.5"#), ["job_01"]);
        assert_eq!(
            found("frame < 3 or job not in ('job_01', \"job_02\")"),
            ["job_01", "job_02"]
        );
        assert_eq!(found(r#"labels.job = "job_01" or site = 'job = "x"'"#), [""; 0]);
        assert_eq!(found(r#"job = "a\"b" and site = "job_01""#), [r#"a\"b"#]);
        for broken in ["job = \"", "job = 'é", "job = \"\\", "job = \"\\\"", "'"] {
            assert_eq!(found(broken), [""; 0], "{broken}");
        }
    }
}
