//! A network of the user as a step. This crate cannot run one: the caller passes a function.

use imaging::{Raster, Rgb8};
use spec::EnhancerNetwork;

use crate::result::{EnhanceError, Enhanced, OfGray};

/// Runs a network on a picture of sRGB codes. The error is a reason.
pub type RunNetwork<'a> = &'a mut dyn FnMut(&EnhancerNetwork, &Rgb8) -> Result<Rgb8, String>;

/// Refuses every network.
///
/// # Errors
/// Always, with the places where networks run.
pub fn refuse_network(_: &EnhancerNetwork, _: &Rgb8) -> Result<Rgb8, String> {
    Err("cannot run here; networks run in jobs and in `fathom enhance`".to_owned())
}

/// Runs a network on a picture; the result has colors.
pub(crate) fn run_network(
    network: &EnhancerNetwork,
    picture: &Raster,
    run: RunNetwork<'_>,
) -> Result<Enhanced, EnhanceError> {
    let (width, height) = (picture.width(), picture.height());
    if width == 0 || height == 0 {
        return Err(EnhanceError::Empty { width, height });
    }
    let colors = run(network, &picture.to_rgb8()).and_then(|colors| {
        let (columns, rows) = (colors.width(), colors.height());
        if (columns, rows) == (width, height) {
            return Ok(colors);
        }
        Err(format!(
            "returned a picture of {columns}×{rows}; must be {width}×{height}"
        ))
    });
    let colors = colors.map_err(|reason| EnhanceError::Network {
        model: network.model.clone(),
        reason,
    })?;
    Ok(Enhanced::from_colors(picture, &colors, OfGray::Color, Vec::new()))
}
