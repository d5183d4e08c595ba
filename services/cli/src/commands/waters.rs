//! `fathom waters`: the optical presets with their numbers and sources.

use optics::preset::{Preset, presets};
use serde_json::json;

use crate::exit::Failure;
use crate::table::{decimal, table};

/// Options of `fathom waters`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Print one JSON array
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.json {
        let all: Vec<_> = presets().iter().map(describe).collect();
        println!("{}", json!(all));
        return Ok(());
    }
    let triple = |values: Option<[f64; 3]>| {
        values.map_or_else(
            || "–".to_owned(),
            |v| v.map(|x| decimal((x * 1e4).round() / 1e4)).join(" "),
        )
    };
    let rows: Vec<Vec<String>> = presets()
        .iter()
        .map(|preset| {
            vec![
                preset.name.to_owned(),
                triple(preset.wavelength_nm),
                triple(preset.absorption),
                triple(preset.scattering),
                triple(preset.beam_attenuation),
                triple(preset.diffuse_attenuation),
                if preset.unrenderable().is_none() {
                    "yes"
                } else {
                    "no"
                }
                .to_owned(),
            ]
        })
        .collect();
    println!(
        "{}",
        table(
            &[
                "water (R G B)",
                "nm",
                "a [1/m]",
                "b [1/m]",
                "c [1/m]",
                "Kd [1/m]",
                "renders"
            ],
            &rows
        )
    );
    println!("\nSources and caveats: fathom waters --json");
    Ok(())
}

fn describe(preset: &Preset) -> serde_json::Value {
    json!({
        "name": preset.name,
        "source": preset.source,
        "licence": preset.licence,
        "caveats": preset.caveats,
        "wavelength_nm": preset.wavelength_nm,
        "absorption_per_m": preset.absorption,
        "scattering_per_m": preset.scattering,
        "beam_attenuation_per_m": preset.beam_attenuation,
        "diffuse_attenuation_per_m": preset.diffuse_attenuation,
        "veiling_light": preset.veiling_light,
        "unrenderable": preset.unrenderable(),
    })
}
