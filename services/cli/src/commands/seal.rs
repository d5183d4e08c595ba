//! `fathom seal`: makes the next version of a dataset; of a set this command becomes `fathom-cluster`.

use cli::exit::Failure;
use cli::known;
use cli::remote::{Remote, encode};
use cli::seal::{SealArguments, is_set};
use cli::table::cell;

use super::cluster;

/// Runs the command.
pub(crate) fn run(arguments: &SealArguments) -> Result<(), Failure> {
    let name = &arguments.what;
    if is_set(name) {
        return cluster::hand_over();
    }
    let remote = Remote::with_patience(&arguments.server);
    if known::version(name).is_some() {
        return Err(Failure::BadInput(format!(
            "`{name}` is the name of a version: seal the dataset itself"
        )));
    }
    known::dataset(&remote, name)?;
    let version = remote.post(&format!("/v1/datasets/{}/versions", encode(name)), &[], b"")?;
    if arguments.json {
        println!("{version}");
        return Ok(());
    }
    let codes = version["code_versions"]
        .as_array()
        .into_iter()
        .flatten()
        .map(cell);
    println!(
        "{} · {} images of {} jobs · made by {}",
        cell(&version["name"]),
        cell(&version["images"]),
        cell(&version["jobs"]),
        codes.collect::<Vec<_>>().join(", ")
    );
    println!("root {}", cell(&version["root"]));
    Ok(())
}
