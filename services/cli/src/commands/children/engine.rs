//! Options of the children that render.

use std::path::PathBuf;
use std::sync::Arc;

use cli::exit::Failure;
use cli::styles::StyleArguments;
use renderer::Engine;

/// Options of a child that renders.
#[derive(clap::Args)]
pub(crate) struct EngineArguments {
    /// Data folder of the service, for the styles added to it
    #[arg(long)]
    pub(super) data: PathBuf,
    #[command(flatten)]
    pub(super) style: StyleArguments,
}

impl EngineArguments {
    pub(super) fn engine(&self) -> Result<Arc<Engine>, Failure> {
        let library = self.style.library_of_service(&self.data)?;
        Ok(Arc::new(Engine::new(library, self.style.onnxruntime.as_deref())))
    }
}
