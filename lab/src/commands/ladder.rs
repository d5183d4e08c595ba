//! `fathom-lab ladder`: the change by each effect of the published chain in a water, from attenuation alone to all effects.

use std::path::PathBuf;

use cli::exit::Failure;
use cli::files;
use cli::sheet::{Tile, sheet};
use cli::styles::StyleArguments;
use cli::table::table;
use imaging::{Rgb8, transfer};
use lab::chart::{difference, time};
use serde_json::{Value, json};

use crate::machine;
use crate::studio::{Studio, raster};

/// Options of `fathom-lab ladder`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Optical water
    #[arg(long, default_value = "jerlov-3C")]
    water: String,
    /// Procedural scene, FAMILY:SEED
    #[arg(long, default_value = "structure:7")]
    scene: String,
    /// Factor of all distances
    #[arg(long, default_value_t = 1.0)]
    range_scale: f64,
    /// Style water of the upper rungs
    #[arg(long)]
    style_name: Option<String>,
    /// Where to write the sheet (.png, .jpg or .webp); the figures are written next to it as .md
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    style: StyleArguments,
}

const TILE_PX: usize = 384;
const RUNS: usize = 5;
/// Brightness of the constant veil.
const VEIL_GAIN: f64 = 0.3;
/// The stages that rungs add.
const COUNTED: [&str; 3] = ["water", "style", "haze"];

/// A rung: its name, its forward scatter, whether it has a style and haze.
const RUNGS: [(&str, &str, bool, bool); 5] = [
    ("attenuation only", "none", false, false),
    ("+ gathered scatter (Eq. 8-9)", "simplified", false, false),
    ("+ Jaffe-McGlamery instead", "jaffe", false, false),
    ("+ style, alpha = 0.4", "jaffe", true, false),
    ("+ haze of two lights", "jaffe", true, true),
];

/// A rendered rung.
struct Rung {
    name: &'static str,
    picture: Rgb8,
    ms: f64,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let library = arguments.style.library()?;
    let native = |name: &&str| !library.needs_runtime(name);
    let style = match &arguments.style_name {
        Some(name) => name.clone(),
        None => library
            .names()
            .into_iter()
            .find(native)
            .unwrap_or_default()
            .to_owned(),
    };
    let mut studio = Studio::new(library, arguments.style.onnxruntime.as_deref());
    let mut rungs = Vec::new();
    for (name, model, styled, lit) in RUNGS {
        let description = description(arguments, model, Some(style.as_str()).filter(|_| styled), lit)?;
        let frame = studio.frame(&description, 0)?;
        let mut costs = Vec::new();
        let (_, rendered) = time(RUNS, || {
            let rendered = studio.render(&frame);
            let stages = rendered
                .as_ref()
                .map(|r| COUNTED.map(|s| r.record.timings_ms.get(s).copied().unwrap_or(0.0)));
            costs.extend(stages.map(|stages| stages.iter().sum::<f64>()));
            rendered
        });
        let picture = raster(&rendered?, "rgb")?.to_rgb8();
        let ms = costs.into_iter().fold(f64::INFINITY, f64::min);
        rungs.push(Rung { name, picture, ms });
    }
    let rows = rows(&rungs);
    let tile = |(rung, row): (&Rung, &Vec<String>)| Tile {
        picture: rung.picture.clone(),
        caption: vec![
            rung.name.to_owned(),
            format!("to the one before: {} codes, dE {}", row[1], row[2]),
            format!("to the fullest:    {} codes, dE {}", row[3], row[4]),
            format!("{} ms", row[5]),
        ],
    };
    let tiles: Vec<Tile> = rungs.iter().zip(&rows).map(tile).collect();
    files::write_picture(&arguments.out, &sheet(&tiles, 3, TILE_PX).into())?;
    let columns = [
        "rung",
        "codes to the one before",
        "dE",
        "codes to the fullest",
        "dE to the fullest",
        "ms",
    ];
    let mut text = format!(
        "{}, {}; {}.\n\n| {} |\n|{}\n",
        arguments.water,
        arguments.scene,
        machine::describe(),
        columns.join(" | "),
        "---|".repeat(columns.len())
    );
    rows.iter()
        .for_each(|row| text.push_str(&format!("| {} |\n", row.join(" | "))));
    files::write(&arguments.out.with_extension("md"), text.as_bytes())?;
    println!("{}", table(&columns, &rows));
    println!("{}", arguments.out.display());
    Ok(())
}

/// Name, differences to the previous and to the last rung (largest codes, mean ΔE), fastest run.
fn rows(rungs: &[Rung]) -> Vec<Vec<String>> {
    let compare = |a: &Rung, b: &Rung| {
        let d = difference(
            &transfer::decode_rgb8(&a.picture),
            &transfer::decode_rgb8(&b.picture),
        );
        [d.codes.to_string(), format!("{:.2}", d.delta_e)]
    };
    let row = |(index, rung): (usize, &Rung)| {
        let before = index.checked_sub(1).map(|before| compare(rung, &rungs[before]));
        let [codes, delta] = before.unwrap_or_else(|| ["-".to_owned(), "-".to_owned()]);
        let [full_codes, full_delta] = compare(rung, &rungs[rungs.len() - 1]);
        vec![
            rung.name.to_owned(),
            codes,
            delta,
            full_codes,
            full_delta,
            format!("{:.1}", rung.ms),
        ]
    };
    rungs.iter().enumerate().map(row).collect()
}

fn description(arguments: &Arguments, model: &str, style: Option<&str>, lit: bool) -> Result<Value, Failure> {
    let bad = || Failure::BadInput(format!("--scene {} must be FAMILY:SEED", arguments.scene));
    let (family, seed) = arguments.scene.split_once(':').ok_or_else(bad)?;
    let seed: u64 = seed.parse().map_err(|_| bad())?;
    let mut water = json!({
        "optics": {"preset": arguments.water, "veil_gain": VEIL_GAIN, "forward_scatter": {"model": model}},
        "range_scale": arguments.range_scale,
    });
    if let Some(style) = style {
        water["style"] = json!(style);
    }
    let light = |x: f64| json!({"kind": "haze", "x": x, "y": 1, "size": 0.2, "intensity": 0.9});
    let lights: Vec<Value> = [0.0, 1.0].into_iter().filter(|_| lit).map(light).collect();
    let mut description = json!({
        "scene": {"kind": "procedural", "family": family, "seed": seed, "lighting": "in_air"},
        "camera": {"width": 768, "height": 492, "hfov_deg": 80},
        "water": water, "lights": lights, "metrics": [], "artifacts": ["rgb"]
    });
    if style.is_some() {
        description["alpha"] = json!(0.4);
    }
    Ok(description)
}
