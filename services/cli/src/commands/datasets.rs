//! `fathom datasets`: lists the datasets of a service, and the sealed versions of one.

use cli::exit::Failure;
use cli::known::{self, items};
use cli::remote::{Remote, ServerArguments, encode};
use cli::table::table_of;

/// Options of `fathom datasets`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// List the sealed versions of this dataset
    dataset: Option<String>,
    /// Print one JSON object per dataset or version
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    server: ServerArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let remote = Remote::new(&arguments.server);
    let (page, more, what) = match &arguments.dataset {
        Some(name) => {
            known::dataset(&remote, name)?;
            let page = remote.get(&format!("/v1/datasets/{}/versions", encode(name)))?;
            (page, &["created_at", "root"][..], "sealed versions")
        }
        None => (remote.get("/v1/datasets")?, &[][..], "datasets"),
    };
    let rows = items(&page);
    if arguments.json {
        rows.iter().for_each(|row| println!("{row}"));
        return Ok(());
    }
    println!(
        "{}",
        table_of(&[&["name", "images", "bytes", "jobs"], more].concat(), rows)
    );
    println!("{} {what}", rows.len());
    Ok(())
}
