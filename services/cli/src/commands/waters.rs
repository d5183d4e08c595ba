//! `fathom waters`: lists the optical waters of this program or of a service, and adds one to a service.

mod add;

use api::WaterView;
use cli::exit::Failure;
use cli::known::items;
use cli::remote::OtherServer;
use cli::table::{cell, decimal, table};
use optics::preset::presets;
use serde_json::{Value, json};

/// Options of `fathom waters`.
#[derive(clap::Args)]
#[command(args_conflicts_with_subcommands = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    action: Option<Action>,
    /// Print one JSON array, with sources, licenses and caveats
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    server: OtherServer,
}

#[derive(clap::Subcommand)]
enum Action {
    /// Add a water of your own to a service, for jobs to name at once
    Add(add::Arguments),
}

const HEADER: [&str; 9] = [
    "water (R G B)",
    "nm",
    "a [1/m]",
    "b [1/m]",
    "c [1/m]",
    "Kd [1/m]",
    "bb/b",
    "renders",
    "warnings",
];

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(Action::Add(arguments)) = &arguments.action {
        return add::run(arguments);
    }
    let waters: Vec<Value> = match arguments.server.remote() {
        Some(remote) => items(&remote.get("/v1/waters")?).to_vec(),
        None => presets()
            .iter()
            .map(|preset| json!(WaterView::new(preset, None)))
            .collect(),
    };
    if arguments.json {
        println!("{}", Value::Array(waters));
        return Ok(());
    }
    let rows: Vec<Vec<String>> = waters.iter().map(row).collect();
    println!("{}", table(&HEADER, &rows));
    println!("\n–, ?: not known. Sources, licenses, caveats and what is derived: fathom waters --json");
    Ok(())
}

/// A water in the source's own numbers.
fn row(water: &Value) -> Vec<String> {
    let rounded = |value: &Value| value.as_f64().map(|x| decimal((x * 1e4).round() / 1e4));
    let triple = |name: &str| match water[name].as_array() {
        None => "–".to_owned(),
        Some(values) => {
            let values = values
                .iter()
                .map(|value| rounded(value).unwrap_or_else(|| "?".to_owned()));
            values.collect::<Vec<_>>().join(" ")
        }
    };
    let count = |name: &str| water[name].as_array().map_or(0, Vec::len);
    let derived = water["derived"].as_array().into_iter().flatten();
    let is_own = !derived.into_iter().any(|name| name == "backscatter_fraction");
    let backscatter = rounded(&water["backscatter_fraction"]).filter(|_| is_own);
    let notes = count("warnings") + count("defects");
    vec![
        cell(&water["name"]),
        triple("wavelength_nm"),
        triple("absorption_per_m"),
        triple("scattering_per_m"),
        triple("beam_attenuation_per_m"),
        triple("diffuse_attenuation_per_m"),
        backscatter.unwrap_or_else(|| "–".to_owned()),
        if water["unrenderable"].is_null() {
            "yes"
        } else {
            "no"
        }
        .to_owned(),
        if notes > 0 {
            notes.to_string()
        } else {
            String::new()
        },
    ]
}
