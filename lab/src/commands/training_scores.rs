//! `fathom-lab training-scores`: how much the ratios of a trained water to its color transfer vary with the scenes used, as rows of
//! a Markdown table.

use std::path::PathBuf;

use cli::exit::Failure;
use cli::files;
use training::{Photo, Trainer, score_over};

/// Options of `fathom-lab training-scores`.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The model, made by `fathom train`
    model: PathBuf,
    /// The photos of its training
    #[arg(required = true)]
    photos: Vec<PathBuf>,
    /// The seed of its training
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Ranges of new scenes, and how often patches are drawn.
const SETS: [(std::ops::Range<u64>, u64); 6] = [
    (0..64, 3),
    (64..128, 3),
    (0..16, 6),
    (16..32, 6),
    (32..48, 6),
    (48..64, 6),
];

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let network = style::net::onnx::read(&files::read(&arguments.model)?)
        .ok_or_else(|| Failure::input("the model is none that is trained here"))?;
    let photo = |path| Photo::new(&files::read_picture(path)?.to_rgb8()).map_err(Failure::input);
    let photos = arguments
        .photos
        .iter()
        .map(|path| photo(path))
        .collect::<Result<Vec<_>, Failure>>()?;
    let trainer = Trainer::new(&photos, network.takes_range(), arguments.seed, 1);
    for (scenes, draws) in SETS {
        let of = |weights| score_over(weights, &photos, scenes.clone(), draws).losses;
        let (start, end) = (of(trainer.color_transfer()), of(&network));
        println!(
            "| {} to {} | {:.3}, {:.3}, {:.3} | {:.2}, {:.2}, {:.2} |",
            scenes.start,
            scenes.end - 1,
            start.texture,
            start.color,
            start.content,
            end.texture / start.texture,
            end.color / start.color,
            end.content / start.content
        );
    }
    Ok(())
}
