//! How far the ratios of a trained water to its colour transfer move with the scenes they are taken over:
//! `scenes SEED MODEL.onnx PHOTO...`, seed and photos as in its training. Prints rows of a Markdown table.

use imaging::codec::decode_picture;
use training::{Photo, Trainer, score_over};

/// New scenes, and how often patches are drawn.
const SETS: [(std::ops::Range<u64>, u64); 6] = [
    (0..64, 3),
    (64..128, 3),
    (0..16, 6),
    (16..32, 6),
    (32..48, 6),
    (48..64, 6),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let [seed, model, photos @ ..] = given.as_slice() else {
        return Err("give a seed, a model and its photos".into());
    };
    let network = style::net::onnx::read(&std::fs::read(model)?).ok_or("no model that is trained here")?;
    let photos = photos
        .iter()
        .map(|path| Ok(Photo::new(&decode_picture(&std::fs::read(path)?)?.to_rgb8())?))
        .collect::<Result<Vec<_>, Box<dyn std::error::Error>>>()?;
    let trainer = Trainer::new(&photos, seed.parse()?, 1);
    for (scenes, draws) in SETS {
        let of = |weights| score_over(weights, &photos, scenes.clone(), draws).losses;
        let (start, end) = (of(trainer.colour_transfer()), of(&network));
        println!(
            "| {} to {} | {:.3}, {:.3}, {:.3} | {:.2}, {:.2}, {:.2} |",
            scenes.start,
            scenes.end - 1,
            start.texture,
            start.colour,
            start.content,
            end.texture / start.texture,
            end.colour / start.colour,
            end.content / start.content
        );
    }
    Ok(())
}
