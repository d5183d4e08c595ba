//! Pictures that a user sends to have something done with them now; nothing of them is stored.

pub(crate) mod routes;

use std::collections::BTreeMap;

use axum::body::Bytes;
use axum::extract::Multipart;
use imaging::Raster;
use imaging::codec::decode_picture;

use crate::http::problem::Problem;
use crate::limits;
use crate::scenes::form::{broken, too_many};

/// The files of a form by the names of their fields.
pub(crate) struct Files(BTreeMap<String, Bytes>);

impl Files {
    /// Reads a form that has these fields; the first must be there.
    pub(crate) async fn read(mut body: Multipart, names: &[&str]) -> Result<Self, Problem> {
        let mut files = BTreeMap::new();
        while let Some(field) = body.next_field().await.map_err(|error| broken(&error))? {
            let name = field.name().unwrap_or_default().to_owned();
            if !names.contains(&name.as_str()) {
                let fields = names.join(", ");
                return Err(Problem::field(
                    &format!("/{name}"),
                    format!("there is no field `{name}`; fields are {fields}"),
                ));
            }
            if files.len() == limits::FORM_FIELDS {
                return Err(too_many());
            }
            let bytes = field.bytes().await.map_err(|error| broken(&error))?;
            if files.insert(name.clone(), bytes).is_some() {
                return Err(Problem::field(
                    &format!("/{name}"),
                    format!("`{name}` is given twice"),
                ));
            }
        }
        match names.first().filter(|name| !files.contains_key(**name)) {
            Some(name) => Err(Problem::field(
                &format!("/{name}"),
                format!("`{name}` is missing"),
            )),
            None => Ok(Self(files)),
        }
    }

    /// A field as a picture of bearable size. Computes: not for async threads.
    pub(crate) fn picture(&self, name: &str) -> Result<Option<Raster>, Problem> {
        let Some(bytes) = self.0.get(name) else {
            return Ok(None);
        };
        let refuse = |message: String| Problem::field(&format!("/{name}"), message);
        let picture = decode_picture(bytes).map_err(|error| refuse(format!("`{name}`: {error}")))?;
        let (width, height) = (picture.width(), picture.height());
        match width * height {
            0..=limits::PICTURE_PIXELS => Ok(Some(picture)),
            pixels => Err(refuse(format!(
                "`{name}` is {width}×{height} = {pixels} pixels, the limit is {}",
                limits::PICTURE_PIXELS
            ))),
        }
    }
}
