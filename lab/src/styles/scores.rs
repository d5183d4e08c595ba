//! Variation of the ratios of a trained water to its color transfer with the scenes of the score.

use cli::exit::Failure;
use cli::files;
use training::{Photo, Trainer, score_over};

use crate::report::Report;
use crate::row;
use crate::setup::{Parameter, Setup};
use crate::table::Table;

/// The parameters of the scores.
pub const PARAMETERS: &[Parameter] = &[Parameter::number(
    "seed",
    "1",
    [0.0, 1e15],
    "the seed of the training",
)];
/// Ranges of new scenes, and how often patches are drawn.
const SETS: [(std::ops::Range<u64>, u64); 6] = [
    (0..64, 3),
    (64..128, 3),
    (0..16, 6),
    (16..32, 6),
    (32..48, 6),
    (48..64, 6),
];

/// Scores a model over several sets of scenes. The inputs are the model, made by `fathom train`, and the photos of its training.
///
/// # Errors
/// The model or a photo cannot be read.
pub fn run(setup: &Setup) -> Result<Report, Failure> {
    let (model, photos) = match setup.inputs.as_slice() {
        [model, photos @ ..] if !photos.is_empty() => (model, photos),
        _ => {
            return Err(Failure::input(
                "name a model made by `fathom train` and the photos of its training",
            ));
        }
    };
    let network = style::net::onnx::read(&files::read(model)?).ok_or_else(|| {
        Failure::BadInput(format!("{}: not a model made by `fathom train`", model.display()))
    })?;
    let photos = photos
        .iter()
        .map(|path| Photo::new(&files::read_picture(path)?.to_rgb8()).map_err(Failure::input))
        .collect::<Result<Vec<_>, Failure>>()?;
    let trainer = Trainer::new(&photos, network.takes_range(), setup.number("seed") as u64, 1);
    let columns = ["scenes", "color transfer: texture, color, content", "ratios"];
    let mut table = Table::new("scores", columns);
    for (scenes, draws) in SETS {
        let [start, end] = [trainer.color_transfer(), &network]
            .map(|weights| score_over(weights, &photos, scenes.clone(), draws).losses);
        let ratios = [
            end.texture / start.texture,
            end.color / start.color,
            end.content / start.content,
        ];
        table.push(row![
            format!("{} to {}", scenes.start, scenes.end - 1),
            format!("{:.3}, {:.3}, {:.3}", start.texture, start.color, start.content),
            ratios.map(|ratio| format!("{ratio:.2}")).join(", "),
        ]);
    }
    Ok(Report::new(
        format!("{} against its color transfer.", model.display()),
        vec![table],
    ))
}
