//! Words, values and signs of a filter, each with its place.

use super::FilterError;

/// Longer filters are refused: nobody types them, and parsing must stay cheap.
const MOST_BYTES: usize = 4096;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Token {
    /// A name or keyword.
    Word(String),
    Number(f64),
    Text(String),
    /// A sign, such as `<=`.
    Sign(&'static str),
}

const SIGNS: [&str; 10] = ["==", "!=", "<=", ">=", "=", "<", ">", "(", ")", ","];

pub(super) fn tokens(text: &str) -> Result<Vec<(usize, Token)>, FilterError> {
    if text.len() > MOST_BYTES {
        let message = format!(
            "the filter has {} bytes, at most {MOST_BYTES} are read",
            text.len()
        );
        return Err(FilterError {
            position: MOST_BYTES,
            message,
            did_you_mean: None,
        });
    }
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(next) = text[at..].chars().next() {
        if next.is_whitespace() {
            at += next.len_utf8();
            continue;
        }
        let (token, length) = token(&text[at..], at)?;
        tokens.push((at, token));
        at += length;
    }
    Ok(tokens)
}

fn token(rest: &str, at: usize) -> Result<(Token, usize), FilterError> {
    if let Some(sign) = SIGNS.iter().find(|sign| rest.starts_with(**sign)) {
        return Ok((Token::Sign(sign), sign.len()));
    }
    let first = rest.chars().next().unwrap_or(' ');
    if first == '"' || first == '\'' {
        return quoted(rest, first, at);
    }
    if first.is_ascii_digit() || matches!(first, '-' | '+' | '.') {
        let length = rest
            .find(|c: char| !(c.is_ascii_alphanumeric() || matches!(c, '-' | '+' | '.')))
            .unwrap_or(rest.len());
        let number = rest[..length]
            .parse::<f64>()
            .ok()
            .filter(|number| number.is_finite());
        let number = number.ok_or_else(|| wrong(at, format!("`{}` is no number", &rest[..length])))?;
        return Ok((Token::Number(number), length));
    }
    if first.is_ascii_alphabetic() || first == '_' {
        let belongs = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '.' | '@' | '-');
        let length = rest.find(|c: char| !belongs(c)).unwrap_or(rest.len());
        return Ok((Token::Word(rest[..length].to_owned()), length));
    }
    Err(wrong(at, format!("`{first}` does not belong here")))
}

fn quoted(rest: &str, quote: char, at: usize) -> Result<(Token, usize), FilterError> {
    let mut text = String::new();
    let mut escaped = false;
    for (index, c) in rest.char_indices().skip(1) {
        if escaped {
            text.push(c);
            escaped = false;
        } else if c == '\\' {
            escaped = true;
        } else if c == quote {
            return Ok((Token::Text(text), index + 1));
        } else {
            text.push(c);
        }
    }
    Err(wrong(at, "the quoted text does not end".to_owned()))
}

fn wrong(position: usize, message: String) -> FilterError {
    FilterError {
        position,
        message,
        did_you_mean: None,
    }
}
