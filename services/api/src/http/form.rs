//! Multipart forms, read as a whole: what is wrong with the fields is reported together.

use std::str::FromStr;

use axum::body::Bytes;
use axum::extract::Multipart;
use axum::extract::multipart::{Field, MultipartError};
use axum::http::StatusCode;
use spec::{FieldError, Invalid};

use super::problem::{Problem, Slug};
use crate::limits;

/// What a field holds.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    File,
    /// A file that may be given several times.
    Files,
    Text,
    /// A text that may be given several times.
    Texts,
}

/// The fields of a form by their names, in the order in which they came.
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
                    format!("there is no field `{name}`; fields are {}", names.join(", "))
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
            // The fields after it are checked too.
            while field.chunk().await.map_err(|error| broken(&error))?.is_some() {}
        }
        Ok(Self { fields, errors })
    }

    /// The first field of a name.
    pub(crate) fn get(&self, name: &str) -> Option<&Bytes> {
        let first = self.fields.iter().find(|(field, _)| *field == name);
        first.map(|(_, bytes)| bytes)
    }

    /// All fields of a name.
    pub(crate) fn all<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Bytes> {
        let found = self.fields.iter().filter(move |(field, _)| *field == name);
        found.map(|(_, bytes)| bytes)
    }

    /// The texts of a name.
    pub(crate) fn texts<'a>(&'a self, name: &'a str) -> impl Iterator<Item = String> {
        self.all(name)
            .map(|bytes| String::from_utf8_lossy(bytes).into_owned())
    }

    /// A text, or a default where it is absent.
    pub(crate) fn text_or(&self, name: &str, otherwise: &str) -> String {
        self.texts(name).next().unwrap_or_else(|| otherwise.to_owned())
    }

    /// A number within its limit, or a truth value; another one is refused.
    pub(crate) fn parsed<T: FromStr>(
        &mut self,
        name: &str,
        limit: &str,
        holds: impl FnOnce(&T) -> bool,
    ) -> Option<T> {
        let text = self.texts(name).next()?;
        let number = text.trim().parse().ok().filter(holds);
        if number.is_none() {
            self.refuse(name, format!("{name} is `{}` but must be {limit}", text.trim()));
        }
        number
    }

    /// Refuses a form without this field.
    pub(crate) fn require(&mut self, name: &str) {
        if self.get(name).is_none() {
            self.refuse(name, format!("`{name}` is missing"));
        }
    }

    pub(crate) fn refuse(&mut self, name: &str, message: String) {
        self.errors.push(FieldError::new(&format!("/{name}"), message));
    }

    /// Refuses what is wrong inside of a field.
    pub(crate) fn refuse_inside(&mut self, name: &str, Invalid(errors): Invalid) {
        let inside = |error: FieldError| FieldError {
            pointer: format!("/{name}{}", error.pointer),
            ..error
        };
        self.errors.extend(errors.into_iter().map(inside));
    }

    /// Returns all refusals together, if there are any.
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

/// A form that cannot be read to its end.
fn broken(error: &MultipartError) -> Problem {
    match error.status() {
        StatusCode::PAYLOAD_TOO_LARGE => {
            Problem::new(Slug::TooLarge, "the upload is larger than this route takes")
        }
        _ => Problem::new(Slug::InvalidBody, error.body_text()),
    }
}
