//! `fathom datasets`: lists the datasets of a service.

use cli::exit::Failure;
use cli::known::items;
use cli::remote::{Remote, ServerArguments};
use cli::table::table_of;

/// Options of `fathom datasets`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Print one JSON object per dataset
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    server: ServerArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let page = Remote::new(&arguments.server).get("/v1/datasets")?;
    let datasets = items(&page);
    if arguments.json {
        datasets.iter().for_each(|dataset| println!("{dataset}"));
        return Ok(());
    }
    println!("{}", table_of(&["name", "images", "bytes", "jobs"], datasets));
    println!("{} datasets", datasets.len());
    Ok(())
}
