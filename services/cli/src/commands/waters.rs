//! `fathom waters`: the optical waters with their numbers and sources.

use api::WaterView;
use cli::exit::Failure;
use cli::table::{decimal, table};
use optics::preset::{Channels, Preset, presets};
use serde_json::json;

/// Options of `fathom waters`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Print one JSON array, with sources, licences and caveats
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.json {
        let all: Vec<_> = presets()
            .iter()
            .map(|preset| WaterView::new(preset, None))
            .collect();
        println!("{}", json!(all));
        return Ok(());
    }
    let rounded = |x: f64| decimal((x * 1e4).round() / 1e4);
    let triple = |values: Channels| match values {
        [None, None, None] => "–".to_owned(),
        values => values
            .map(|value| value.map_or_else(|| "?".to_owned(), rounded))
            .join(" "),
    };
    let row = |preset: &Preset| {
        let notes = preset.warnings.len() + preset.defects.len();
        vec![
            preset.name.clone(),
            triple(preset.wavelength_nm),
            triple(preset.absorption),
            triple(preset.scattering),
            triple(preset.beam_attenuation),
            triple(preset.diffuse_attenuation),
            preset
                .backscatter_fraction
                .map_or_else(|| "–".to_owned(), rounded),
            preset.unrenderable().map_or("yes", |_| "no").to_owned(),
            Some(notes)
                .filter(|&notes| notes > 0)
                .map_or_else(String::new, |notes| notes.to_string()),
        ]
    };
    let rows: Vec<Vec<String>> = presets().iter().map(row).collect();
    let head = [
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
    println!("{}", table(&head, &rows));
    println!("\n–, ?: not known. Sources, licences, caveats and what is derived: fathom waters --json");
    Ok(())
}
