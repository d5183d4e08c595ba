//! `fathom styles`: lists the style waters, enhancers and metric networks of this program or of a service, and adds one to a service.

mod add;

use cli::exit::Failure;
use cli::remote::OtherServer;
use cli::styles::StyleArguments;
use cli::table::table;
use serde_json::json;
use style::{ModelCard, Runtime};

pub(crate) use add::{add, read_upload_card};

/// Options of `fathom styles`.
#[derive(clap::Args)]
#[command(args_conflicts_with_subcommands = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    action: Option<Action>,
    #[command(flatten)]
    style: StyleArguments,
    /// Print one JSON array
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    server: OtherServer,
}

#[derive(clap::Subcommand)]
enum Action {
    /// Add a style, an enhancer or a metric network to a service, for immediate use in jobs
    Add(add::Arguments),
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(Action::Add(arguments)) = &arguments.action {
        return add::run(arguments);
    }
    let client = arguments.server.client();
    let cards: Vec<ModelCard> = match &client {
        Some(client) => client.list("/v1/styles")?,
        None => {
            let library = arguments.style.library()?;
            library.models().map(|model| model.card.clone()).collect()
        }
    };
    if arguments.json {
        println!("{}", json!(cards));
        return Ok(());
    }
    let rows: Vec<Vec<String>> = cards.iter().map(row).collect();
    println!(
        "{}",
        table(&["name", "role", "license", "noise", "range", "sha256"], &rows)
    );
    if client.is_none() {
        match Runtime::load(arguments.style.onnxruntime.as_deref()) {
            Ok(runtime) => println!("\nONNX Runtime {}", runtime.version()),
            Err(missing) => println!("\n{missing}"),
        }
    }
    Ok(())
}

fn row(card: &ModelCard) -> Vec<String> {
    let [noise, range] = [card.takes_noise, card.takes_range].map(|takes| if takes { "yes" } else { "no" });
    vec![
        card.name.clone(),
        card.role.name().to_owned(),
        card.licence.clone(),
        noise.to_owned(),
        range.to_owned(),
        card.sha256.chars().take(16).collect(),
    ]
}
