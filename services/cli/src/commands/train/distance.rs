//! How far a style's colour table is from its network, on new scenes.

use imaging::{Plane, Rgb, transfer};
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

pub(super) fn measure(weights: &Weights) -> TableDistance {
    let network = Network::new(weights);
    let table = Table::of(&network);
    let (mut scratch, mut table_scratch) = (Scratch::default(), TableScratch::default());
    let (mut differences, mut similarity, mut colour, mut pixels) = (Vec::new(), 0.0, 0.0, 0.0);
    let scenes = training::new_scenes();
    for scene in &scenes {
        let exact = network.apply(scene, &mut scratch);
        let near = table.apply(scene, &mut table_scratch);
        for (a, b) in exact.planes().iter().zip(near.planes()) {
            let pairs = a.data().iter().zip(b.data());
            differences.extend(pairs.map(|(a, b)| f64::from((a - b).abs()) * 255.0));
        }
        similarity += quality::ssim_reference(&gray(&exact), &gray(&near)) / scenes.len() as f64;
        for y in 0..exact.height() {
            for x in 0..exact.width() {
                let (one, other) = (lab(exact.at(x, y)), lab(near.at(x, y)));
                let squares: f64 = one.iter().zip(other).map(|(a, b)| (a - b) * (a - b)).sum();
                colour += squares.sqrt();
                pixels += 1.0;
            }
        }
    }
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
