//! `fathom styles`: lists the style waters and the version of ONNX Runtime.

use cli::exit::Failure;
use cli::styles::StyleArguments;
use cli::table::table;
use style::{Runtime, StyleModel};

/// Options of `fathom styles`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    style: StyleArguments,
    /// Print one JSON array
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let library = arguments.style.library()?;
    let models: Vec<_> = library.models().collect();
    if arguments.json {
        let cards: Vec<_> = models.iter().map(|model| &model.card).collect();
        println!("{}", serde_json::to_string(&cards).map_err(anyhow::Error::from)?);
        return Ok(());
    }
    let row = |model: &&StyleModel| {
        let (card, noise) = (&model.card, if model.card.takes_noise { "yes" } else { "no" });
        [&model.name, &card.licence, noise, &card.sha256[..16]]
            .map(str::to_owned)
            .to_vec()
    };
    let rows: Vec<Vec<String>> = models.iter().map(row).collect();
    println!("{}", table(&["style", "licence", "noise", "sha256"], &rows));
    match Runtime::load(arguments.style.onnxruntime.as_deref()) {
        Ok(runtime) => println!("\nONNX Runtime {}", runtime.version()),
        Err(missing) => println!("\n{missing}"),
    }
    Ok(())
}
