//! `fathom child`: work for the service that may crash or hang, in a separate process.

mod check_style;
mod decode;
mod live;
mod rerender;

use std::path::PathBuf;
use std::sync::Arc;

use cli::exit::Failure;
use cli::styles::StyleArguments;
use renderer::Engine;

/// The tasks of child processes.
#[derive(clap::Subcommand)]
pub(crate) enum Task {
    /// Render a stored frame again
    Rerender(rerender::Arguments),
    /// Render preview frames, one after another
    Live(EngineArguments),
    /// Decode an upload
    Decode(decode::Arguments),
    /// Try an unverified style network
    CheckStyle(check_style::Arguments),
}

impl Task {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        match self {
            Self::Rerender(arguments) => rerender::run(arguments),
            Self::Live(arguments) => live::run(arguments),
            Self::Decode(arguments) => decode::run(arguments),
            Self::CheckStyle(arguments) => check_style::run(arguments),
        }
    }
}

/// Options of a child that renders.
#[derive(clap::Args)]
pub(crate) struct EngineArguments {
    /// Data folder of the service, for the styles added to it
    #[arg(long)]
    data: PathBuf,
    #[command(flatten)]
    style: StyleArguments,
}

impl EngineArguments {
    fn engine(&self) -> Result<Arc<Engine>, Failure> {
        let library = self.style.library_of_service(&self.data)?;
        Ok(Arc::new(Engine::new(library, self.style.onnxruntime.as_deref())))
    }
}
