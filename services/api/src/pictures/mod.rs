//! Pictures that a user sends to have something done with them now; nothing of them is stored.

pub(crate) mod routes;

use std::sync::Arc;

use serde::de::DeserializeOwned;

use crate::decode::Request;
use crate::http::form::Form;
use crate::http::problem::Problem;
use crate::processes::Processes;
use crate::processes::decoding::{Decoded, Files};

/// A method holds up to 200 bytes a pixel, beside the picture and its result.
const PIXEL_BYTES: usize = 220;

/// Where pictures are decoded and worked on.
pub(crate) struct Pictures(pub(crate) Arc<Processes>);

impl Pictures {
    /// Has a process do what a request says with the pictures of a form, which have the names of their fields.
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
