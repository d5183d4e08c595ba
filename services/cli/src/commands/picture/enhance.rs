//! `fathom enhance`: enhances pictures of the user.

mod inputs;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, mpsc};
use std::thread;

use cli::exit::Failure;
use cli::files;
use cli::plural::count;
use cli::progress::Progress;
use cli::styles::StyleArguments;
use enhance::{Method, Outcome, Warning};
use imaging::Raster;
use renderer::{Engine, PictureNetworks};
use spec::{Enhancement, HSCM_STEPS, Invalid, MASK_STEP, Mask, MaskImage, NETWORK_METHOD, Step};
use style::Library;

use inputs::{Work, find_work};

/// Options of `fathom enhance`.
#[derive(clap::Args)]
#[command(after_long_help = list_methods())]
pub(crate) struct Arguments {
    /// Method, with parameters as in `hscm:cutoff=16,mask=paper`, or an enhancement in JSON as in a job
    method: String,
    /// Pictures, or folders of pictures (PNG, JPEG or WebP; 8 or 16 bit, gray or color)
    #[arg(required = true)]
    inputs: Vec<PathBuf>,
    /// Result of one picture (.png, .jpg or .webp), or a folder for all results, PNG files with the names of the pictures
    #[arg(long, short)]
    out: PathBuf,
    /// Mask for a METHOD without one: a gray picture of the same size, black where the result is removed
    #[arg(long, value_name = "FILE")]
    mask: Option<PathBuf>,
    /// Also write the intermediate results and the mask, as `NAME.STEP.png`
    #[arg(long)]
    steps: bool,
    #[command(flatten)]
    style: StyleArguments,
}

/// Every method with its description and its distance from published results.
fn list_methods() -> String {
    let all = enhance::METHODS.iter().filter_map(|name| Method::parse(name));
    let lines = all.map(|method| {
        let (name, about, published) = (method.name(), method.about(), method.against_published());
        format!("\n  {name}: {about}\n    {published}")
    });
    format!(
        "Methods, with their distance from published results:{}\n  {NETWORK_METHOD}:model=NAME: an enhancer network of --styles, on ONNX \
         Runtime\n\n`fathom list fields` describes the parameters, as `enhance[](METHOD).…`.",
        lines.collect::<String>()
    )
}

fn parse_enhancement(text: &str, library: &Library) -> Result<Enhancement, Failure> {
    let vocabulary = renderer::vocabulary(library, true);
    Enhancement::parse_with(text, &vocabulary).map_err(|Invalid(errors)| {
        let lines = errors.iter().map(|error| match error.allowed.as_slice() {
            [] => error.message.clone(),
            allowed => format!("{}; there is {}", error.message, allowed.join(", ")),
        });
        let lines = lines.collect::<Vec<_>>().join("; ");
        Failure::BadInput(format!("invalid value '{text}' for '<METHOD>': {lines}"))
    })
}

/// The enhancement and the networks that it can use. A missing runtime is an error before any picture is read.
fn prepare(arguments: &Arguments) -> Result<Prepared, Failure> {
    let library = arguments.style.library()?;
    let mut enhancement = parse_enhancement(&arguments.method, &library)?;
    add_mask(&mut enhancement, arguments.mask.as_deref())?;
    let engine = Arc::new(Engine::new(library, arguments.style.onnxruntime.as_deref()));
    let has_network = enhancement.steps.iter().any(|step| matches!(step, Step::Onnx(_)));
    if has_network && let Err(missing) = engine.runtime() {
        return Err(Failure::RuntimeMissing(missing.to_string()));
    }
    Ok(Prepared {
        enhancement,
        engine,
        steps: arguments.steps,
    })
}

/// A checked request.
struct Prepared {
    enhancement: Enhancement,
    engine: Arc<Engine>,
    /// Whether to write the intermediate results.
    steps: bool,
}

/// Runs the command. A picture that fails does not stop the others.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let prepared = prepare(arguments)?;
    let work = find_work(&arguments.inputs, &arguments.out)?;
    if let [step] = prepared.enhancement.steps.as_slice() {
        let method = Method(step.clone());
        eprintln!("{}: {}", method.name(), method.against_published());
    }
    let failures = enhance_all(&prepared, &work);
    match failures.as_slice() {
        [] => Ok(()),
        [failure] if work.len() == 1 => Err(Failure::BadInput(failure.clone())),
        failures => Err(Failure::BadInput(format!(
            "{} of {} failed:\n{}",
            failures.len(),
            count(work.len(), "picture"),
            failures.join("\n")
        ))),
    }
}

/// Adds the mask of `--mask`.
fn add_mask(enhancement: &mut Enhancement, file: Option<&Path>) -> Result<(), Failure> {
    let Some(file) = file else {
        return Ok(());
    };
    if enhancement.mask != Mask::None {
        let message = "METHOD has a mask of its own, so --mask has no effect; leave one of them out";
        return Err(Failure::BadInput(message.to_owned()));
    }
    let mask = MaskImage::from_file(files::read(file)?);
    let mask = mask.map_err(|why| Failure::BadInput(format!("--mask: {} {why}", file.display())))?;
    enhancement.mask = Mask::Image(mask);
    Ok(())
}

/// Enhances every picture, each on one thread, and returns the failures in the order of the pictures.
fn enhance_all(prepared: &Prepared, work: &[Work]) -> Vec<String> {
    let (sender, results) = mpsc::channel();
    let next = AtomicUsize::new(0);
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let mut failures = BTreeMap::new();
    thread::scope(|scope| {
        for _ in 0..threads.min(work.len()) {
            let (sender, next) = (sender.clone(), &next);
            scope.spawn(move || {
                let mut networks = PictureNetworks::new(&prepared.engine);
                loop {
                    let position = next.fetch_add(1, Ordering::Relaxed);
                    let Some(work) = work.get(position) else { break };
                    // The other end waits for every sender.
                    let _ = sender.send((position, enhance_one(prepared, &mut networks, work)));
                }
            });
        }
        drop(sender);
        let mut progress = Progress::new("enhance", "pictures", work.len() as u64);
        for (done, (position, result)) in results.into_iter().enumerate() {
            let input = work[position].input.display();
            match result {
                Ok(warnings) => {
                    for warning in warnings {
                        progress.print(&format!("{input}: warning: {warning}"));
                    }
                }
                Err(failure) => {
                    failures.insert(position, failure.to_string());
                }
            }
            progress.set(done as u64 + 1);
        }
        progress.finish();
    });
    failures.into_values().collect()
}

/// Enhances a picture, writes the result and returns the warnings.
fn enhance_one(
    prepared: &Prepared,
    networks: &mut PictureNetworks,
    work: &Work,
) -> Result<Vec<Warning>, Failure> {
    let picture = files::read_picture(&work.input)?;
    let positions: Vec<String> = (1..prepared.enhancement.steps.len())
        .map(|step| step.to_string())
        .collect();
    let mut wanted: Vec<&str> = Vec::new();
    if prepared.steps {
        let positions = positions.iter().map(String::as_str);
        wanted.extend(positions.chain(HSCM_STEPS).chain([MASK_STEP]));
    }
    let outcome = networks
        .enhance(&prepared.enhancement, &picture, &wanted)
        .map_err(|error| Failure::BadInput(format!("{}: {error}", work.input.display())))?;
    write(&work.output, &outcome)?;
    Ok(outcome.warnings)
}

/// Writes the result and its steps together, so that a failure leaves neither.
fn write(output: &Path, outcome: &Outcome) -> Result<(), Failure> {
    let named = outcome
        .steps
        .iter()
        .map(|(step, picture)| (output.with_extension(format!("{step}.png")), picture));
    let pictures: Vec<(PathBuf, &Raster)> = std::iter::once((output.to_owned(), &outcome.picture))
        .chain(named)
        .collect();
    let encoded = pictures
        .iter()
        .map(|(path, picture)| files::encode_picture(path, picture));
    let encoded = encoded.collect::<Result<Vec<_>, _>>()?;
    let paths = pictures.into_iter().map(|(path, _)| path);
    let files: Vec<_> = paths.zip(encoded.iter().map(Vec::as_slice)).collect();
    files::write_all(&files)
}
