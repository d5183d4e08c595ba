//! Multipart forms, read completely; all invalid fields are reported together.

use std::str::FromStr;

use axum::body::Bytes;
use axum::extract::Multipart;
use axum::extract::multipart::{Field, MultipartError};
use axum::http::StatusCode;
use spec::{FieldError, Invalid};

use super::problem::{Problem, Slug};
use crate::limits;

/// Type of a form field.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    File,
    /// A repeatable file.
    Files,
    Text,
    /// A repeatable text.
    Texts,
}

/// The fields of a form by name, in order of arrival.
pub(crate) struct Form {
    fields: Vec<(&'static str, Bytes)>,
    errors: Vec<FieldError>,
}

impl Form {
    /// Reads a form that may have these fields.
    pub(crate) async fn read(mut body: Multipart, known: &[(&'static str, Kind)]) -> Result<Self, Problem> {
        let (mut fields, mut errors) = (Vec::<(&'static str, Bytes)>::new(), Vec::new());
        while let Some(mut field) = body.next_field().await.map_err(|error| broken(&error))? {
            if fields.len() + errors.len() == limits::FORM_FIELDS {
                let detail = format!("the form has more than {} fields", limits::FORM_FIELDS);
                return Err(Problem::new(Slug::InvalidBody, detail));
            }
            let name = field.name().unwrap_or_default().to_owned();
            let refusal = match known.iter().find(|(known, _)| *known == name) {
                None => {
                    let names: Vec<_> = known.iter().map(|(name, _)| *name).collect();
                    format!("`{name}` is not a field; must be one of {}", names.join(", "))
                }
                Some((_, Kind::File | Kind::Text)) if fields.iter().any(|(seen, _)| *seen == name) => {
                    format!("`{name}` is given twice")
                }
                Some((known, Kind::File | Kind::Files)) => {
                    let bytes = field.bytes().await.map_err(|error| broken(&error))?;
                    fields.push((*known, bytes));
                    continue;
                }
                Some((known, Kind::Text | Kind::Texts)) => match text(&mut field).await? {
                    Ok(text) => {
                        fields.push((*known, text.into()));
                        continue;
                    }
                    Err(why) => format!("`{name}` {why}"),
                },
            };
            errors.push(FieldError::new(&format!("/{name}"), refusal));
            // Continue, so that later fields are checked too.
            while field.chunk().await.map_err(|error| broken(&error))?.is_some() {}
        }
        Ok(Self { fields, errors })
    }

    /// The first field with a name.
    pub(crate) fn get(&self, name: &str) -> Option<&Bytes> {
        let first = self.fields.iter().find(|(field, _)| *field == name);
        first.map(|(_, bytes)| bytes)
    }

    /// All fields with a name.
    pub(crate) fn all<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Bytes> {
        let found = self.fields.iter().filter(move |(field, _)| *field == name);
        found.map(|(_, bytes)| bytes)
    }

    /// All texts with a name.
    pub(crate) fn texts<'a>(&'a self, name: &'a str) -> impl Iterator<Item = String> {
        self.all(name)
            .map(|bytes| String::from_utf8_lossy(bytes).into_owned())
    }

    /// A text, or a default if absent.
    pub(crate) fn text_or(&self, name: &str, otherwise: &str) -> String {
        self.texts(name).next().unwrap_or_else(|| otherwise.to_owned())
    }

    /// Parses a number or truth value and adds an error if it is invalid.
    pub(crate) fn parsed<T: FromStr>(
        &mut self,
        name: &str,
        limit: &str,
        holds: impl FnOnce(&T) -> bool,
    ) -> Option<T> {
        let text = self.texts(name).next()?;
        let number = text.trim().parse().ok().filter(holds);
        if number.is_none() {
            self.refuse(name, format!("`{name}` is {}; must be {limit}", text.trim()));
        }
        number
    }

    /// Adds an error if the field is missing.
    pub(crate) fn require(&mut self, name: &str) {
        if self.get(name).is_none() {
            self.refuse(name, format!("`{name}` is missing"));
        }
    }

    pub(crate) fn refuse(&mut self, name: &str, message: String) {
        self.errors.push(FieldError::new(&format!("/{name}"), message));
    }

    /// Adds errors from inside a field.
    pub(crate) fn refuse_inside(&mut self, name: &str, Invalid(errors): Invalid) {
        self.errors
            .extend(errors.into_iter().map(|error: FieldError| FieldError {
                pointer: format!("/{name}{}", error.pointer),
                ..error
            }));
    }

    /// Returns all errors together, if any.
    pub(crate) fn check(&mut self) -> Result<(), Problem> {
        match std::mem::take(&mut self.errors) {
            errors if errors.is_empty() => Ok(()),
            errors => Err(Invalid(errors).into()),
        }
    }
}

async fn text(field: &mut Field<'_>) -> Result<Result<String, String>, Problem> {
    let mut bytes = Vec::new();
    while let Some(chunk) = field.chunk().await.map_err(|error| broken(&error))? {
        bytes.extend_from_slice(&chunk);
        if bytes.len() > limits::FORM_TEXT_BYTES {
            return Ok(Err(format!("has more than {} bytes", limits::FORM_TEXT_BYTES)));
        }
    }
    Ok(String::from_utf8(bytes).map_err(|_| "is not UTF-8".to_owned()))
}

/// A form that ends prematurely or is malformed.
fn broken(error: &MultipartError) -> Problem {
    match error.status() {
        StatusCode::PAYLOAD_TOO_LARGE => {
            Problem::new(Slug::TooLarge, "the upload exceeds the limit of this route")
        }
        _ => Problem::new(Slug::InvalidBody, error.body_text()),
    }
}
