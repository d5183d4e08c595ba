//! `fathom seal`: the manifest of a set that is complete.

use anyhow::Context;
use cli::exit::Failure;
use cli::seal::SealArguments;
use optics::preset::presets;
use sets::{Set, Source};

use super::failure::failure;
use super::open::open;

/// Runs the command.
pub(crate) fn run(arguments: &SealArguments) -> Result<(), Failure> {
    let set = open(&arguments.what)?;
    let mut sources = waters(&set);
    sources.extend(list_models(&set, arguments)?);
    let manifest = set.seal(sources).map_err(failure)?;
    println!(
        "{}",
        serde_json::to_string_pretty(&manifest).context("the manifest cannot be written")?
    );
    Ok(())
}

/// The preset waters that a frame of the job can have.
fn waters(set: &Set) -> Vec<Source> {
    let job = &set.card().job;
    let named = presets()
        .iter()
        .filter(|preset| job.contains(&format!("\"{}\"", preset.name)));
    named
        .map(|preset: &optics::preset::Preset| Source {
            name: format!("water {}", preset.name),
            source: preset.source.clone(),
            licence: preset.licence.clone(),
        })
        .collect()
}

fn list_models(set: &Set, arguments: &SealArguments) -> Result<Vec<Source>, Failure> {
    let library = arguments.style.library()?;
    set.job()
        .map_err(failure)?
        .models()
        .into_iter()
        .map(|name: String| {
            let card = library.get(&name).map(|model| model.card.clone());
            let card = card
                .ok_or_else(|| Failure::BadInput(format!("the model `{name}` is not here; see --styles")))?;
            Ok(Source {
                name: format!("{} {name}", card.role.name()),
                source: card.source,
                licence: card.licence,
            })
        })
        .collect()
}
