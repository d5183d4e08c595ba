//! The definition, plane by plane in f64.

use imaging::{Plane, Rgb8};
use spec::Fusion;

use super::definition::{Fused, LUMA, SALIENCY_SCALE, WEIGHT_FLOOR, balance, compensation, count_levels};
use crate::blocks::lab::exact_lab;
use crate::blocks::{FLAT, binomial_exact, range};

pub(super) fn fuse(picture: &Rgb8, parameters: &Fusion) -> Fused {
    let channels = picture
        .to_planes()
        .map(|plane| plane.map(|&code| f64::from(code) / 255.0));
    let coefficients = compensation(parameters, channels.each_ref().map(mean));
    let compensated: [Plane<f64>; 3] = std::array::from_fn(|c| {
        combine(&channels[c], &channels[1], |value, green| {
            (value + coefficients[c] * (1.0 - value) * green).min(1.0)
        })
    });
    let gains = balance(compensated.each_ref().map(mean));
    let balanced: [Plane<f64>; 3] =
        std::array::from_fn(|c| compensated[c].map(|value| (value * gains[c]).min(1.0)));
    let first = balanced
        .each_ref()
        .map(|plane| plane.map(|value| value.powf(parameters.gamma)));
    let (second, detail) = sharpen(&balanced);

    let weights = [&first, &second].map(weight);
    let share = combine(&weights[0], &weights[1], |a, b| {
        (a + WEIGHT_FLOOR) / (a + b + 2.0 * WEIGHT_FLOOR)
    });
    let levels = count_levels(parameters.levels, picture.width(), picture.height());
    let shares = [share.clone(), share.map(|share| 1.0 - share)].map(|share| gaussian(&share, levels));
    let fused: [Plane<f64>; 3] = std::array::from_fn(|c| {
        let details = [&first[c], &second[c]].map(|plane| laplacian(&gaussian(plane, levels)));
        let blended = (0..levels).map(|l| {
            let [a, b] =
                [0, 1].map(|k| combine(&shares[k][l], &details[k][l], |share, detail| share * detail));
            combine(&a, &b, |a, b| a + b)
        });
        let blended: Vec<Plane<f64>> = blended.collect();
        let coarsest = blended[levels - 1].clone();
        blended[..levels - 1].iter().rev().fold(coarsest, |sum, level| {
            combine(level, &double(&sum, level.size()), |a, b| a + b)
        })
    });
    Fused {
        picture: Rgb8::from_fn(picture.width(), picture.height(), |x, y| {
            fused
                .each_ref()
                .map(|plane| (255.0 * plane.pixel(x, y).clamp(0.0, 1.0) + 0.5) as u8)
        }),
        balance: gains,
        detail,
    }
}

fn mean(plane: &Plane<f64>) -> f64 {
    plane.data().iter().sum::<f64>() / plane.data().len() as f64
}

fn combine(a: &Plane<f64>, b: &Plane<f64>, join: impl Fn(f64, f64) -> f64) -> Plane<f64> {
    Plane::from_fn(a.width(), a.height(), |x, y| join(a.pixel(x, y), b.pixel(x, y)))
}

/// Input 2, and its gain for differences.
fn sharpen(balanced: &[Plane<f64>; 3]) -> ([Plane<f64>; 3], f64) {
    let details = balanced
        .each_ref()
        .map(|plane| combine(plane, &binomial_exact(plane), |value, blurred| value - blurred));
    let ends = details.each_ref().map(|plane| range(plane.data()));
    let low = ends.iter().fold(f64::MAX, |low, ends| low.min(ends.0));
    let high = ends.iter().fold(f64::MIN, |high, ends| high.max(ends.1));
    if high - low <= FLAT {
        return (balanced.clone(), 0.0);
    }
    let scale = 1.0 / (high - low);
    let sharpened = std::array::from_fn(|c| {
        combine(&balanced[c], &details[c], |value, detail| {
            0.5 * (value + (detail - low) * scale)
        })
    });
    (sharpened, 0.5 * scale)
}

/// `w` of step 4.
fn weight(input: &[Plane<f64>; 3]) -> Plane<f64> {
    let (width, height) = input[0].size();
    let color = |x: usize, y: usize| input.each_ref().map(|plane| plane.pixel(x, y));
    let luma = Plane::from_fn(width, height, |x, y| {
        color(x, y)
            .iter()
            .zip(LUMA)
            .map(|(value, weight)| weight * value)
            .sum::<f64>()
    });
    let lab = Plane::from_fn(width, height, |x, y| exact_lab(color(x, y)));
    let lab = [0, 1, 2].map(|c| lab.map(|lab| lab[c]));
    let means = lab.each_ref().map(mean);
    let blurred = lab.each_ref().map(binomial_exact);
    Plane::from_fn(width, height, |x, y| {
        let own = luma.pixel(x, y);
        let neighbors = luma.pixel(x.saturating_sub(1), y)
            + luma.pixel((x + 1).min(width - 1), y)
            + luma.pixel(x, y.saturating_sub(1))
            + luma.pixel(x, (y + 1).min(height - 1));
        let contrast = (4.0 * own - neighbors).abs();
        let distance = (0..3)
            .map(|c| (means[c] - blurred[c].pixel(x, y)).powi(2))
            .sum::<f64>()
            .sqrt();
        let saturation = (color(x, y).map(|value| (value - own).powi(2)).iter().sum::<f64>() / 3.0).sqrt();
        contrast + SALIENCY_SCALE * distance + saturation
    })
}

/// The levels of a plane, the finest first.
fn gaussian(plane: &Plane<f64>, levels: usize) -> Vec<Plane<f64>> {
    let mut pyramid = vec![plane.clone()];
    while pyramid.len() < levels {
        let blurred = binomial_exact(&pyramid[pyramid.len() - 1]);
        let (width, height) = blurred.size();
        pyramid.push(Plane::from_fn(width.div_ceil(2), height.div_ceil(2), |x, y| {
            blurred.pixel(2 * x, 2 * y)
        }));
    }
    pyramid
}

/// Each level without the next coarser one; the coarsest as it is.
fn laplacian(gaussian: &[Plane<f64>]) -> Vec<Plane<f64>> {
    let finer = gaussian.windows(2).map(|levels| {
        combine(
            &levels[0],
            &double(&levels[1], levels[0].size()),
            |fine, coarse| fine - coarse,
        )
    });
    finer.chain([gaussian[gaussian.len() - 1].clone()]).collect()
}

/// A level at the size of the next finer one.
fn double(coarse: &Plane<f64>, (width, height): (usize, usize)) -> Plane<f64> {
    let along = Plane::from_fn(width, coarse.height(), |x, y| {
        doubled(x, coarse.width(), |i| coarse.pixel(i, y))
    });
    Plane::from_fn(width, height, |x, y| {
        doubled(y, coarse.height(), |j| along.pixel(x, j))
    })
}

/// Sample `i` of a doubled row of `n` samples.
fn doubled(i: usize, n: usize, sample: impl Fn(usize) -> f64) -> f64 {
    let half = i / 2;
    let after = sample((half + 1).min(n - 1));
    if i % 2 == 1 {
        0.5 * (sample(half) + after)
    } else {
        (sample(half.saturating_sub(1)) + 6.0 * sample(half) + after) / 8.0
    }
}
