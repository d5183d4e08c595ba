//! The definition, plane by plane in f64.

use imaging::{Plane, Rgb8, lab, transfer};
use spec::Mlle;

use super::color::{ChannelTransfer, Transfer};
use super::definition::{NEUTRAL, WHITE, balance};
use crate::blocks::lab::exact_lab;
use crate::blocks::{binomial_exact, window_mean};
use crate::variant::Variant;

pub(super) fn enhance(picture: &Rgb8, transfer: &Transfer, parameters: &Mlle) -> Rgb8 {
    let (width, height) = (picture.width(), picture.height());
    let corrected = corrected(picture, transfer, parameters.attenuation_gamma);
    let lab = Plane::from_fn(width, height, |x, y| {
        exact_lab(corrected.each_ref().map(|plane| plane.pixel(x, y)))
    });
    let lightness = contrasted(&lab.map(|lab| lab[0] / WHITE), parameters);
    let opponents = [1, 2].map(|c| lab.map(|lab| lab[c] + NEUTRAL));
    let factors = balance(opponents.each_ref().map(mean));
    Rgb8::from_fn(width, height, |x, y| {
        let l = (WHITE * lightness.pixel(x, y)).clamp(0.0, WHITE);
        let [a, b] = [0, 1].map(|i| factors[i] * opponents[i].pixel(x, y) - NEUTRAL);
        lab::to_linear([l, a, b], lab::from_xyz())
            .map(|light| (255.0 * transfer::encode(light.clamp(0.0, 1.0)) + 0.5).floor() as u8)
    })
}

fn mean(plane: &Plane<f64>) -> f64 {
    plane.data().iter().sum::<f64>() / plane.data().len() as f64
}

/// Steps 1 and 2.
fn corrected(picture: &Rgb8, transfer: &Transfer, gamma: f64) -> [Plane<f64>; 3] {
    let channels = picture
        .to_planes()
        .map(|plane| plane.map(|&code| f64::from(code) / 255.0));
    let blurred = channels.each_ref().map(binomial_exact);
    std::array::from_fn(|c| {
        Plane::from_fn(picture.width(), picture.height(), |x, y| {
            let own = channels[c].pixel(x, y);
            let transferred = match transfer.channels()[c] {
                ChannelTransfer::Stretched(line) => line.value(own),
                ChannelTransfer::Filled(share, line) => {
                    own + share * line.value(channels[transfer.largest()].pixel(x, y))
                }
            };
            let attenuation = channels
                .each_ref()
                .map(|plane| 1.0 - plane.pixel(x, y).powf(gamma))
                .into_iter()
                .fold(0.0, f64::max);
            let detail = own - blurred[c].pixel(x, y);
            (detail + attenuation * transferred + (1.0 - attenuation) * own).clamp(0.0, 1.0)
        })
    })
}

/// Step 3 for lightness in 0..=1.
fn contrasted(lightness: &Plane<f64>, parameters: &Mlle) -> Plane<f64> {
    let (width, height) = lightness.size();
    let radius = parameters.window_px / 2;
    let whole = mean(lightness);
    let variance_of_all = mean(&lightness.map(|l| (l - whole).powi(2)));
    let local = window_means(lightness, radius);
    let squares = window_means(&product(lightness, lightness), radius);
    let variance = Plane::from_fn(width, height, |x, y| {
        (squares.pixel(x, y) - local.pixel(x, y).powi(2)).max(0.0)
    });
    let expanded = Plane::from_fn(width, height, |x, y| {
        let (mean, variance) = (local.pixel(x, y), variance.pixel(x, y));
        let gain = if variance * parameters.contrast_max > variance_of_all {
            variance_of_all / variance
        } else {
            parameters.contrast_max
        };
        mean + gain * (lightness.pixel(x, y) - mean)
    });
    let expanded_mean = window_means(&expanded, radius);
    let products = window_means(&product(lightness, &expanded), radius);
    let slope = Plane::from_fn(width, height, |x, y| {
        let covariance = products.pixel(x, y) - local.pixel(x, y) * expanded_mean.pixel(x, y);
        covariance / (variance.pixel(x, y) + parameters.guide_eps)
    });
    let offset = Plane::from_fn(width, height, |x, y| {
        expanded_mean.pixel(x, y) - slope.pixel(x, y) * local.pixel(x, y)
    });
    let (slope, offset) = (window_means(&slope, radius), window_means(&offset, radius));
    Plane::from_fn(width, height, |x, y| {
        slope.pixel(x, y) * lightness.pixel(x, y) + offset.pixel(x, y)
    })
}

fn product(a: &Plane<f64>, b: &Plane<f64>) -> Plane<f64> {
    Plane::from_fn(a.width(), a.height(), |x, y| a.pixel(x, y) * b.pixel(x, y))
}

fn window_means(plane: &Plane<f64>, radius: usize) -> Plane<f64> {
    let [mean] = window_mean([plane], radius, Variant::Reference);
    mean
}
