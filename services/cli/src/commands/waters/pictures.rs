//! `fathom waters --plot`: drawings of the waters, and scenes in them.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use anyhow::Context;
use fidelity::plot::{Figure, picture, svg};
use fidelity::waters;
use imaging::{Raster, Rgb8, Samples, codec};
use renderer::{Engine, Rendered, SceneSource, Slot};
use serde_json::{Value, json};
use spec::{Frame, Job};

use crate::commands::{StyleArguments, render, styles};
use crate::exit::Failure;
use crate::sheet::{Tile, sheet};
use crate::{files, machine};

const WALL_PX: usize = 256;
const WALL_SEED: u64 = 3;
const FAMILY_PX: usize = 256;
const FAMILY_SEEDS: [u64; 2] = [3, 11];
/// Runs of each frame; the fastest counts.
const RUNS: usize = 9;
const STYLE: &str = "mediterranean";

/// Writes the plots into a folder.
pub(super) fn plots(out: &Path) -> Result<(), Failure> {
    figure(out, "transmittance", &waters::transmittance())?;
    figure(out, "daylight", &waters::daylight())?;
    figure(out, "grey-cards", &waters::grey_cards())?;
    figure(out, "visibility-range", &waters::visibility_over_range())?;
    figure(out, "visibility-turbidity", &waters::visibility_over_turbidity())
}

/// Writes the sheets of scenes into a folder, with the milliseconds that they took.
pub(super) fn sheets(out: &Path, style: &StyleArguments) -> Result<(), Failure> {
    let library = styles::library(style)?;
    let mut studio = Studio {
        slot: Slot::new(&Arc::new(Engine::new(
            library.clone(),
            style.onnxruntime.as_deref(),
        ))),
        library,
    };
    save(&out.join("wall.png"), studio.wall()?)?;
    let mut costs = Vec::new();
    for family in scenes::FAMILIES {
        let (picture, cost) = studio.family(family)?;
        save(&out.join(format!("{family}.png")), picture)?;
        costs.extend(cost);
    }
    let path = out.join("stages.md");
    files::write(&path, stages(&costs).as_bytes())?;
    println!("{}", path.display());
    Ok(())
}

fn figure(out: &Path, name: &str, figure: &impl Figure) -> Result<(), Failure> {
    let text = svg(figure).map_err(anyhow::Error::from)?;
    files::write(&out.join(format!("{name}.svg")), text.as_bytes())?;
    save(
        &out.join(format!("{name}.png")),
        picture(figure).map_err(anyhow::Error::from)?,
    )
}

fn save(path: &Path, picture: Rgb8) -> Result<(), Failure> {
    files::write_picture(path, &picture.into())?;
    println!("{}", path.display());
    Ok(())
}

/// Stages of one frame: scene, water, milliseconds of each.
type Cost = (String, String, BTreeMap<String, f64>);

struct Studio {
    slot: Slot,
    library: style::Library,
}

impl Studio {
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
                picture: shown(&rendered, "rgb")?.to_rgb8(),
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
                    picture: shown(&rendered, "rgb")?.to_rgb8(),
                    caption,
                });
                costs.push((format!("{family} {seed}"), name.clone(), ms));
            }
        }
        Ok((sheet(&tiles, waters.len(), FAMILY_PX), costs))
    }

    fn frame(&self, family: &str, seed: u64, camera: &Value, water: &Value) -> Result<Frame, Failure> {
        let document = json!({"scene": {"kind": "procedural", "family": family, "seed": seed}, "camera": camera,
            "water": water, "alpha": 0.6, "artifacts": ["rgb", "range"], "metrics": []});
        let named = Path::new(family);
        let vocabulary = renderer::vocabulary(&self.library, false);
        let job = Job::parse(document.to_string().as_bytes(), &vocabulary);
        let frame = job.and_then(|job| job.resolve(0));
        frame.map_err(|invalid| render::bad_spec(named, &invalid))
    }

    /// A frame with the least milliseconds of each stage.
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
            // A slot keeps its last scene; another in between makes it draw this one again.
            let mut run = |frame| self.slot.render(frame, &SceneSource::Local);
            let rendered = run(&between).and_then(|_| run(&frame));
            let rendered = rendered.map_err(|error| Failure::BadInput(error.to_string()))?;
            for (stage, &ms) in &rendered.record.timings_ms {
                let known = least.entry(stage.clone()).or_insert(ms);
                *known = known.min(ms);
            }
            last = Some(rendered);
        }
        Ok((last.context("at least one run")?, least))
    }
}

fn shown(rendered: &Rendered, kind: &str) -> Result<Raster, Failure> {
    let file = rendered
        .files
        .iter()
        .find(|file| file.kind == kind)
        .context("the artifact was asked for")?;
    Ok(codec::decode_picture(&file.bytes).map_err(anyhow::Error::from)?)
}

/// The range that half of the pixels are nearer than, in metres.
fn middle_range(rendered: &Rendered) -> Result<f64, Failure> {
    let raster = shown(rendered, "range")?;
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
