//! `fathom-lab bench style`: time of each tier against the usual network of fast neural style, throughput of concurrent sessions,
//! and distances between tiers and between waters.

mod waters;

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use cli::exit::Failure;
use cli::files;
use imaging::Rgb;
use style::{Library, Runtime, Session, StyleModel};

use super::StyleBench;
use crate::machine;

const SIZES: [(usize, usize); 3] = [(640, 480), (869, 565), (1920, 1080)];
/// Concurrent sessions.
const SESSIONS: usize = 4;
/// How long the concurrent sessions run.
const SPAN: Duration = Duration::from_secs(3);
/// A slower network is run only twice.
const SLOW: Duration = Duration::from_secs(1);

/// Runs the command.
pub(super) fn run(arguments: &StyleBench) -> Result<(), Failure> {
    let library = arguments.style.library()?;
    let mut text = format!(
        "# Style waters, measured\n\n{}. Made by `fathom-lab bench style`.\n",
        machine::describe()
    );
    speed(&mut text, &library, arguments)?;
    tiers(&mut text, &library);
    waters::compare(&mut text, &library)?;
    if let Some(out) = &arguments.out {
        files::write(&out.join("style-bench.md"), text.as_bytes())?;
    }
    print!("{text}");
    Ok(())
}

/// One of our networks; all of them take the same time.
fn ours(library: &Library) -> Result<&StyleModel, Failure> {
    let mut models = library.names().into_iter().filter_map(|name| library.get(name));
    let found = models.find(|model| !model.needs_runtime());
    found.ok_or_else(|| Failure::BadInput("there is no style of our own network".to_owned()))
}

fn speed(text: &mut String, library: &Library, arguments: &StyleBench) -> Result<(), Failure> {
    text.push_str(
        "\n## Time of a frame\n\nMilliseconds on one thread, the fastest of the runs. `johnson` is the network of fast neural \
         style (9×9 ends, 32-64-128 channels, instance normalization) on ONNX Runtime, in the same run; `net on ONNX \
         Runtime` is our network there. Frames/s: four sessions at once at 640×480.\n\n\
         | network | 640×480 | 869×565 | 1920×1080 | frames/s, 4 sessions |\n|---|---|---|---|---|\n",
    );
    let model = ours(library)?;
    let runtime = Runtime::load(arguments.style.onnxruntime.as_deref());
    let control = StyleModel::without_card("johnson", lab::johnson(1));
    let mut row = |name: &str, session: &dyn Fn() -> Result<Session, Failure>| -> Result<(), Failure> {
        let mut one = session()?;
        let _ = write!(text, "| {name} |");
        for (width, height) in SIZES {
            let fastest = fastest(&mut one, &frame(width, height), arguments.runs)?;
            let _ = write!(text, " {:.1} |", 1e3 * fastest.as_secs_f64());
        }
        let all = (0..SESSIONS).map(|_| session()).collect::<Result<Vec<_>, _>>()?;
        let _ = writeln!(text, " {:.1} |", at_once(all)?);
        Ok(())
    };
    let missing = || Failure::BadInput(format!("{} is not our own network", model.name));
    row("lut", &|| Session::table(model).ok_or_else(missing))?;
    row("net", &|| Session::native(model).ok_or_else(missing))?;
    match &runtime {
        Ok(runtime) => {
            for (name, model) in [("net on ONNX Runtime", model), ("johnson", &control)] {
                row(name, &|| {
                    runtime
                        .session(model)
                        .map_err(|error| Failure::Other(error.into()))
                })?;
            }
        }
        Err(missing) => {
            let _ = writeln!(text, "\n{missing}");
        }
    }
    Ok(())
}

fn frame(width: usize, height: usize) -> Rgb<f32> {
    Rgb::from_fn(width, height, |x, y| {
        let share = (x * y % 97) as f32 / 97.0;
        [x as f32 / width as f32, y as f32 / height as f32, share]
    })
}

fn fastest(session: &mut Session, frame: &Rgb<f32>, runs: u32) -> Result<Duration, Failure> {
    let mut best = Duration::MAX;
    for run in 0..=runs {
        let start = Instant::now();
        session
            .apply(frame, style::ModelInputs::default())
            .map_err(|error| Failure::Other(error.into()))?;
        // The first run is a warm-up.
        let took = start.elapsed();
        if run > 0 {
            best = best.min(took);
        }
        if run > 0 && took > SLOW {
            break;
        }
    }
    Ok(best)
}

/// Frames per second of concurrent sessions, each on a separate thread.
fn at_once(sessions: Vec<Session>) -> Result<f64, Failure> {
    let frame = frame(640, 480);
    let start = Instant::now();
    let work = |mut session: Session| {
        let mut frames = 0u32;
        while start.elapsed() < SPAN {
            session.apply(&frame, style::ModelInputs::default())?;
            frames += 1;
        }
        Ok::<_, style::StyleError>((frames, start.elapsed()))
    };
    let done = std::thread::scope(|scope| {
        let threads: Vec<_> = sessions
            .into_iter()
            .map(|session| scope.spawn(move || work(session)))
            .collect();
        threads
            .into_iter()
            .map(|thread| {
                let ended = thread.join();
                ended.map_err(|_| Failure::BadInput("a session panicked".to_owned()))
            })
            .collect::<Result<Vec<_>, _>>()
    })?;
    let mut rate = 0.0;
    for result in done {
        let (frames, took) = result.map_err(|error| Failure::Other(error.into()))?;
        rate += f64::from(frames) / took.as_secs_f64();
    }
    Ok(rate)
}

fn tiers(text: &mut String, library: &Library) {
    text.push_str(
        "\n## From `lut` to `net`\n\nOver 16 new scenes at alpha 1, as on the cards; differences are of 255.\n\n\
         | water | mean | 99.9 % below | max | SSIM | ΔE (1976), mean |\n|---|---|---|---|---|---|\n",
    );
    for name in library.names() {
        let Some(distance) = library.get(name).and_then(|model| model.card.table) else {
            continue;
        };
        let _ = writeln!(
            text,
            "| {name} | {:.2} | {:.1} | {:.1} | {:.4} | {:.2} |",
            distance.mean_255, distance.high_255, distance.max_255, distance.ssim, distance.delta_e
        );
    }
}
