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
    let (rows, more, what) = match &arguments.dataset {
        Some(name) => {
            known::dataset(&remote, name)?;
            let page = remote.get(&format!("/v1/datasets/{}/versions", encode(name)))?;
            let rows = items(&page).to_vec();
            (rows, &["created_at", "root"][..], "sealed versions")
        }
        None => (remote.rows("/v1/datasets", &[], usize::MAX)?, &[][..], "datasets"),
    };
    if arguments.json {
        rows.iter().for_each(|row| println!("{row}"));
        return Ok(());
    }
    println!(
        "{}",
        table_of(&[&["name", "images", "bytes", "jobs"], more].concat(), &rows)
    );
    println!("{} {what}", rows.len());
    Ok(())
}
