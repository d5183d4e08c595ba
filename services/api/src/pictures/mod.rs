//! Synchronous operations on user images, which are not stored.

pub(crate) mod routes;

use std::sync::Arc;

use serde::de::DeserializeOwned;

use crate::decode::Request;
use crate::http::form::Form;
use crate::http::problem::Problem;
use crate::processes::Processes;
use crate::processes::decoding::{Decoded, Files};

/// A method needs up to 200 bytes per pixel, plus the image and its result.
const PIXEL_BYTES: usize = 220;

/// Enhances and measures images in separate processes.
pub(crate) struct Pictures(pub(crate) Arc<Processes>);

impl Pictures {
    /// Executes a request in a process with the images of a form, named by their fields.
    async fn run<R: DeserializeOwned>(
        &self,
        request: &Request,
        form: &Form,
        fields: &[&'static str],
    ) -> Result<Decoded<R>, Problem> {
        let named = fields.iter().filter_map(|field| Some((*field, form.get(field)?)));
        let files = Files {
            field: "picture",
            named: named.collect(),
            bytes_per_pixel: PIXEL_BYTES,
        };
        self.0.decoding.run(request, files).await
    }
}
