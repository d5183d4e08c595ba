//! `fathom list`: every identifier that a user can send, from the same declarations as the API.

use api::{Entry, List};
use cli::exit::Failure;
use cli::remote::ServerArguments;
use cli::styles::StyleArguments;
use cli::table::text_table;
use cli::terminal::text_width;
use cli::wrap::paragraph;
use client::Client;
use serde::Deserialize;
use serde_json::{Value, json};

/// Options of `fathom list`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The list; without it: the names of the lists
    #[arg(value_parser = known())]
    what: Option<String>,
    /// Print one JSON array
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    style: StyleArguments,
    #[command(flatten)]
    server: ServerArguments,
}

fn known() -> Vec<&'static str> {
    List::all().iter().map(|list| list.name).collect()
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Some(list) = arguments.what.as_deref().and_then(List::parse) else {
        print_lists(arguments.json);
        return Ok(());
    };
    match (list.shipped, list.stored_at) {
        (Some(shipped), _) => {
            let entries = shipped(&arguments.style.library()?);
            if arguments.json {
                println!("{}", json!(entries));
            } else {
                println!("{}", entries_table(&entries));
            }
        }
        (None, path) => {
            let names = stored(&arguments.server.client(), path.unwrap_or_default())?;
            if arguments.json {
                println!("{}", json!(names));
            } else {
                names.iter().for_each(|name| println!("{name}"));
            }
        }
    }
    Ok(())
}

fn print_lists(as_json: bool) {
    if as_json {
        let lists: Vec<Value> = List::all().iter().map(|list: &List| json!({"name": list.name, "about": list.about, "places": list.places, "path": list.path(), "command": list.command()})).collect();
        println!("{}", json!(lists));
        return;
    }
    let rows: Vec<_> = List::all()
        .iter()
        .map(|list: &List| vec![list.name.to_owned(), list.about.to_owned(), list.path()])
        .collect();
    println!("{}", text_table(&["list", "what it names", "endpoint"], &rows));
    let hint =
        "fathom list NAME prints one of them; docs/reference/identifiers.md describes where each is used.";
    println!("\n{}", paragraph(hint, 0, text_width()));
}

/// The entries as a table with the columns that any of them fills.
fn entries_table(entries: &[Entry]) -> String {
    type Cell = fn(&Entry) -> String;
    let columns: [(&str, Cell); 4] = [
        ("name", |entry| entry.name.clone()),
        ("number", |entry| {
            entry.number.map_or_else(String::new, |number| number.to_string())
        }),
        ("unit", |entry| entry.unit.clone().unwrap_or_default()),
        ("meaning", |entry| entry.about.clone()),
    ];
    let (header, cells): (Vec<&str>, Vec<Cell>) = columns
        .into_iter()
        .filter(|(_, cell)| entries.iter().any(|entry| !cell(entry).is_empty()))
        .unzip();
    let rows: Vec<Vec<String>> = entries
        .iter()
        .map(|entry: &Entry| cells.iter().map(|cell| cell(entry)).collect())
        .collect();
    text_table(&header, &rows)
}

/// A row of a list that a service stores.
#[derive(Deserialize)]
struct StoredEntry {
    name: Option<String>,
    id: Option<String>,
}

/// The names or ids of everything that a service lists at this path.
fn stored(client: &Client, path: &str) -> Result<Vec<String>, Failure> {
    let entries: Vec<StoredEntry> = client.rows(path, &[], usize::MAX)?;
    Ok(entries
        .into_iter()
        .filter_map(|entry| entry.name.or(entry.id))
        .collect())
}
