//! `fathom-lab airlight`: renders the airlight of four lamps with 4 to 64 nodes per ray and with the number chosen for a tolerance,
//! and prints the table of docs/science/lamps.md.

use std::path::PathBuf;
use std::time::Instant;

use cli::exit::Failure;
use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb};
use lab::plot::{Axis, Form, Lines, Mark, Series};
use optics::lamp::{
    GlowPhase, LAMP_RADIUS_M, Lamp, Lighting, REFERENCE_NODES, airlight, airlight_reference,
    airlight_with_nodes,
};

use crate::drawing;

/// Options of `fathom-lab airlight`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Folder for airlight.svg and airlight.png
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

const FRAME: (usize, usize) = (768, 492);
/// Errors are measured at half the frame size, with the same field of view.
const HALF: (usize, usize) = (384, 246);
const NODES: [usize; 9] = [4, 6, 8, 12, 16, 24, 32, 48, 64];
const TOLERANCES: [f64; 4] = [1e-3, 3e-4, 7.5e-5, 1e-5];
/// Frames of each kind; the fastest counts.
const RUNS: usize = 7;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut series = Vec::new();
    println!("| four lamps | nodes | error, of the peak | error | ms |\n|---|---|---|---|---|");
    for (name, lamps) in cases().map_err(|errors| Failure::BadInput(format!("{errors:?}")))? {
        let (half, whole) = (lighting(&lamps, HALF), lighting(&lamps, FRAME));
        let (small, large) = (range(HALF), range(FRAME));
        let exact = airlight_reference(&small.map(|&z| f64::from(z)), &half, REFERENCE_NODES);
        let samples = exact.planes().iter().flat_map(|plane| plane.data());
        let peak = samples.copied().fold(0.0, f64::max);
        let measure = |label: &str, glow: &dyn Fn(&Plane<f32>, &Lighting) -> Rgb<f32>| {
            let error = worst(&glow(&small, &half), &exact);
            let ms = fastest(&|| glow(&large, &whole));
            println!(
                "| {name} | {label} | {:.1e} | {error:.1e} | {ms:.0} |",
                error / peak
            );
            Mark {
                x: ms,
                y: error / peak,
                reach: None,
                label: label.to_owned(),
                ringed: false,
            }
        };
        let fixed = NODES.map(|nodes| {
            measure(&nodes.to_string(), &|z, lights| {
                airlight_with_nodes(z, lights, nodes)
            })
        });
        let chosen = TOLERANCES.map(|tolerance| {
            measure(&format!("by tolerance {tolerance:e}"), &|z, lights| {
                airlight(z, lights, tolerance).light
            })
        });
        let unnamed = |mark: Mark| Mark {
            label: String::new(),
            ..mark
        };
        series.push(Series {
            name: name.to_owned(),
            marks: fixed.to_vec(),
            form: Form::Joined,
        });
        series.push(Series {
            name: format!("{name}, chosen"),
            marks: chosen.map(unnamed).to_vec(),
            form: Form::Dots,
        });
    }
    let axis = |title: &str| Axis {
        title: title.to_owned(),
        logarithmic: true,
    };
    let chart = Lines {
        title: "Glow before four lamps, 4 to 64 nodes, 768 x 492, one core".to_owned(),
        x: axis("milliseconds"),
        y: axis("largest error, share of the peak"),
        series,
    };
    drawing::write(&arguments.out, "airlight", &chart)
}

/// Lamps next to the camera as points and as spots, and lamps in view.
fn cases() -> Result<Vec<(&'static str, Vec<Lamp>)>, Vec<spec::Beyond>> {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];
    let all =
        |lamp: &dyn Fn(f64, f64) -> Result<Lamp, Vec<spec::Beyond>>| -> Result<Vec<Lamp>, Vec<spec::Beyond>> {
            corners.iter().map(|[x, y]| lamp(*x, *y)).collect()
        };
    let beside = |x: f64, y: f64| [0.4 * x, 0.25 * y, 0.0];
    Ok(vec![
        ("points", all(&|x, y| Lamp::point(beside(x, y), [2.0; 3]))?),
        (
            "spots",
            all(&|x, y| Lamp::spot(beside(x, y), [2.0; 3], [-0.1 * x, 0.0, 1.0], 35.0))?,
        ),
        (
            "in view",
            all(&|x, y| Lamp::point([0.5 * x, 0.3 * y, 1.5], [0.05; 3]))?,
        ),
    ])
}

fn lighting(lamps: &[Lamp], (width, height): (usize, usize)) -> Lighting {
    Lighting {
        lamps: lamps.to_vec(),
        radius_m: LAMP_RADIUS_M,
        camera: Intrinsics::centered(458.0 * width as f64 / FRAME.0 as f64, width, height),
        attenuation: [0.778, 0.546, 0.594],
        scattering: [0.412, 0.447, 0.435],
        absorption: None,
        phase: GlowPhase::henyey_greenstein(0.919),
        patches: None,
    }
}

/// A slope from 1 to 15 m with a near pole.
fn range((width, height): (usize, usize)) -> Plane<f32> {
    Plane::from_fn(width, height, |x, y| {
        let slope = 1.0 + 14.0 * (y as f32 + x as f32 / width as f32) / height as f32;
        if (25 * width / 64..width * 85 / 192).contains(&x) {
            1.5
        } else {
            slope
        }
    })
}

fn worst(glow: &Rgb<f32>, exact: &Rgb<f64>) -> f64 {
    let planes = glow.planes().iter().zip(exact.planes());
    let samples = planes.flat_map(|(glow, exact)| glow.data().iter().zip(exact.data()));
    samples
        .map(|(&glow, exact)| (f64::from(glow) - exact).abs())
        .fold(0.0, f64::max)
}

fn fastest(work: &dyn Fn() -> Rgb<f32>) -> f64 {
    let run = |_| {
        let start = Instant::now();
        std::hint::black_box(work());
        start.elapsed().as_secs_f64() * 1e3
    };
    (0..RUNS).map(run).fold(f64::INFINITY, f64::min)
}
