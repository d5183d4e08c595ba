//! `fathom upload`: a picture of the user's own with its range, as a scene of the service.

use std::path::PathBuf;

use ureq::unversioned::multipart::{Form, Part};

use crate::exit::Failure;
use crate::files;
use crate::remote::{Remote, ServerArguments};

/// Options of `fathom upload`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The picture (PNG, JPEG, WebP, or NPY with linear radiance)
    rgb: PathBuf,
    /// Distances along the line of sight (16-bit PNG or NPY)
    #[arg(long, value_name = "FILE", conflicts_with = "z_depth")]
    range: Option<PathBuf>,
    /// Distances along the optical axis (16-bit PNG or NPY)
    #[arg(long, value_name = "FILE")]
    z_depth: Option<PathBuf>,
    /// Metres of one unit of the range file
    #[arg(long, value_name = "METRES")]
    unit_m: Option<f64>,
    /// The code that means "no return" in an integer range file
    #[arg(long, value_name = "CODE")]
    invalid_code: Option<u16>,
    /// Focal length in pixels
    #[arg(long, value_name = "PIXELS", conflicts_with = "hfov_deg")]
    focal_px: Option<f64>,
    /// Horizontal field of view in degrees
    #[arg(long, value_name = "DEGREES")]
    hfov_deg: Option<f64>,
    /// Column of the principal point in pixels [default: the middle]
    #[arg(long, value_name = "PIXELS")]
    cx: Option<f64>,
    /// Row of the principal point in pixels [default: the middle]
    #[arg(long, value_name = "PIXELS")]
    cy: Option<f64>,
    /// Instance mask (8- or 16-bit PNG, 0 = background)
    #[arg(long, value_name = "FILE")]
    instances: Option<PathBuf>,
    #[command(flatten)]
    server: ServerArguments,
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let pictures = [
        ("rgb", Some(&arguments.rgb)),
        ("range", arguments.range.as_ref()),
        ("z_depth", arguments.z_depth.as_ref()),
        ("instances", arguments.instances.as_ref()),
    ];
    let mut contents = Vec::new();
    for (name, path) in pictures {
        if let Some(path) = path {
            contents.push((name, files::read(path)?));
        }
    }
    let numbers = [
        ("unit_m", arguments.unit_m.map(|v| v.to_string())),
        ("invalid_code", arguments.invalid_code.map(|v| v.to_string())),
        ("focal_px", arguments.focal_px.map(|v| v.to_string())),
        ("hfov_deg", arguments.hfov_deg.map(|v| v.to_string())),
        ("cx", arguments.cx.map(|v| v.to_string())),
        ("cy", arguments.cy.map(|v| v.to_string())),
    ];
    let mut form = Form::new();
    for (name, value) in &numbers {
        if let Some(value) = value {
            form = form.text(name, value);
        }
    }
    for (name, bytes) in &contents {
        form = form.part(name, Part::bytes(bytes).file_name(name));
    }
    let answer = Remote::new(&arguments.server).post_form("/v1/scenes", form)?;
    let scene = answer.json()?;
    println!(
        "{}",
        scene
            .get("id")
            .and_then(serde_json::Value::as_str)
            .unwrap_or_default()
    );
    if answer.status == 200 {
        eprintln!("this scene was uploaded before");
    }
    Ok(())
}
