//! What is wrong with a submitted description: every error, each with the place where it stands.

use serde::Serialize;
use serde_json::Value;

/// At most this many errors are listed: a document of a megabyte could hold a hundred thousand.
pub const MAX_ERRORS: usize = 100;

/// Longest string that an error quotes, in characters.
const MAX_QUOTED: usize = 80;

/// All errors of one description, never empty, in the order of the fields.
#[derive(Debug, Clone, PartialEq, Serialize, thiserror::Error)]
#[error("{}", summary(.0))]
#[serde(transparent)]
pub struct Invalid(pub Vec<FieldError>);

/// One error: where it stands, what is wrong, what would be right.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FieldError {
    /// JSON pointer (RFC 6901) into the submitted document; empty for the document as a whole.
    pub pointer: String,
    /// Names the field, its value and the limit, for people.
    pub message: String,
    /// The refused value, if it is short.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<Value>,
    /// The limit that it breaks, such as `0..=1`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<String>,
    /// What may stand here, if that is a list of names.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub allowed: Vec<String>,
    /// The nearest allowed name.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub did_you_mean: Option<String>,
}

impl FieldError {
    /// An error at a place; the other parts are added by the methods below.
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

    /// Adds the refused value, unless it is too long to be of use.
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

    /// Adds the allowed names and the one nearest to what was written.
    #[must_use]
    pub fn allowed<S: AsRef<str>>(mut self, names: impl IntoIterator<Item = S>, written: &str) -> Self {
        self.allowed = names.into_iter().map(|name| name.as_ref().to_owned()).collect();
        self.did_you_mean = crate::suggest::nearest(written, &self.allowed);
        self
    }
}

/// The value as a message quotes it: strings in quotes and shortened, lists and objects by their kind.
pub(crate) fn quote(value: &Value) -> String {
    match value {
        Value::String(text) => format!("\"{}\"", shorten(text)),
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
