//! `fathom styles`: the style waters, and whether their runtime is here.

use std::path::Path;

use style::{Library, Runtime};

use super::StyleArguments;
use crate::exit::Failure;
use crate::table::table;

/// Options of `fathom styles`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    style: StyleArguments,
    /// Print one JSON array
    #[arg(long)]
    json: bool,
}

/// The shipped library with the user's folder, if there is one.
pub(crate) fn library(arguments: &StyleArguments) -> Result<Library, Failure> {
    let embedded = Library::embedded().map_err(anyhow::Error::from)?;
    match &arguments.styles {
        Some(folder) => embedded
            .with_dir(folder)
            .map_err(|error| Failure::BadInput(error.to_string())),
        None => Ok(embedded),
    }
}

/// The same with the styles that were added to a service.
pub(crate) fn of_service(arguments: &StyleArguments, data: &Path) -> Result<Library, Failure> {
    let library = library(arguments)?;
    api::added_styles(data, library).map_err(|error| Failure::BadInput(error.to_string()))
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let library = library(&arguments.style)?;
    let models: Vec<_> = library
        .names()
        .into_iter()
        .filter_map(|name| library.get(name))
        .collect();
    if arguments.json {
        let cards: Vec<_> = models.iter().map(|model| &model.card).collect();
        println!("{}", serde_json::to_string(&cards).map_err(anyhow::Error::from)?);
        return Ok(());
    }
    let rows: Vec<Vec<String>> = models
        .iter()
        .map(|model| {
            vec![
                model.name.clone(),
                model.card.licence.clone(),
                if model.card.takes_noise { "yes" } else { "no" }.to_owned(),
                model.card.sha256[..16].to_owned(),
            ]
        })
        .collect();
    println!("{}", table(&["style", "licence", "noise", "sha256"], &rows));
    match Runtime::load(arguments.style.onnxruntime.as_deref()) {
        Ok(runtime) => println!("\nONNX Runtime {}", runtime.version()),
        Err(missing) => println!("\n{missing}"),
    }
    Ok(())
}
