//! The methods, a file or folder for each.

mod clahe;
mod dcp;
mod fusion;
mod gray_world;
pub mod hscm;
pub mod ibla;
mod method;
mod mlle;
mod rd;
mod rghs;
mod suir;
mod ulap;
#[cfg(test)]
mod vectors;

use imaging::Raster;
use spec::Step;

use crate::network::{refuse_network, run_network};
use crate::result::{EnhanceError, Enhanced};
use crate::variant::Variant;
pub use method::{IBLA_GUIDED_DISTANCE, Method};

/// Enhances one picture by the fast variant of a method.
///
/// # Errors
/// [`EnhanceError::Empty`] for a picture without pixels; [`EnhanceError::TooLarge`] beyond the method's limit;
/// [`EnhanceError::Network`] for a network, which only [`enhance`](crate::enhance) runs.
pub fn run(method: &Method, picture: &Raster) -> Result<Enhanced, EnhanceError> {
    run_variant(method, picture, Variant::Fast)
}

/// Enhances one picture by the given variant.
///
/// # Errors
/// As [`run`].
pub fn run_variant(method: &Method, picture: &Raster, variant: Variant) -> Result<Enhanced, EnhanceError> {
    let (width, height) = (picture.width(), picture.height());
    if width == 0 || height == 0 {
        return Err(EnhanceError::Empty { width, height });
    }
    let pixels = width.saturating_mul(height);
    if let Some(limit) = method.pixels_max().filter(|limit| pixels > *limit) {
        return Err(EnhanceError::TooLarge {
            method: method.name(),
            width,
            height,
            pixels,
            limit,
        });
    }
    Ok(match &method.0 {
        Step::Hscm(parameters) => hscm::enhance(picture, parameters, variant),
        Step::Clahe(parameters) => clahe::enhance(picture, parameters),
        Step::GrayWorld(_) => gray_world::enhance(picture),
        Step::Ulap(parameters) => ulap::enhance(picture, parameters, variant),
        Step::Suir(parameters) => suir::enhance(picture, parameters, variant),
        Step::Ibla(parameters) => ibla::enhance(picture, parameters, variant),
        Step::Rd(parameters) => rd::enhance(picture, parameters, variant),
        Step::Rghs(_) => rghs::enhance(picture, variant),
        Step::Dcp(parameters) => dcp::enhance(picture, parameters, variant),
        Step::Udcp(parameters) => dcp::enhance_underwater(picture, parameters, variant),
        Step::Fusion(parameters) => fusion::enhance(picture, parameters, variant),
        Step::Mlle(parameters) => mlle::enhance(picture, parameters, variant),
        Step::Onnx(parameters) => run_network(parameters, picture, &mut refuse_network)?,
    })
}
