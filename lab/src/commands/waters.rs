//! `fathom-lab waters`: drawings of the waters, and scenes in them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Context;
use cli::exit::Failure;
use cli::files;
use cli::sheet::{Tile, sheet};
use cli::styles::StyleArguments;
use imaging::{Rgb8, Samples};
use lab::waters;
use renderer::Rendered;
use serde_json::{Value, json};
use spec::Frame;

use crate::studio::{Studio, raster};
use crate::{drawing, machine};

/// Options of `fathom-lab waters`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Folder for the drawings
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Draw only the plots, without the slow sheets of scenes
    #[arg(long)]
    no_scenes: bool,
    #[command(flatten)]
    style: StyleArguments,
}

const WALL_PX: usize = 256;
const WALL_SEED: u64 = 3;
const FAMILY_PX: usize = 256;
const FAMILY_SEEDS: [u64; 2] = [3, 11];
/// Runs of each frame; the fastest counts.
const RUNS: usize = 9;
const STYLE: &str = "mediterranean";

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    plots(&arguments.out)?;
    match arguments.no_scenes {
        true => Ok(()),
        false => sheets(&arguments.out, &arguments.style),
    }
}

/// Writes the plots into a folder.
fn plots(out: &Path) -> Result<(), Failure> {
    drawing::write(out, "transmittance", &waters::transmittance())?;
    drawing::write(out, "daylight", &waters::daylight())?;
    drawing::write(out, "grey-cards", &waters::grey_cards())?;
    drawing::write(out, "visibility-range", &waters::visibility_over_range())?;
    drawing::write(out, "visibility-turbidity", &waters::visibility_over_turbidity())
}

/// Writes the sheets of scenes into a folder, with their milliseconds.
fn sheets(out: &Path, style: &StyleArguments) -> Result<(), Failure> {
    let mut pictures = Pictures {
        studio: Studio::new(style.library()?, style.onnxruntime.as_deref()),
    };
    save(&out.join("wall.png"), pictures.wall()?)?;
    let mut costs = Vec::new();
    for family in scenes::FAMILIES {
        let (picture, cost) = pictures.family(family)?;
        save(&out.join(format!("{family}.png")), picture)?;
        costs.extend(cost);
    }
    let path = out.join("stages.md");
    files::write(&path, stages(&costs).as_bytes())?;
    println!("{}", path.display());
    Ok(())
}

fn save(path: &Path, picture: Rgb8) -> Result<(), Failure> {
    files::write_picture(path, &picture.into())?;
    println!("{}", path.display());
    Ok(())
}

/// Stages of one frame: scene, water, milliseconds of each.
type Cost = (String, String, BTreeMap<String, f64>);

struct Pictures {
    studio: Studio,
}

impl Pictures {
    /// The same wall in Jerlov I to 9C.
    fn wall(&mut self) -> Result<Rgb8, Failure> {
        let camera = json!({"width": 600, "height": 400, "hfov_deg": 70});
        let mut tiles = vec![];
        let names = waters::TYPES.map(|kind| format!("jerlov-{kind}"));
        for name in [None].into_iter().chain(names.iter().map(Some)) {
            let water = name.map_or_else(|| json!({}), |name| json!({"optics": name}));
            let (rendered, _) = self.render("structure", WALL_SEED, &camera, &water)?;
            let caption = name.map_or("in air", |name| {
                optics::preset::find(name).map_or(name, |p| p.name.as_str())
            });
            tiles.push(Tile {
                picture: raster(&rendered, "rgb")?.to_rgb8(),
                caption: vec![
                    caption.to_owned(),
                    format!("at {:.1} m", middle_range(&rendered)?),
                ],
            });
        }
        Ok(sheet(&tiles, 4, WALL_PX))
    }

    /// Scenes of a family in air and in four waters.
    fn family(&mut self, family: &str) -> Result<(Rgb8, Vec<Cost>), Failure> {
        let camera = json!({"width": 768, "height": 492, "hfov_deg": 80});
        let styled = json!({"optics": "jerlov-II", "style": STYLE});
        let waters = [
            ("in air".to_owned(), json!({})),
            ("jerlov-IB".to_owned(), json!({"optics": "jerlov-IB"})),
            ("jerlov-III".to_owned(), json!({"optics": "jerlov-III"})),
            ("jerlov-3C".to_owned(), json!({"optics": "jerlov-3C"})),
            (format!("II + {STYLE}"), styled),
        ];
        let (mut tiles, mut costs) = (Vec::new(), Vec::new());
        for seed in FAMILY_SEEDS {
            for (name, water) in &waters {
                let (rendered, ms) = self.render(family, seed, &camera, water)?;
                let caption = vec![
                    format!("{family} {seed}, {name}"),
                    format!("middle range {:.1} m", middle_range(&rendered)?),
                ];
                tiles.push(Tile {
                    picture: raster(&rendered, "rgb")?.to_rgb8(),
                    caption,
                });
                costs.push((format!("{family} {seed}"), name.clone(), ms));
            }
        }
        Ok((sheet(&tiles, waters.len(), FAMILY_PX), costs))
    }

    fn frame(&self, family: &str, seed: u64, camera: &Value, water: &Value) -> Result<Frame, Failure> {
        let mut document = json!({"scene": {"kind": "procedural", "family": family, "seed": seed, "lighting": "in_air"},
            "camera": camera, "water": water, "artifacts": ["rgb", "range"], "metrics": []});
        if water.get("style").is_some() {
            document["alpha"] = json!(0.6);
        }
        self.studio.frame(&document, 0)
    }

    /// Renders a frame; returns the least milliseconds of each stage.
    fn render(
        &mut self,
        family: &str,
        seed: u64,
        camera: &Value,
        water: &Value,
    ) -> Result<(Rendered, BTreeMap<String, f64>), Failure> {
        let frame = self.frame(family, seed, camera, water)?;
        let between = self.frame(family, seed + 1, &json!({"width": 8, "height": 8}), &json!({}))?;
        let mut least: BTreeMap<String, f64> = BTreeMap::new();
        let mut last = None;
        for _ in 0..RUNS {
            // A slot caches its last scene; rendering another one in between forces a new measurement.
            self.studio.render(&between)?;
            let rendered = self.studio.render(&frame)?;
            for (stage, &ms) in &rendered.record.timings_ms {
                let known = least.entry(stage.clone()).or_insert(ms);
                *known = known.min(ms);
            }
            last = Some(rendered);
        }
        Ok((last.context("at least one run")?, least))
    }
}

/// The median range, m.
fn middle_range(rendered: &Rendered) -> Result<f64, Failure> {
    let raster = raster(rendered, "range")?;
    let mut codes: Vec<u16> = match raster.samples() {
        Samples::U16(codes) => codes.iter().copied().filter(|&code| code > 0).collect(),
        Samples::U8(_) => Vec::new(),
    };
    codes.sort_unstable();
    let middle = codes.get(codes.len() / 2).context("a frame with a range")?;
    Ok(f64::from(*middle) / 1000.0)
}

/// A table of the milliseconds.
fn stages(costs: &[Cost]) -> String {
    const STAGES: [&str; 9] = [
        "scene", "plan", "water", "style", "haze", "encode", "labels", "files", "total",
    ];
    let mut text = format!(
        "Milliseconds of each stage at 768x492 on one core, the fastest of {RUNS} runs; {}.\n\n| frame | in | {} |\n|---|---|{}\n",
        machine::describe(),
        STAGES.join(" | "),
        "---:|".repeat(STAGES.len())
    );
    for (scene, water, ms) in costs {
        let cells = STAGES.map(|name| {
            ms.get(name)
                .map_or_else(|| "-".to_owned(), |ms| format!("{ms:.1}"))
        });
        text.push_str(&format!("| {scene} | {water} | {} |\n", cells.join(" | ")));
    }
    text
}
