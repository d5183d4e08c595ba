//! The style waters that a command may use.

use std::path::{Path, PathBuf};

use style::Library;

use crate::exit::Failure;

/// Where style networks and their runtime are found.
#[derive(Debug, Clone, clap::Args)]
pub struct StyleArguments {
    /// Folder with more style models: NAME.onnx and, if there is one, NAME.card.json
    #[arg(long, env = "FATHOM_STYLES", value_name = "DIR")]
    pub styles: Option<PathBuf>,
    /// The ONNX Runtime library, if it is not where scripts/get-onnxruntime.sh puts it
    #[arg(long, env = "FATHOM_ONNXRUNTIME", value_name = "FILE")]
    pub onnxruntime: Option<PathBuf>,
}

impl StyleArguments {
    /// The shipped library with the user's folder, if there is one.
    pub fn library(&self) -> Result<Library, Failure> {
        let embedded = Library::embedded().map_err(anyhow::Error::from)?;
        match &self.styles {
            Some(folder) => embedded.with_dir(folder).map_err(Failure::input),
            None => Ok(embedded),
        }
    }

    /// The same with the styles that were added to a service.
    pub fn library_of_service(&self, data: &Path) -> Result<Library, Failure> {
        api::added_styles(data, self.library()?).map_err(Failure::input)
    }
}
