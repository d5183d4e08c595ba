//! `fathom child pictures`: renders pictures of requests for the service, one after another.

use std::io::{stdin, stdout};

use anyhow::Context;
use cli::exit::Failure;

use super::engine::EngineArguments;

/// Replies to each request. It ends with its input.
pub(crate) fn run(arguments: &EngineArguments) -> Result<(), Failure> {
    // Decoders may panic on damaged files; the service reports that the process ended.
    std::panic::set_hook(Box::new(|_| {}));
    let rendered = api::render_pictures(&arguments.engine()?, stdin().lock(), stdout().lock());
    Ok(rendered.context("the service closed its pipe")?)
}
