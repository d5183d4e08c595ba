//! The style waters available to a command.

use std::path::{Path, PathBuf};

use style::Library;

use crate::exit::Failure;

/// Where to find style networks and their runtime.
#[derive(Debug, Clone, clap::Args)]
pub struct StyleArguments {
    /// Folder with additional style models: NAME.onnx and optionally NAME.card.json
    #[arg(long, env = "FATHOM_STYLES", value_name = "DIR")]
    pub styles: Option<PathBuf>,
    /// The ONNX Runtime library [default: where scripts/get-onnxruntime.sh installs it]
    #[arg(long, env = "FATHOM_ONNXRUNTIME", value_name = "FILE")]
    pub onnxruntime: Option<PathBuf>,
}

impl StyleArguments {
    /// The shipped styles and those in the user's folder.
    pub fn library(&self) -> Result<Library, Failure> {
        let embedded = Library::embedded().map_err(anyhow::Error::from)?;
        match &self.styles {
            Some(folder) => embedded.with_dir(folder).map_err(Failure::input),
            None => Ok(embedded),
        }
    }

    /// The same, with the styles added to a service.
    pub fn library_of_service(&self, data: &Path) -> Result<Library, Failure> {
        api::added_styles(data, self.library()?).map_err(Failure::input)
    }
}
