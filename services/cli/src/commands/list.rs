//! `fathom list`: every identifier that a user can send, from the declaration that the API reads too.

use api::{Entry, List};
use cli::exit::Failure;
use cli::remote::{Remote, ServerArguments, encode};
use cli::styles::StyleArguments;
use cli::table::text_table;
use serde_json::{Value, json};

/// Options of `fathom list`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Which list; without it: the lists
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
            let names = stored(&Remote::new(&arguments.server), path.unwrap_or_default())?;
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
        let list = |list: &List| json!({"name": list.name, "about": list.about, "places": list.places, "path": list.path(), "command": list.command()});
        let lists: Vec<Value> = List::all().iter().map(list).collect();
        println!("{}", json!(lists));
        return;
    }
    let row = |list: &List| vec![list.name.to_owned(), list.about.to_owned(), list.path()];
    let rows: Vec<_> = List::all().iter().map(row).collect();
    println!("{}", text_table(&["list", "what it names", "endpoint"], &rows));
    println!("\nfathom list NAME prints one of them; docs/reference/identifiers.md says where each is sent.");
}

/// The entries as a table with the columns that any of them fills.
fn entries_table(entries: &[Entry]) -> String {
    type Cell = fn(&Entry) -> String;
    let columns: [(&str, Cell); 4] = [
        ("name", |entry| entry.name.clone()),
        ("number", |entry| {
            entry.number.map_or_else(String::new, |number| number.to_string())
        }),
        ("unit", |entry| entry.unit.unwrap_or_default().to_owned()),
        ("meaning", |entry| entry.about.clone()),
    ];
    let (header, cells): (Vec<&str>, Vec<Cell>) = columns
        .into_iter()
        .filter(|(_, cell)| entries.iter().any(|entry| !cell(entry).is_empty()))
        .unzip();
    let row = |entry: &Entry| cells.iter().map(|cell| cell(entry)).collect();
    let rows: Vec<Vec<String>> = entries.iter().map(row).collect();
    text_table(&header, &rows)
}

/// The names or ids of everything that a service lists at this path.
fn stored(remote: &Remote, path: &str) -> Result<Vec<String>, Failure> {
    let mut names = Vec::new();
    let mut page = remote.get(path)?;
    loop {
        let items = page["items"].as_array().cloned().unwrap_or_default();
        let name = |item: &Value| {
            item.get("name")
                .or_else(|| item.get("id"))
                .and_then(Value::as_str)
                .map(str::to_owned)
        };
        names.extend(items.iter().filter_map(name));
        match page["next_cursor"].as_str() {
            Some(cursor) => page = remote.get(&format!("{path}?cursor={}", encode(cursor)))?,
            None => return Ok(names),
        }
    }
}
