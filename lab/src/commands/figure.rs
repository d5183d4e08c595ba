//! `fathom-lab figure`: the steps of the chain and the style waters for one scene, side by side.
//!
//! Reproduces Figures 5 and 6 of the paper: each step from the picture in air to the hazed result, and for every style water the
//! styled image at full weight, at 0.4, and with two lights.

use std::path::PathBuf;

use cli::exit::Failure;
use cli::files;
use cli::sheet::{Tile, sheet};
use cli::styles::StyleArguments;
use imaging::codec::{self, Radiance};
use imaging::{Plane, Rgb8, transfer};
use renderer::Rendered;
use serde_json::{Value, json};
use style::Runtime;

use crate::studio::{Studio, artifact};

/// Options of `fathom-lab figure`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The scene: FAMILY:SEED (structure:7) or a picture file
    scene: String,
    /// Folder for figure5.png and figure6.png
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Optical water
    #[arg(long, default_value = "jerlov-3C")]
    water: String,
    /// Range file of a picture: distances along the line of sight
    #[arg(long, value_name = "FILE", conflicts_with = "z_depth")]
    range: Option<PathBuf>,
    /// Range file of a picture: distances along the optical axis
    #[arg(long, value_name = "FILE")]
    z_depth: Option<PathBuf>,
    /// Meters of one unit of the range file
    #[arg(long, value_name = "METERS")]
    unit_m: Option<f64>,
    /// The code that means "no return" in an integer range file
    #[arg(long, value_name = "CODE")]
    invalid_code: Option<u16>,
    /// Horizontal field of view of a picture in degrees
    #[arg(long, value_name = "DEGREES", default_value_t = 80.0)]
    hfov_deg: f64,
    #[command(flatten)]
    style: StyleArguments,
}

const TILE_PX: usize = 384;
/// The two lights of the paper's figure: bottom left and bottom right, sigma a fifth of the height.
const LIGHTS: [(f64, f64); 2] = [(0.0, 1.0), (1.0, 1.0)];

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let library = arguments.style.library()?;
    let names: Vec<String> = library.names().iter().map(ToString::to_string).collect();
    if names.iter().any(|name| library.needs_runtime(name))
        && let Err(missing) = Runtime::load(arguments.style.onnxruntime.as_deref())
    {
        return Err(Failure::RuntimeMissing(missing.to_string()));
    }
    let mut variations = Variations {
        studio: Studio::new(library, arguments.style.onnxruntime.as_deref()),
        arguments,
    };
    let first = names.first().cloned().unwrap_or_default();
    let steps = variations.steps(&first)?;
    let waters = variations.waters(&names)?;
    for (name, tiles, columns) in [("figure5.png", steps, 4), ("figure6.png", waters, 4)] {
        let path = arguments.out.join(name);
        files::write_picture(&path, &sheet(&tiles, columns, TILE_PX).into())?;
        println!("{}", path.display());
    }
    Ok(())
}

/// Renders variations of one scene.
struct Variations<'a> {
    studio: Studio,
    arguments: &'a Arguments,
}

impl Variations<'_> {
    /// Figure 5: every step of the chain.
    fn steps(&mut self, style: &str) -> Result<Vec<Tile>, Failure> {
        let kinds = [
            "clean",
            "range",
            "direct",
            "forward_scatter",
            "backscatter",
            "scattered",
            "styled",
            "hazed",
        ];
        let rendered = self.render(Some(style), 0.4, true, &kinds)?;
        let captions = [
            "in air: J".to_owned(),
            "range: near bright".to_owned(),
            "attenuated: J exp(-cZ)".to_owned(),
            "scattered forward: F".to_owned(),
            "veiling light: B".to_owned(),
            format!("after the water: {}", self.arguments.water),
            format!("styled: {style}, alpha = 0.4"),
            "with two lights".to_owned(),
        ];
        let present = kinds
            .iter()
            .zip(captions)
            .filter(|(kind, _)| artifact(&rendered, kind).is_some());
        present
            .map(|(kind, caption)| {
                Ok(Tile {
                    picture: picture(&rendered, kind)?,
                    caption: vec![caption],
                })
            })
            .collect()
    }

    /// Figure 6: each style water at full weight, at 0.4, and with two lights; first the picture in air.
    fn waters(&mut self, styles: &[String]) -> Result<Vec<Tile>, Failure> {
        let mut tiles = Vec::new();
        for style in styles {
            let air = self.render(None, 0.0, false, &["clean"])?;
            tiles.push(Tile {
                picture: picture(&air, "clean")?,
                caption: vec!["in air".to_owned()],
            });
            for (alpha, lit) in [(1.0, false), (0.4, false), (0.4, true)] {
                let rendered = self.render(Some(style), alpha, lit, &["rgb"])?;
                let lights = if lit { ", two lights" } else { "" };
                let caption = vec![format!("{style}, alpha = {alpha}{lights}")];
                tiles.push(Tile {
                    picture: picture(&rendered, "rgb")?,
                    caption,
                });
            }
        }
        Ok(tiles)
    }

    fn render(
        &mut self,
        style: Option<&str>,
        alpha: f64,
        lit: bool,
        kinds: &[&str],
    ) -> Result<Rendered, Failure> {
        let mut water = json!({"optics": self.arguments.water});
        if let Some(style) = style {
            water["style"] = json!(style);
        }
        let lights: Vec<Value> = LIGHTS
            .iter()
            .filter(|_| lit)
            .map(|(x, y)| json!({"kind": "haze", "x": x, "y": y, "size": 0.2, "intensity": 0.9, "color": [1, 1, 1]}))
            .collect();
        let mut description = json!({"scene": scene(self.arguments)?, "camera": {"width": 768, "height": 492,
            "hfov_deg": self.arguments.hfov_deg}, "water": water, "lights": lights, "metrics": [],
            "artifacts": kinds});
        if style.is_some() {
            description["alpha"] = json!(alpha);
        }
        let frame = self.studio.frame(&description, 0)?;
        self.studio.render(&frame)
    }
}

/// The scene part of the description: `FAMILY:SEED`, or a file.
fn scene(arguments: &Arguments) -> Result<Value, Failure> {
    if let Some((family, seed)) = arguments.scene.split_once(':')
        && let Ok(seed) = seed.parse::<u64>()
    {
        return Ok(json!({"kind": "procedural", "family": family, "seed": seed, "lighting": "in_air"}));
    }
    let mut scene = json!({"kind": "files", "rgb": arguments.scene});
    let paths = [("range", &arguments.range), ("z_depth", &arguments.z_depth)];
    for (name, path) in paths {
        if let Some(path) = path {
            scene[name] = json!(path);
        }
    }
    if let Some(unit) = arguments.unit_m {
        scene["unit_m"] = json!(unit);
    }
    if let Some(code) = arguments.invalid_code {
        scene["invalid_code"] = json!(code);
    }
    Ok(scene)
}

/// An artifact as a viewable picture: linear layers are encoded, range becomes brightness.
fn picture(rendered: &Rendered, kind: &str) -> Result<Rgb8, Failure> {
    let bytes = artifact(rendered, kind)
        .ok_or_else(|| Failure::Other(anyhow::anyhow!("the frame has no artifact `{kind}`")))?;
    if kind == "range" {
        let raster = codec::decode_picture(bytes).map_err(anyhow::Error::from)?;
        return Ok(range_picture(&raster));
    }
    match codec::decode_radiance(bytes).map_err(anyhow::Error::from)? {
        Radiance::Encoded(raster) => Ok(raster.to_rgb8()),
        Radiance::Linear(radiance) => Ok(transfer::encode_rgb8(&radiance).0),
    }
}

/// Millimeters as brightness on a logarithmic scale, near bright, holes black.
fn range_picture(raster: &imaging::Raster) -> Rgb8 {
    let codes: Vec<u16> = match raster.samples() {
        imaging::Samples::U16(codes) => codes.clone(),
        imaging::Samples::U8(codes) => codes.iter().map(|&code| u16::from(code)).collect(),
    };
    let valid = || {
        codes
            .iter()
            .copied()
            .filter(|&code| code > 0)
            .map(|code| f64::from(code).ln())
    };
    let near = valid().fold(f64::INFINITY, f64::min);
    let far = valid().fold(f64::NEG_INFINITY, f64::max);
    let brightness = |&code: &u16| match code {
        0 => 0,
        code => (255.0 - 215.0 * (f64::from(code).ln() - near) / (far - near).max(1e-9)).round() as u8,
    };
    let gray: Vec<u8> = codes.iter().map(brightness).collect();
    let plane = Plane::new(raster.width(), raster.height(), gray).expect("one code for each pixel");
    imaging::Raster::from(plane).to_rgb8()
}
