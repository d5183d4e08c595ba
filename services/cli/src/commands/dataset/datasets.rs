//! `fathom datasets`: lists the datasets of a service, and the sealed versions of one.

use cli::exit::Failure;
use cli::known;
use cli::plural::{count, describe_bytes};
use cli::remote::ServerArguments;
use cli::table::table;
use client::{DatasetRow, VersionRow};
use serde_json::json;

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
    let client = arguments.server.client();
    let Some(name) = &arguments.dataset else {
        print_datasets(&client.datasets()?, arguments.json);
        return Ok(());
    };
    known::dataset(&client, name)?;
    let versions = client.versions(name)?.unwrap_or_default();
    print_versions(&versions, arguments.json);
    Ok(())
}

fn print_datasets(datasets: &[DatasetRow], as_json: bool) {
    if as_json {
        datasets.iter().for_each(|dataset| println!("{}", json!(dataset)));
        return;
    }
    let rows: Vec<Vec<String>> = datasets
        .iter()
        .map(|row| {
            vec![
                row.name.clone(),
                row.images.to_string(),
                describe_bytes(row.bytes as f64),
                row.jobs.to_string(),
            ]
        })
        .collect();
    println!("{}", table(&["name", "images", "size", "jobs"], &rows));
    println!("{}", count(rows.len(), "dataset"));
}

fn print_versions(versions: &[VersionRow], as_json: bool) {
    if as_json {
        versions.iter().for_each(|version| println!("{}", json!(version)));
        return;
    }
    let rows: Vec<Vec<String>> = versions
        .iter()
        .map(|row| {
            vec![
                row.name.clone(),
                row.images.to_string(),
                describe_bytes(row.bytes as f64),
                row.jobs.to_string(),
                row.created_at.to_string(),
                row.root.clone(),
            ]
        })
        .collect();
    let header = ["name", "images", "size", "jobs", "created_at", "root"];
    println!("{}", table(&header, &rows));
    println!("{}", count(rows.len(), "sealed version"));
}
