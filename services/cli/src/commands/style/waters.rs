//! `fathom waters`: lists the optical waters of this program or of a service, and adds one to a service.

mod add;

use api::water_view;
use cli::exit::Failure;
use cli::remote::OtherServer;
use cli::table::{DASH, decimal, table};
use client::WaterView;
use optics::preset::presets;
use serde_json::json;

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
    /// Add a custom water to a service, for immediate use in jobs
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
    let waters: Vec<WaterView> = match arguments.server.client() {
        Some(client) => client.list("/v1/waters")?,
        None => presets().iter().map(|preset| water_view(preset, None)).collect(),
    };
    if arguments.json {
        println!("{}", json!(waters));
        return Ok(());
    }
    let rows: Vec<Vec<String>> = waters.iter().map(row).collect();
    println!("{}", table(&HEADER, &rows));
    println!("\n–, ?: not known. Sources, licenses, caveats and what is derived: fathom waters --json");
    Ok(())
}

/// A water in the numbers of its source.
fn row(water: &WaterView) -> Vec<String> {
    let is_derived = water.derived.iter().any(|name| name == "backscatter_fraction");
    let backscatter = water.backscatter_fraction.filter(|_| !is_derived);
    let notes = water.warnings.len() + water.defects.len();
    vec![
        water.name.clone(),
        channels(water.wavelength_nm),
        channels(water.absorption_per_m),
        channels(water.scattering_per_m),
        channels(water.beam_attenuation_per_m),
        channels(water.diffuse_attenuation_per_m),
        backscatter.map_or_else(|| DASH.to_owned(), four_decimals),
        if water.unrenderable.is_none() { "yes" } else { "no" }.to_owned(),
        if notes > 0 {
            notes.to_string()
        } else {
            String::new()
        },
    ]
}

fn channels(values: Option<[Option<f64>; 3]>) -> String {
    let Some(values) = values else {
        return DASH.to_owned();
    };
    values
        .map(|value| value.map_or_else(|| "?".to_owned(), four_decimals))
        .join(" ")
}

fn four_decimals(value: f64) -> String {
    decimal((value * 1e4).round() / 1e4)
}
