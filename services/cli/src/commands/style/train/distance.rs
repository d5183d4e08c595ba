//! How far a style's color table is from its network, on new scenes.

use imaging::{Plane, Rgb, lab, transfer};
use rayon::prelude::*;
use style::TableDistance;
use style::net::layer::Weights;
use style::net::{ColorTable, Network, Scratch, TableScratch};

/// The measurements of one scene.
struct Scene {
    /// Differences of samples, of 255.
    differences: Vec<f64>,
    similarity: f64,
    /// Mean color difference of its pixels.
    color: f64,
}

/// The distances on new scenes; `None` for a network with a range input, which has no table.
pub(super) fn measure(weights: &Weights) -> Option<TableDistance> {
    let network = Network::new(weights);
    let table = ColorTable::new(&network)?;
    let scenes: Vec<Scene> = training::new_scenes()
        .par_iter()
        .map(|scene: &Rgb<f32>| {
            let exact = network.apply(scene, None, &mut Scratch::default());
            let near = table.apply(scene, &mut TableScratch::default());
            let planes = exact.planes().iter().zip(near.planes());
            let pairs = planes.flat_map(|(a, b)| a.data().iter().zip(b.data()));
            let places = (0..exact.height()).flat_map(|y| (0..exact.width()).map(move |x| (x, y)));
            let pixels = (exact.width() * exact.height()) as f64;
            Scene {
                differences: pairs.map(|(a, b)| f64::from((a - b).abs()) * 255.0).collect(),
                similarity: quality::ssim_reference(&gray(&exact), &gray(&near)),
                color: places
                    .map(|(x, y)| {
                        let (one, other) = (lab_of(exact.pixel(x, y)), lab_of(near.pixel(x, y)));
                        let squares = one.iter().zip(other).map(|(a, b)| (a - b) * (a - b));
                        squares.sum::<f64>().sqrt()
                    })
                    .sum::<f64>()
                    / pixels,
            }
        })
        .collect();
    // Summed in the order of the scenes, for a deterministic result; all scenes have one size.
    let mean = |of: fn(&Scene) -> f64| scenes.iter().map(of).sum::<f64>() / scenes.len() as f64;
    let mut differences: Vec<f64> = scenes
        .iter()
        .flat_map(|scene| &scene.differences)
        .copied()
        .collect();
    differences.sort_by(f64::total_cmp);
    let last = differences.len() - 1;
    let rounded = |value: f64| (value * 1e4).round() / 1e4;
    Some(TableDistance {
        mean_255: rounded(differences.iter().sum::<f64>() / differences.len() as f64),
        high_255: rounded(differences[last - last / 1000]),
        max_255: rounded(differences[last]),
        ssim: rounded(mean(|scene| scene.similarity)),
        delta_e: rounded(mean(|scene| scene.color)),
    })
}

fn gray(picture: &Rgb<f32>) -> Plane<u8> {
    Plane::from_fn(picture.width(), picture.height(), |x, y| {
        let codes = picture.pixel(x, y).map(|value| (255.0 * value).round() as u8);
        (imaging::luma1000(codes) / 1000) as u8
    })
}

/// CIE Lab of an sRGB-encoded color.
fn lab_of(color: [f32; 3]) -> [f64; 3] {
    lab::of_linear(color.map(|value| transfer::decode(f64::from(value))))
}
