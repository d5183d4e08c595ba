//! How far a style's colour table is from its network, on new scenes.

use imaging::{Plane, Rgb, transfer};
use rayon::prelude::*;
use style::TableDistance;
use style::net::layer::Weights;
use style::net::{Network, Scratch, Table, TableScratch};

/// Brightness of linear light and the three axes of CIE XYZ for a white of D65, as in IEC 61966-2-1.
const XYZ: [[f64; 3]; 3] = [
    [0.4124, 0.3576, 0.1805],
    [0.2126, 0.7152, 0.0722],
    [0.0193, 0.1192, 0.9505],
];
const WHITE: [f64; 3] = [0.9505, 1.0, 1.089];

/// What one scene says.
struct Scene {
    /// Differences of samples, of 255.
    differences: Vec<f64>,
    similarity: f64,
    /// Colour differences of pixels.
    colour: Vec<f64>,
}

pub(super) fn measure(weights: &Weights) -> TableDistance {
    let network = Network::new(weights);
    let table = Table::of(&network);
    let of_scene = |scene: &Rgb<f32>| {
        let exact = network.apply(scene, &mut Scratch::default());
        let near = table.apply(scene, &mut TableScratch::default());
        let planes = exact.planes().iter().zip(near.planes());
        let pairs = planes.flat_map(|(a, b)| a.data().iter().zip(b.data()));
        let places = (0..exact.height()).flat_map(|y| (0..exact.width()).map(move |x| (x, y)));
        let apart = |(x, y)| {
            let (one, other) = (lab(exact.at(x, y)), lab(near.at(x, y)));
            let squares = one.iter().zip(other).map(|(a, b)| (a - b) * (a - b));
            squares.sum::<f64>().sqrt()
        };
        Scene {
            differences: pairs.map(|(a, b)| f64::from((a - b).abs()) * 255.0).collect(),
            similarity: quality::ssim_reference(&gray(&exact), &gray(&near)),
            colour: places.map(apart).collect(),
        }
    };
    let scenes: Vec<Scene> = training::new_scenes().par_iter().map(of_scene).collect();
    // In the order of the scenes, whichever was ready first.
    let similarity = scenes
        .iter()
        .map(|scene| scene.similarity / scenes.len() as f64)
        .sum();
    let colours = || scenes.iter().flat_map(|scene| &scene.colour);
    let (colour, pixels) = (colours().sum::<f64>(), colours().count() as f64);
    let mut differences: Vec<f64> = scenes
        .iter()
        .flat_map(|scene| &scene.differences)
        .copied()
        .collect();
    differences.sort_by(f64::total_cmp);
    let last = differences.len() - 1;
    let rounded = |value: f64| (value * 1e4).round() / 1e4;
    TableDistance {
        mean_255: rounded(differences.iter().sum::<f64>() / differences.len() as f64),
        high_255: rounded(differences[last - last / 1000]),
        max_255: rounded(differences[last]),
        ssim: rounded(similarity),
        delta_e: rounded(colour / pixels),
    }
}

fn gray(picture: &Rgb<f32>) -> Plane<u8> {
    Plane::from_fn(picture.width(), picture.height(), |x, y| {
        let codes = picture.at(x, y).map(|value| (255.0 * value).round() as u8);
        (imaging::luma1000(codes) / 1000) as u8
    })
}

/// CIE L*a*b* of an sRGB-encoded colour.
fn lab(colour: [f32; 3]) -> [f64; 3] {
    let linear = colour.map(|value| transfer::decode(f64::from(value)));
    let [x, y, z] = [0, 1, 2].map(|axis| {
        let sum: f64 = XYZ[axis]
            .iter()
            .zip(linear)
            .map(|(share, light)| share * light)
            .sum();
        let value = sum / WHITE[axis];
        if value > 216.0 / 24389.0 {
            value.cbrt()
        } else {
            (24389.0 / 27.0 * value + 16.0) / 116.0
        }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_and_gray_have_no_colour_and_red_has_its_known_place() {
        for (value, lightness) in [(1.0, 100.0), (0.0, 0.0)] {
            let [l, a, b] = lab([value; 3]);
            assert!(
                (l - lightness).abs() < 0.05 && a.abs() < 0.05 && b.abs() < 0.05,
                "{l} {a} {b}"
            );
        }
        for (found, expected) in lab([1.0, 0.0, 0.0]).into_iter().zip([53.24, 80.09, 67.2]) {
            assert!((found - expected).abs() < 0.1, "{found} {expected}");
        }
    }
}
