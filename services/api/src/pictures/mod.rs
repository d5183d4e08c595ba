//! Pictures that a user sends to have something done with them now; nothing of them is stored.

pub(crate) mod routes;

use imaging::Raster;
use imaging::codec::decode_picture;

use crate::http::form::Form;
use crate::http::problem::Problem;
use crate::limits;
use crate::processes::compute::Compute;

/// The pool for whole pictures of a user: they take much more memory than other computations.
pub(crate) struct Pictures(pub(crate) Compute);

/// A field as a picture of bearable size. Computes: not for async threads.
fn picture(form: &Form, name: &str) -> Result<Option<Raster>, Problem> {
    let Some(bytes) = form.get(name) else {
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

/// The field `picture`, which every form has.
fn required_picture(form: &Form) -> Result<Raster, Problem> {
    picture(form, "picture")?.ok_or_else(|| Problem::field("/picture", "`picture` is missing"))
}
