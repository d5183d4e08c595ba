//! Random draws of a step: filters, directions and patch positions, each addressed by (step, purpose).

use imaging::random::Stream;

use crate::real::Real;

/// Side of a patch in pixels.
pub(crate) const PATCH: usize = 7;
/// Numbers in a patch: three channels.
pub(crate) const PATCH_LENGTH: usize = 3 * PATCH * PATCH;
/// Random filters per level.
pub(crate) const FILTERS: usize = 24;
/// Random directions in color per level.
pub(crate) const DIRECTIONS: usize = 16;

/// Standard normal values (Box and Muller 1958) in the order of their addresses.
pub(crate) fn normals(stream: &Stream, index: u64) -> impl Iterator<Item = f64> + '_ {
    (0..).flat_map(move |pair: u64| {
        let (u, v) = (stream.unit(index, 2 * pair), stream.unit(index, 2 * pair + 1));
        let radius = (-2.0 * libm::log(1.0 - u)).sqrt();
        let angle = 2.0 * std::f64::consts::PI * v;
        [radius * libm::cos(angle), radius * libm::sin(angle)]
    })
}

/// Filters `[filter][channel, row, column]`: the first half is narrow, each channel has mean zero, every third filter
/// sees brightness only, all have length 1.
pub(crate) fn filters<T: Real>(stream: &Stream, index: u64) -> Vec<[T; PATCH_LENGTH]> {
    let mut values = normals(stream, index);
    let filters = (0..FILTERS).map(|filter| {
        let mut taps = [0.0; PATCH_LENGTH];
        for (i, tap) in taps.iter_mut().enumerate() {
            let [row, column] =
                [i / PATCH % PATCH, i % PATCH].map(|side| (side as f64 - 3.0) * (side as f64 - 3.0));
            let narrow = libm::exp(-(row + column) / 2.0);
            *tap = values.next().unwrap_or_default() * if filter < FILTERS / 2 { narrow } else { 1.0 };
        }
        let area = PATCH * PATCH;
        for channel in taps.chunks_exact_mut(area) {
            let mean = channel.iter().sum::<f64>() / area as f64;
            channel.iter_mut().for_each(|tap| *tap -= mean);
        }
        if filter.is_multiple_of(3) {
            for i in 0..area {
                let mean = (taps[i] + taps[area + i] + taps[2 * area + i]) / 3.0;
                for channel in 0..3 {
                    taps[channel * area + i] = mean;
                }
            }
        }
        let length = taps.iter().map(|tap| tap * tap).sum::<f64>().sqrt().max(1e-12);
        taps.map(|tap| T::from_f64(tap / length))
    });
    filters.collect()
}

/// Unit directions in color.
pub(crate) fn directions<T: Real>(stream: &Stream, index: u64) -> Vec<[T; 3]> {
    let mut values = normals(stream, index);
    (0..DIRECTIONS)
        .map(|_| {
            let direction = [0; 3].map(|_| values.next().unwrap_or_default());
            let length = direction.iter().map(|v| v * v).sum::<f64>().sqrt().max(1e-12);
            direction.map(|value| T::from_f64(value / length))
        })
        .collect()
}

/// Position of a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct PatchPosition {
    pub(crate) x: usize,
    pub(crate) y: usize,
}

/// Positions of patches in a picture of this size.
pub(crate) fn places(
    stream: &Stream,
    index: u64,
    count: usize,
    (width, height): (usize, usize),
) -> Vec<PatchPosition> {
    let places = (0..count as u64).map(|patch| {
        let bits = stream.bits(index, patch);
        let [x, y] = [(bits, width), (bits >> 32, height)].map(|(half, side)| {
            let range = (side - PATCH + 1) as u64;
            (((half & 0xffff_ffff) * range) >> 32) as usize
        });
        PatchPosition { x, y }
    });
    places.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filters_have_length_one_and_no_mean_and_every_third_is_gray() {
        let filters = filters::<f64>(&Stream::stage(1, "test"), 0);
        for (index, filter) in filters.iter().enumerate() {
            let length: f64 = filter.iter().map(|tap| tap * tap).sum();
            assert!((length - 1.0).abs() < 1e-12);
            for channel in filter.chunks(PATCH * PATCH) {
                assert!(channel.iter().sum::<f64>().abs() < 1e-12);
            }
            assert_eq!(filter[5] == filter[PATCH * PATCH + 5], index % 3 == 0);
        }
    }

    #[test]
    fn places_fill_the_picture_and_stay_inside() {
        let places = places(&Stream::stage(1, "test"), 3, 4000, (9, 8));
        let furthest = |of: fn(&PatchPosition) -> usize| places.iter().map(of).max();
        assert_eq!((furthest(|p| p.x), furthest(|p| p.y)), (Some(2), Some(1)));
    }
}
