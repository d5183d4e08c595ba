//! `fathom stability`: where methods fail, as maps, data and words.

mod chain;
mod styles;

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::Context;
use fidelity::plot::{self, HeatMap};
use fidelity::stability::{METRICS, Specimen, csv, gain_map, markdown, metric_map, run as measure, ssim_map};
use imaging::{Raster, Rgb8, codec};
use renderer::{Engine, SceneSource, Slot};
use serde_json::json;
use spec::Job;
use style::{Library, Runtime, StyleModel};

use crate::exit::Failure;
use crate::progress::Progress;
use crate::{files, machine};

/// Options of `fathom stability`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The enhancements and the metrics
    #[arg(long, required_unless_present_any = ["style", "chain"])]
    enhance: bool,
    /// The chain of the water: hostile frames, each against its limit
    #[arg(long, conflicts_with_all = ["enhance", "style"])]
    chain: bool,
    /// The style models, and a network with instance normalisation as a control; needs ONNX Runtime
    #[arg(long, conflicts_with = "enhance")]
    style: bool,
    #[command(flatten)]
    style_arguments: super::StyleArguments,
    /// Folder for stability.md, stability.csv and the maps; of styles: style-stability.md; of the chain: stability-chain.md
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Scenes of each cell
    #[arg(long, default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=1000))]
    scenes: u32,
}

/// Large enough for the windows of every method, small enough to run thousands.
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
    let mut progress = Progress::new("stability", methods.len() as u64);
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
        draw(arguments, name, map)?;
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

fn draw(arguments: &Arguments, name: &str, map: &HeatMap) -> Result<(), Failure> {
    let path = |extension: &str| arguments.out.join(format!("{name}.{extension}"));
    files::write(&path("svg"), plot::svg(map).context("cannot draw")?.as_bytes())?;
    let picture = plot::picture(map).context("cannot draw")?;
    files::write_picture(&path("png"), &Raster::from(picture))
}

fn of_styles(arguments: &Arguments) -> Result<(), Failure> {
    let library = super::styles::library(&arguments.style_arguments)?;
    let runtime = Runtime::load(arguments.style_arguments.onnxruntime.as_deref())
        .map_err(|missing| Failure::RuntimeMissing(missing.to_string()))?;
    let control = StyleModel::without_card("johnson", style::net::onnx::johnson(1));
    let found =
        styles::measure(&library, &control, &runtime).map_err(|error| Failure::Other(error.into()))?;
    let mut text = styles::markdown(&found);
    text.push_str(
        "\n![gain over noise](stability/style-gain.png)\n![change over move](stability/style-flicker.png)\n",
    );
    let path = arguments.out.join("style-stability.md");
    files::write(&path, text.as_bytes())?;
    for (name, lines) in styles::curves(&found) {
        super::chart::draw(&arguments.out.join("stability"), name, &lines)?;
    }
    print!("{text}");
    println!("written to {}", path.display());
    Ok(())
}

/// Scenes in air and in coastal water, rendered as any job renders them.
fn specimens(count: u64) -> Result<Vec<Specimen>, Failure> {
    let library = Library::embedded().context("the embedded style models")?;
    let vocabulary = renderer::vocabulary(&library, false);
    let spec = json!({
        "count": count, "seed": 5, "camera": {"width": SIZE.0, "height": SIZE.1, "hfov_deg": 80},
        "scene": {"kind": "procedural", "family": {"choice": scenes::FAMILIES}, "seed": {"int": [0, 1_000_000]}},
        "water": {"optics": {"choice": ["jerlov-IB", "jerlov-II", "jerlov-1C"]}, "range_scale": 0.3},
        "artifacts": ["rgb", "clean"], "metrics": []
    });
    let job =
        Job::parse(spec.to_string().as_bytes(), &vocabulary).context("the description of the specimens")?;
    let mut slot = Slot::new(&Arc::new(Engine::new(library, None)));
    let specimen = |index: u64| -> anyhow::Result<Specimen> {
        let frame = job.resolve(index)?;
        let rendered = slot.render(&frame, &SceneSource::Local)?;
        let picture = |kind: &str| {
            let file = rendered
                .files
                .iter()
                .find(|file| file.kind == kind)
                .context("a kind that was asked for")?;
            anyhow::Ok(codec::decode_picture(&file.bytes)?.to_rgb8())
        };
        Ok(Specimen {
            clean: picture("clean")?,
            wet: picture("rgb")?,
        })
    };
    Ok((0..count).map(specimen).collect::<anyhow::Result<_>>()?)
}
