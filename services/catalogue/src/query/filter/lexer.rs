//! Words, values and signs of a filter, each with its place.

use super::FilterError;

/// Longer filters are refused, so that parsing stays cheap.
const MOST_BYTES: usize = 4096;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Token {
    /// A name or keyword.
    Word(String),
    Number(Number),
    Text(String),
    /// A sign, such as `<=`.
    Sign(&'static str),
}

/// A number as it was written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Number {
    pub(super) value: f64,
    /// The same exactly, if it is a whole number.
    pub(super) whole: Option<i128>,
}

const SIGNS: [&str; 10] = ["==", "!=", "<=", ">=", "=", "<", ">", "(", ")", ","];

pub(super) fn tokens(text: &str) -> Result<Vec<(usize, Token)>, FilterError> {
    if text.len() > MOST_BYTES {
        let message = format!(
            "the filter has {} bytes, at most {MOST_BYTES} are read",
            text.len()
        );
        let read = text.char_indices().take_while(|(at, _)| *at < MOST_BYTES);
        return Err(wrong(read.count(), message));
    }
    let mut tokens = Vec::new();
    let (mut rest, mut place) = (text, 0);
    while let Some(next) = rest.chars().next() {
        let length = if next.is_whitespace() {
            next.len_utf8()
        } else {
            let (token, length) = token(rest, place)?;
            tokens.push((place, token));
            length
        };
        place += rest[..length].chars().count();
        rest = &rest[length..];
    }
    Ok(tokens)
}

/// The first token and its length in bytes. `place` is where it begins, in characters.
fn token(rest: &str, place: usize) -> Result<(Token, usize), FilterError> {
    if let Some(sign) = SIGNS.iter().find(|sign| rest.starts_with(**sign)) {
        return Ok((Token::Sign(sign), sign.len()));
    }
    let first = rest.chars().next().unwrap_or(' ');
    if first == '"' || first == '\'' {
        return quoted(rest, first, place);
    }
    if first.is_ascii_digit() || matches!(first, '-' | '+' | '.') {
        let length = rest
            .find(|c: char| !(c.is_ascii_alphanumeric() || matches!(c, '-' | '+' | '.')))
            .unwrap_or(rest.len());
        let number = number(&rest[..length]);
        let number = number.ok_or_else(|| wrong(place, format!("`{}` is not a number", &rest[..length])))?;
        return Ok((Token::Number(number), length));
    }
    if first.is_ascii_alphabetic() || first == '_' {
        let belongs = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '.' | '@' | '-');
        let length = rest.find(|c: char| !belongs(c)).unwrap_or(rest.len());
        return Ok((Token::Word(rest[..length].to_owned()), length));
    }
    Err(wrong(place, format!("`{first}` does not belong here")))
}

fn number(text: &str) -> Option<Number> {
    /// Doubles of this size are whole, and 128 bits hold them.
    const MOST: f64 = 1e30;
    let value = text.parse::<f64>().ok().filter(|number| number.is_finite())?;
    let of_double = (value.fract() == 0.0 && value.abs() < MOST).then_some(value as i128);
    let whole = text.parse().ok().or(of_double);
    Some(Number { value, whole })
}

fn quoted(rest: &str, quote: char, place: usize) -> Result<(Token, usize), FilterError> {
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
    Err(wrong(place, "the quoted text does not end".to_owned()))
}

fn wrong(position: usize, message: String) -> FilterError {
    FilterError {
        position: Some(position),
        parameter: None,
        message,
        did_you_mean: None,
    }
}
