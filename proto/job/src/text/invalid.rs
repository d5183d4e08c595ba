//! Errors of a submitted description, each with its location.

use serde::Serialize;
use serde_json::Value;

/// Maximum listed errors: a document of a megabyte could have a hundred thousand.
pub const MAX_ERRORS: usize = 100;

/// Maximum quoted length of a string, characters.
const MAX_QUOTED: usize = 80;

/// All errors of one description, never empty, in field order.
#[derive(Debug, Clone, PartialEq, Serialize, thiserror::Error)]
#[error("{}", summary(.0))]
#[serde(transparent)]
pub struct Invalid(pub Vec<FieldError>);

/// One error: location, problem, limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FieldError {
    /// JSON pointer (RFC 6901) into the submitted document; empty for the whole document.
    pub pointer: String,
    /// Message with the field, its value and the limit.
    pub message: String,
    /// The rejected value, if short.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<Value>,
    /// The limit, such as `0..=1`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<String>,
    /// Allowed names, if they can be listed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub allowed: Vec<String>,
    /// The nearest allowed name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub did_you_mean: Option<String>,
}

impl FieldError {
    /// An error with a location and a message; the methods below add the rest.
    #[must_use]
    pub fn new(pointer: &str, message: impl Into<String>) -> Self {
        Self {
            pointer: pointer.to_owned(),
            message: message.into(),
            value: None,
            limit: None,
            allowed: Vec::new(),
            did_you_mean: None,
        }
    }

    /// The notice in place of errors beyond [`MAX_ERRORS`].
    pub(crate) fn too_many() -> Self {
        let message = format!("there are more than {MAX_ERRORS} errors; the rest are not listed");
        Self::new("", message)
    }

    /// Adds the rejected value unless it is too long.
    #[must_use]
    pub fn value(mut self, value: &Value) -> Self {
        self.value = match value {
            Value::String(text) => Some(Value::String(shorten(text))),
            Value::Array(_) | Value::Object(_) => {
                (value.to_string().len() <= MAX_QUOTED).then(|| value.clone())
            }
            scalar => Some(scalar.clone()),
        };
        self
    }

    /// Adds the limit.
    #[must_use]
    pub fn limit(mut self, limit: impl Into<String>) -> Self {
        self.limit = Some(limit.into());
        self
    }

    /// Adds the allowed names and the one closest to `written`.
    #[must_use]
    pub fn allowed<S: AsRef<str>>(mut self, names: impl IntoIterator<Item = S>, written: &str) -> Self {
        self.allowed = names.into_iter().map(|name| name.as_ref().to_owned()).collect();
        self.did_you_mean = crate::suggest::nearest(written, &self.allowed).filter(|name| name != written);
        self
    }
}

/// The value as quoted in messages: strings shortened, lists and objects by kind.
pub(crate) fn quote(value: &Value) -> String {
    match value {
        Value::String(text) => format!("\"{}\"", shorten(text)),
        Value::Array(items) if items.is_empty() => "an empty list".to_owned(),
        Value::Array(items) => format!("a list of {}", items.len()),
        Value::Object(_) => "an object".to_owned(),
        scalar => scalar.to_string(),
    }
}

fn shorten(text: &str) -> String {
    if text.chars().count() <= MAX_QUOTED {
        return text.to_owned();
    }
    text.chars().take(MAX_QUOTED).chain(['…']).collect()
}

fn summary(errors: &[FieldError]) -> String {
    let lines: Vec<_> = errors
        .iter()
        .map(|error| format!("{}: {}", place(&error.pointer), line(error)))
        .collect();
    lines.join("\n")
}

fn place(pointer: &str) -> &str {
    if pointer.is_empty() { "document" } else { pointer }
}

fn line(error: &FieldError) -> String {
    match &error.did_you_mean {
        Some(name) => format!("{}; did you mean `{name}`?", error.message),
        None => error.message.clone(),
    }
}
