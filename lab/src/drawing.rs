//! Drawings as files.

use std::path::Path;

use anyhow::Context;
use cli::exit::Failure;
use cli::files;
use imaging::Raster;
use lab::plot::{self, Figure};

/// Writes a drawing as SVG and PNG.
pub(crate) fn write(folder: &Path, name: &str, figure: &impl Figure) -> Result<(), Failure> {
    let path = |extension: &str| folder.join(format!("{name}.{extension}"));
    files::write(&path("svg"), plot::svg(figure).context("cannot draw")?.as_bytes())?;
    let picture = plot::picture(figure).context("cannot draw")?;
    files::write_picture(&path("png"), &Raster::from(picture))
}
