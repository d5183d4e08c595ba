//! `fathom seal`: makes the next version of a dataset.

use cli::exit::Failure;
use cli::known;
use cli::plural::count;
use cli::seal::{SealArguments, is_set};
use serde_json::json;

use crate::commands::sharded;

/// Runs the command.
pub(crate) fn run(arguments: &SealArguments) -> Result<(), Failure> {
    let name = &arguments.what;
    if is_set(name) {
        return sharded::seal::run(arguments);
    }
    let client = arguments.server.patient_client();
    if known::version(name).is_some() {
        return Err(Failure::BadInput(format!(
            "`{name}` is the name of a version: seal the dataset itself"
        )));
    }
    known::dataset(&client, name)?;
    let version = client.seal(name)?;
    if arguments.json {
        println!("{}", json!(version));
        return Ok(());
    }
    println!(
        "{} · {} of {} · made by {}",
        version.name,
        count(version.images, "image"),
        count(version.jobs, "job"),
        version.code_versions.join(", ")
    );
    println!("root {}", version.root);
    Ok(())
}
