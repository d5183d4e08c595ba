//! `fathom-lab truth-effects`: what each effect brings the chain nearer to the truth, and what it costs.

use std::path::{Path, PathBuf};
use std::time::Instant;

use cli::exit::Failure;
use cli::files;
use cli::progress::Progress;
use imaging::Rgb;
use lab::effects::{self, BLOCK, Effect, Row, bars, csv, kept, markdown};
use lab::frame_truth::round;
use renderer::{Traced, Tracing};
use spec::Frame;
use truth::Goal;

use crate::studio::Studio;
use crate::{drawing, machine};

/// Options of `fathom-lab truth-effects`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Paths of each pixel and channel of the truth
    #[arg(long, default_value_t = 1 << 12, value_parser = clap::value_parser!(u64).range(1 << 4..=1 << 20))]
    paths: u64,
    /// Only this effect
    #[arg(long)]
    effect: Option<String>,
    /// A table that this command made: effects that it has with at least as many paths keep their rows
    #[arg(long, value_name = "FILE")]
    keep: Option<PathBuf>,
    /// Folder for effects.md, effects.csv and the drawing
    #[arg(long, value_name = "DIR", default_value = "docs/truth")]
    out: PathBuf,
}

/// Pixels of the frames that are traced and of those that are timed.
const TRACED: (usize, usize) = (48, 32);
const TIMED: (usize, usize) = (768, 492);
/// Frames that are timed of each pair, one without and one with by turns.
const RUNS: usize = 5;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut studio = Studio::with_shipped_styles()?;
    let wanted = |effect: &Effect| arguments.effect.as_ref().is_none_or(|name| *name == effect.name);
    let all: Vec<Effect> = effects::effects().into_iter().filter(wanted).collect();
    let old = match &arguments.keep {
        Some(path) => read(path)?,
        None => Vec::new(),
    };
    let mut progress = Progress::new("truth-effects", "effects", all.len() as u64);
    let mut rows = Vec::new();
    for (number, effect) in all.iter().enumerate() {
        progress.set_with(number as u64, effect.name.to_owned());
        match kept(&old, effect.name, arguments.paths) {
            Some(kept) => rows.extend(kept),
            None => rows.extend(measure(&mut studio, effect, arguments.paths)?),
        }
    }
    progress.finish();
    let text = format!(
        "# What effects gain, against the truth\n\nMade by `fathom-lab truth-effects --paths {}`; {}.\n\n{}",
        arguments.paths,
        machine::describe(),
        markdown(&rows)
    );
    files::write(&arguments.out.join("effects.md"), text.as_bytes())?;
    files::write(&arguments.out.join("effects.csv"), csv(&rows).as_bytes())?;
    drawing::write(&arguments.out, "effects", &bars(&rows))?;
    println!("{text}");
    Ok(())
}

/// The rows of a table that this command made.
pub(crate) fn read(path: &Path) -> Result<Vec<Row>, Failure> {
    let bytes = files::read(path)?;
    let rows = std::str::from_utf8(&bytes).ok().and_then(effects::read);
    rows.ok_or_else(|| {
        let name = path.display();
        Failure::BadInput(format!("{name} is no table of `fathom-lab truth-effects`"))
    })
}

/// The rows of an effect: without it and with it.
fn measure(studio: &mut Studio, effect: &Effect, paths: u64) -> Result<Vec<Row>, Failure> {
    let small = |studio: &Studio, with| studio.frame(&effect.job(with, TRACED), 0);
    let (without, with) = (small(studio, false)?, small(studio, true)?);
    let traced = traced(studio, &with, paths)?;
    let has_daylight = traced.report.left_out.contains(&"waves");
    let ms = milliseconds(studio, effect)?;
    let mut rows = Vec::new();
    for (frame, with) in [(&without, false), (&with, true)] {
        let light = studio.water_light(frame, has_daylight)?;
        let all = sum(&light.direct, &light.scattered);
        rows.extend(Row::new(
            effect,
            with,
            &all,
            &traced.truth.estimate,
            ms[usize::from(with)],
        ));
    }
    Ok(rows)
}

/// The truth of a frame with so many paths.
fn traced(studio: &mut Studio, frame: &Frame, paths: u64) -> Result<Traced, Failure> {
    let light = studio.water_light(frame, false)?;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let tracing = Tracing {
        goal: Goal {
            // All paths are taken: every effect is then known as well as it can be.
            target: 0.0,
            block: BLOCK,
            most_paths: paths,
        },
        law: light.law,
        seed: frame.seed,
        is_shared: false,
        limit: "paths",
    };
    let traced = studio.trace(frame, &tracing, &mut |shutter, scene, samples| {
        let pixels = TRACED.0 * TRACED.1;
        Some(round((shutter, scene), pixels, samples, threads, &mut |_| ()))
    })?;
    traced.ok_or_else(|| Failure::BadInput("the frame was not traced".to_owned()))
}

/// Median milliseconds of a core for the light of a frame, scene included, without an effect and with it.
fn milliseconds(studio: &mut Studio, effect: &Effect) -> Result<[f64; 2], Failure> {
    let frame = |with| studio.frame(&effect.job(with, TIMED), 0);
    let frames = [frame(false)?, frame(true)?];
    let mut runs = [Vec::new(), Vec::new()];
    for _ in 0..RUNS {
        for (frame, runs) in frames.iter().zip(&mut runs) {
            let wall = Instant::now();
            let before = core_ms();
            studio.water_light(frame, true)?;
            runs.push(match (before, core_ms()) {
                (Some(before), Some(after)) => after - before,
                _ => wall.elapsed().as_secs_f64() * 1e3,
            });
        }
    }
    Ok(runs.map(|mut runs| {
        runs.sort_by(f64::total_cmp);
        runs[runs.len() / 2]
    }))
}

/// Milliseconds that this thread has run on a core; none where the system does not say.
fn core_ms() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let ns: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(ns / 1e6)
}

fn sum(a: &Rgb<f32>, b: &Rgb<f32>) -> Rgb<f32> {
    Rgb::from_fn(a.width(), a.height(), |x, y| {
        [0, 1, 2].map(|i| a.planes()[i].pixel(x, y) + b.planes()[i].pixel(x, y))
    })
}
