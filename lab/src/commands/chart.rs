//! `fathom-lab chart`: error against time of the variants of each stage.

mod style;

use std::path::{Path, PathBuf};

use ::style::Library;
use anyhow::Context;
use cli::exit::Failure;
use cli::files;
use cli::progress::Progress;
use imaging::geometry::Intrinsics;
use lab::chart::{
    self, ChartScene, Measure, Point, STAGES, cost, cost_chart, csv, error_chart, error_sheet, mark_pareto,
    standard_scenes, summary,
};
use scenes::uploaded::decode;
use serde_json::json;
use spec::{RangeFile, RangeKind, SceneFiles};

use crate::{drawing, machine};

/// Options of `fathom-lab chart`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Only this stage
    #[arg(long, value_parser = clap::builder::PossibleValuesParser::new(STAGES.into_iter().chain([style::STAGE, "cost"])))]
    stage: Option<String>,
    /// A picture that replaces the standard scenes; needs --range
    #[arg(long, value_name = "FILE", requires = "range")]
    scene: Option<PathBuf>,
    /// Range of the picture in meters along the ray, a float file (.npy)
    #[arg(long, value_name = "FILE")]
    range: Option<PathBuf>,
    /// Folder for chart.json (the points), chart.csv, machine.json, figures.md and the drawings
    #[arg(long, value_name = "DIR", default_value = "charts")]
    out: PathBuf,
    /// Columns of the standard scenes; rows follow as 492 to 768
    #[arg(long, default_value_t = 768, value_parser = clap::value_parser!(u32).range(16..=4096))]
    width: u32,
    /// Runs of each variant
    #[arg(long, default_value_t = 9, value_parser = clap::value_parser!(u32).range(1..=1000))]
    runs: u32,
    /// Largest frame of the cost chart in megapixels
    #[arg(long, default_value_t = 16.0)]
    megapixels: f64,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let runs = arguments.runs as usize;
    let wanted = |stage: &str| arguments.stage.as_deref().is_none_or(|only| only == stage);
    let scenes = match (&arguments.scene, &arguments.range) {
        (Some(picture), Some(range)) => vec![own(picture, range)?],
        _ => standard(arguments.width as usize)?,
    };
    let stages: Vec<&str> = STAGES
        .into_iter()
        .chain([style::STAGE])
        .filter(|stage| wanted(stage))
        .collect();
    let library = Library::embedded().context("the embedded style models")?;
    let mut progress = Progress::new("chart", "stages", (scenes.len() * stages.len()) as u64 + 1);
    let mut points: Vec<Point> = Vec::new();
    let mut done = 0;
    for scene in &scenes {
        for stage in &stages {
            points.extend(match *stage {
                "forward_scatter" => chart::forward_scatter(scene, runs),
                "haze" => chart::haze(scene, runs),
                "homomorphic" => chart::homomorphic(scene, runs),
                "ibla" => chart::ibla(scene, runs),
                "lamps" => chart::glow(scene, runs),
                style::STAGE => style::tiers(scene, &library, runs),
                _ => chart::whole_frame(scene, runs),
            });
            done += 1;
            progress.set(done);
        }
    }
    mark_pareto(&mut points);
    if wanted("cost") {
        points.extend(cost(runs, arguments.megapixels));
    }
    progress.finish();
    for scene in &scenes {
        for stage in &stages {
            let of = |p: &&Point| p.stage == *stage && p.scene == scene.name;
            let of: Vec<Point> = points.iter().filter(of).cloned().collect();
            let title = format!(
                "{stage}, {}, {}x{}",
                scene.name,
                scene.range.width(),
                scene.range.height()
            );
            let name = format!("{stage}-{}", scene.name);
            drawing::write(&arguments.out, &name, &error_chart(&title, &of, Measure::Max))?;
            drawing::write(
                &arguments.out,
                &format!("{name}-measures"),
                &error_sheet(&title, &of),
            )?;
        }
    }
    if wanted("cost") {
        drawing::write(&arguments.out, "cost-size", &cost_chart(&points, false))?;
        drawing::write(&arguments.out, "cost-terms", &cost_chart(&points, true))?;
    }
    let text = serde_json::to_string_pretty(&points).context("points as JSON")?;
    files::write(&arguments.out.join("chart.json"), text.as_bytes())?;
    let about = json!({"machine": machine::describe(), "version": env!("CARGO_PKG_VERSION"), "runs": runs});
    let about = serde_json::to_string_pretty(&about).context("the machine as JSON")?;
    files::write(&arguments.out.join("machine.json"), about.as_bytes())?;
    let scene = scenes.last().context("at least one scene")?;
    let tables = format!(
        "# Figures of the charts\n\nWritten by `fathom-lab chart`: {}; {runs} runs of each, after one to warm up.\n{}",
        machine::describe(),
        summary(&points, scene)
    );
    files::write(&arguments.out.join("figures.md"), tables.as_bytes())?;
    files::write(&arguments.out.join("chart.csv"), csv(&points).as_bytes())?;
    println!("{} points: {}", points.len(), arguments.out.display());
    Ok(())
}

/// The standard scenes and a procedural structure.
fn standard(width: usize) -> Result<Vec<ChartScene>, Failure> {
    let height = (width * 492 / 768).max(1);
    let mut all = standard_scenes(width, height);
    let camera = Intrinsics::centered(width as f64 / (2.0 * 40f64.to_radians().tan()), width, height);
    let scene = scenes::procedural("structure", 7, width, height, camera).context("a known family")?;
    let range = scene.range.context("procedural scenes have range")?;
    all.push(ChartScene::new("structure", scene.radiance, &range));
    Ok(all)
}

/// A picture and its range.
fn own(picture: &Path, range: &Path) -> Result<ChartScene, Failure> {
    let (rgb, meters) = (files::read(picture)?, files::read(range)?);
    let upload = SceneFiles {
        rgb,
        range: Some(RangeFile {
            file: meters,
            kind: RangeKind::Range,
            unit_m: None,
            invalid_code: None,
        }),
        intrinsics: None,
        classes: None,
        world_from_camera: None,
        instances: None,
    };
    let bad = |message: String| Failure::BadInput(format!("{}: {message}", picture.display()));
    let scene = decode(&upload).map_err(|error| bad(error.to_string()))?;
    let plane = scene.range.context("a range was given")?;
    let name = picture.file_stem().and_then(|s| s.to_str()).unwrap_or("scene");
    Ok(ChartScene::new(name, scene.radiance, &plane))
}
