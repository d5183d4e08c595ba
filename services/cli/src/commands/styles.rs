//! `fathom styles`: lists the style waters of this program or of a service, and adds one to a service.

mod add;

use cli::exit::Failure;
use cli::known::items;
use cli::remote::OtherServer;
use cli::styles::StyleArguments;
use cli::table::{cell, table};
use serde_json::{Value, json};
use style::Runtime;

pub(super) use add::{add, card_of};

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
    /// Add a style network to a service, for jobs to name at once
    Add(add::Arguments),
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(Action::Add(arguments)) = &arguments.action {
        return add::run(arguments);
    }
    let remote = arguments.server.remote();
    let cards = match &remote {
        Some(remote) => items(&remote.get("/v1/styles")?).to_vec(),
        None => {
            let library = arguments.style.library()?;
            library.models().map(|model| json!(model.card)).collect()
        }
    };
    if arguments.json {
        println!("{}", Value::Array(cards));
        return Ok(());
    }
    let row = |card: &Value| {
        let takes = |name: &str| if card[name] == true { "yes" } else { "no" };
        let digest: String = cell(&card["sha256"]).chars().take(16).collect();
        vec![
            cell(&card["name"]),
            cell(&card["licence"]),
            takes("takes_noise").to_owned(),
            takes("takes_range").to_owned(),
            digest,
        ]
    };
    let rows: Vec<Vec<String>> = cards.iter().map(row).collect();
    println!(
        "{}",
        table(&["style", "licence", "noise", "range", "sha256"], &rows)
    );
    if remote.is_none() {
        match Runtime::load(arguments.style.onnxruntime.as_deref()) {
            Ok(runtime) => println!("\nONNX Runtime {}", runtime.version()),
            Err(missing) => println!("\n{missing}"),
        }
    }
    Ok(())
}
