//! `fathom train`: a style water from a photo.

mod arguments;
mod distance;
mod preview;
mod product;
mod progress;
mod sheet;

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context;
use cli::exit::Failure;
use cli::files;
use imaging::Plane;
use training::{Photo, Trainer};

use crate::commands::style::styles;
pub(crate) use arguments::Arguments;
use arguments::Given;
use preview::Preview;
use product::Product;
use progress::TrainingProgress;

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if !style::is_name(&arguments.name) {
        let message = "--name: a style's name has 1 to 64 characters of a-z, 0-9, _ and -";
        return Err(Failure::BadInput(format!("{message}, not `{}`", arguments.name)));
    }
    let given = arguments
        .photos
        .iter()
        .map(|path| read(path))
        .collect::<Result<Vec<_>, _>>()?;
    if arguments.check {
        return Ok(());
    }
    let threads = arguments.threads.map_or(0, |threads| usize::from(threads.get()));
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .context("cannot start threads")?;
    let stop = cli::signals::stop_at_signal()?;
    pool.install(|| train(arguments, &given, &stop))?;
    // The service adds the style itself.
    if arguments.no_add || arguments.progress.is_some() {
        return Ok(());
    }
    let model = arguments.out.join(format!("{}.onnx", arguments.name));
    add_to_service(arguments, &model)
}

/// Adds the style to the service, if there is one. A refusal is a warning, since the training has succeeded.
fn add_to_service(arguments: &Arguments, model: &Path) -> Result<(), Failure> {
    let client = arguments.server.patient_client();
    let (name, server, file) = (&arguments.name, &arguments.server.server, model.display());
    match styles::add(
        &client,
        &files::read(model)?,
        &styles::read_upload_card(model, name)?,
    ) {
        Ok(_) => println!("jobs of {server} may name the style `{name}` now"),
        Err(Failure::NoServer(_)) => println!("add it to a service with `fathom styles add {file}`"),
        Err(refusal) => eprintln!("warning: {server} did not take the style `{name}`: {refusal}"),
    }
    Ok(())
}

fn read(path: &Path) -> Result<Given, Failure> {
    let bytes = files::read(path)?;
    let wrong = |reason: String| Failure::BadInput(format!("{}: {reason}", path.display()));
    let picture = files::decode_picture(path, &bytes)?.to_rgb8();
    Ok(Given {
        photo: Photo::new(&picture).map_err(|error| wrong(error.to_string()))?,
        picture,
        sha256: imaging::digest::sha256(&bytes),
    })
}

/// Writes the color transfer first, so that a preview exists and an unwritable folder is reported before the training; then the
/// network.
fn train(arguments: &Arguments, given: &[Given], stop: &AtomicBool) -> Result<(), Failure> {
    let photos: Vec<Photo> = given.iter().map(|given| given.photo.clone()).collect();
    let steps = arguments.steps as usize;
    let mut trainer = Trainer::new(&photos, arguments.range, arguments.seed, steps);
    let start = training::score(trainer.color_transfer(), &photos);
    let product = Product {
        arguments,
        given,
        start,
    };
    product.write(&trainer.best(), start, 0)?;
    let mut progress = TrainingProgress::new(steps, arguments.progress.clone())?;
    let mut preview = arguments.preview.clone().map(Preview::new).transpose()?;
    if let Some(preview) = &mut preview {
        preview.draw(trainer.color_transfer())?;
    }
    let mut done = 0;
    while !trainer.is_done() && !stop.load(Ordering::Relaxed) {
        let losses = trainer.step();
        done += 1;
        progress.set(done, &losses)?;
        if let Some(preview) = &mut preview {
            preview.draw_at_times(trainer.weights())?;
        }
    }
    progress.finish();
    let best = trainer.best();
    let score = training::score(&best.weights, &photos);
    product.write(&best, score, done)?;
    if done < steps {
        println!(
            "stopped after {done} of {steps} steps; kept the best, of step {}",
            best.step
        );
    }
    println!("{:16} texture  color  content", "on new scenes");
    for (name, score) in [("color transfer", start), (arguments.name.as_str(), score)] {
        let parts = score.losses;
        println!(
            "{name:16} {:7.3} {:7.3} {:8.3}",
            parts.texture, parts.color, parts.content
        );
    }
    if arguments.range {
        println!("{:16} nearer than 2 m, at 4 to 12 m", "contrast kept");
        let models = [
            ("color transfer", trainer.color_transfer()),
            (arguments.name.as_str(), &best.weights),
        ];
        for (name, weights) in models {
            let kept = training::contrast_kept(weights, Plane::clone);
            println!("{name:16} {:15.3} {:12.3}", kept.near, kept.far);
        }
    }
    println!("{}", product.path("onnx").display());
    Ok(())
}
