//! The definition, plane by plane in double precision.

use imaging::Plane;

use super::{Guide, solve};
use crate::blocks::box_mean;
use crate::method::Variant;

pub(super) fn guided(guide: &Guide, plane: &Plane<f64>) -> Plane<f64> {
    let (width, height) = plane.size();
    let mean = |plane: &Plane<f64>| box_mean(plane, guide.radius_px, Variant::Reference);
    let product =
        |a: &Plane<f64>, b: &Plane<f64>| Plane::from_fn(width, height, |x, y| a.at(x, y) * b.at(x, y));
    let colors = guide
        .channels
        .each_ref()
        .map(|codes| codes.map(|&code| guide.scale * f64::from(code)));
    let means = colors.each_ref().map(mean);
    let plane_mean = mean(plane);

    let covariance = |a: (&Plane<f64>, &Plane<f64>), b: (&Plane<f64>, &Plane<f64>)| {
        let products = mean(&product(a.0, b.0));
        Plane::from_fn(width, height, |x, y| {
            products.at(x, y) - a.1.at(x, y) * b.1.at(x, y)
        })
    };
    let channel = |i: usize| (&colors[i], &means[i]);
    let pairs = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
    let spread = pairs.map(|(i, j)| covariance(channel(i), channel(j)));
    let with_plane = [0, 1, 2].map(|i| covariance(channel(i), (plane, &plane_mean)));

    let slopes = Plane::from_fn(width, height, |x, y| {
        let mut matrix = spread.each_ref().map(|plane| plane.at(x, y));
        for diagonal in [0, 3, 5] {
            matrix[diagonal] += guide.regularization;
        }
        solve(matrix, with_plane.each_ref().map(|plane| plane.at(x, y)))
    });
    let offset = Plane::from_fn(width, height, |x, y| {
        let slope = slopes.at(x, y);
        plane_mean.at(x, y) - (0..3).map(|i| slope[i] * means[i].at(x, y)).sum::<f64>()
    });
    let slopes = [0, 1, 2].map(|i| mean(&slopes.map(|slope| slope[i])));
    let offset = mean(&offset);
    Plane::from_fn(width, height, |x, y| {
        (0..3)
            .map(|i| slopes[i].at(x, y) * colors[i].at(x, y))
            .sum::<f64>()
            + offset.at(x, y)
    })
}
