//! `fathom-lab stability`: failure regions of methods, as maps, data and text.

mod chain;
mod styles;

use std::path::PathBuf;

use cli::exit::Failure;
use cli::files;
use cli::progress::Progress;
use cli::styles::StyleArguments;
use imaging::{Rgb8, codec};
use lab::stability::{METRICS, Specimen, csv, gain_map, markdown, metric_map, run as measure, ssim_map};
use serde_json::json;
use style::{Runtime, StyleModel};

use crate::studio::{Studio, raster};
use crate::{drawing, machine};

/// Options of `fathom-lab stability`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The enhancements and the metrics
    #[arg(long, required_unless_present_any = ["style", "chain"])]
    enhance: bool,
    /// The chain of the water: hostile frames, each against its limit
    #[arg(long, conflicts_with_all = ["enhance", "style"])]
    chain: bool,
    /// The style models, and a network with instance normalization as a control; needs ONNX Runtime
    #[arg(long, conflicts_with = "enhance")]
    style: bool,
    #[command(flatten)]
    style_arguments: StyleArguments,
    /// Folder for stability.md, stability.csv and the maps; of styles: style-stability.md; of the chain: stability-chain.md
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Scenes of each cell
    #[arg(long, default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=1000))]
    scenes: u32,
}

/// Large enough for the windows of every method, small enough for thousands of runs.
const SIZE: (usize, usize) = (256, 164);

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.chain {
        return chain::run(&arguments.out);
    }
    if arguments.style {
        return of_styles(arguments);
    }
    let specimens = specimens(u64::from(arguments.scenes))?;
    let jpeg = |picture: &Rgb8, quality: u8| {
        let coded = codec::encode_jpeg(picture, quality).ok();
        let decoded = coded.and_then(|bytes| codec::decode_picture(&bytes).ok());
        decoded.map_or_else(|| picture.clone(), |raster| raster.to_rgb8())
    };
    let methods: Vec<Option<&'static str>> = std::iter::once(None)
        .chain(enhance::METHODS.iter().copied().map(Some))
        .collect();
    let mut progress = Progress::new("stability", "methods", methods.len() as u64);
    let mut runs = Vec::new();
    for method in methods {
        runs.push(measure(method, &specimens, &jpeg));
        progress.set(runs.len() as u64);
    }
    progress.finish();
    let mut maps = Vec::new();
    for cells in &runs {
        let name = cells.first().and_then(|cell| cell.method).unwrap_or("none");
        maps.push((format!("{name}-ssim"), ssim_map(cells)));
        maps.push((format!("{name}-gain"), gain_map(cells)));
    }
    for (index, metric) in METRICS.iter().enumerate() {
        maps.push((format!("metric-{metric}"), metric_map(&runs[0], index)));
    }
    for (name, map) in &maps {
        drawing::write(&arguments.out, name, map)?;
    }
    let about = format!(
        "{} scenes of {}x{}; {}.",
        arguments.scenes,
        SIZE.0,
        SIZE.1,
        machine::describe()
    );
    let pictures = |method: &str| format!("![SSIM]({method}-ssim.png) ![gain]({method}-gain.png)");
    let mut text = markdown(&runs, &about, pictures);
    text.push_str("\n## The metrics\n\nA metric without a reference can be led astray: here is what each says of the pictures as they are.\n\n");
    METRICS
        .iter()
        .for_each(|metric| text.push_str(&format!("![{metric}](metric-{metric}.png)\n")));
    files::write(&arguments.out.join("stability.md"), text.as_bytes())?;
    let cells: Vec<_> = runs.concat();
    files::write(&arguments.out.join("stability.csv"), csv(&cells).as_bytes())?;
    let failures: usize = cells.iter().map(|cell| cell.failures).sum();
    println!(
        "{} cells, {failures} failed runs or values that are not finite",
        cells.len()
    );
    println!("written to {}", arguments.out.join("stability.md").display());
    Ok(())
}

fn of_styles(arguments: &Arguments) -> Result<(), Failure> {
    let library = arguments.style_arguments.library()?;
    let runtime = Runtime::load(arguments.style_arguments.onnxruntime.as_deref())
        .map_err(|missing| Failure::RuntimeMissing(missing.to_string()))?;
    let control = StyleModel::without_card("johnson", lab::johnson(1));
    let found =
        styles::measure(&library, &control, &runtime).map_err(|error| Failure::Other(error.into()))?;
    let mut text = styles::markdown(&found);
    text.push_str(
        "\n![gain over noise](stability/style-gain.png)\n![change over move](stability/style-flicker.png)\n",
    );
    let path = arguments.out.join("style-stability.md");
    files::write(&path, text.as_bytes())?;
    for (name, lines) in styles::curves(&found) {
        drawing::write(&arguments.out.join("stability"), name, &lines)?;
    }
    print!("{text}");
    println!("written to {}", path.display());
    Ok(())
}

/// Scenes in air and in coastal water, rendered like those of any job.
fn specimens(count: u64) -> Result<Vec<Specimen>, Failure> {
    let mut studio = Studio::with_shipped_styles()?;
    let spec = json!({
        "count": count, "seed": 5, "camera": {"width": SIZE.0, "height": SIZE.1, "hfov_deg": 80},
        "scene": {"kind": "procedural", "family": {"choice": scenes::FAMILIES}, "seed": {"int": [0, 1_000_000]}},
        "water": {"optics": {"choice": ["jerlov-IB", "jerlov-II", "jerlov-1C"]}, "range_scale": 0.3},
        "artifacts": ["rgb", "clean"], "metrics": []
    });
    let specimen = |index: u64| {
        let frame = studio.frame(&spec, index)?;
        let rendered = studio.render(&frame)?;
        Ok(Specimen {
            clean: raster(&rendered, "clean")?.to_rgb8(),
            wet: raster(&rendered, "rgb")?.to_rgb8(),
        })
    };
    (0..count).map(specimen).collect()
}
