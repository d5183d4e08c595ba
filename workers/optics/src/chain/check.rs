//! Preconditions of all computations of light.

use imaging::vectorized;
use imaging::{Plane, Rgb};
use spec::HoleRule;

use crate::forward_scatter::MAX_REFERENCE_PIXELS;
use crate::range::is_hole;

/// A frame that cannot go through the chain.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ChainError {
    /// The frame has zero pixels.
    #[error("the frame is empty: {width}×{height}")]
    Empty {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// Radiance and range are of different sizes.
    #[error("range map is {range_width}×{range_height} but the image is {width}×{height}")]
    Sizes {
        /// Columns of the image.
        width: usize,
        /// Rows of the image.
        height: usize,
        /// Columns of the range map.
        range_width: usize,
        /// Rows of the range map.
        range_height: usize,
    },
    /// Radiance that is not finite.
    #[error("radiance is {value} in channel {channel} of pixel ({x}, {y}) but must be finite")]
    NotFinite {
        /// Column of the first such pixel.
        x: usize,
        /// Its row.
        y: usize,
        /// Its channel.
        channel: char,
        /// Its value.
        value: f32,
    },
    /// Holes under a rule that refuses them.
    #[error("{holes} pixels have no valid range and the rule for holes is `reject`")]
    Holes {
        /// How many.
        holes: usize,
    },
    /// The reference was called on a large frame.
    #[error("the reference takes frames of at most {MAX_REFERENCE_PIXELS} pixels but this one has {pixels}")]
    ReferenceTooLarge {
        /// Pixels of the frame.
        pixels: usize,
    },
}

/// Makes radiance fit for the chain: negative samples become 0. Returns how many.
///
/// # Errors
/// [`ChainError::NotFinite`] naming the first pixel in row order, so that one bad sample never spreads over a frame.
pub fn check_radiance(radiance: &mut Rgb<f32>) -> Result<u64, ChainError> {
    let width = radiance.width();
    let first = radiance
        .planes()
        .iter()
        .zip(['R', 'G', 'B'])
        .filter_map(|(plane, channel)| {
            let index = plane.data().iter().position(|v| !v.is_finite())?;
            Some((index, channel, plane.data()[index]))
        });
    if let Some((index, channel, value)) = first.min_by_key(|(index, ..)| *index) {
        return Err(ChainError::NotFinite {
            x: index % width,
            y: index / width,
            channel,
            value,
        });
    }
    let mut negative = 0;
    for plane in radiance.planes_mut() {
        for sample in plane.iter_mut().filter(|sample| **sample < 0.0) {
            *sample = 0.0;
            negative += 1;
        }
    }
    Ok(negative)
}

pub(super) fn sizes(
    (width, height): (usize, usize),
    (range_width, range_height): (usize, usize),
) -> Result<(), ChainError> {
    if width == 0 || height == 0 {
        return Err(ChainError::Empty { width, height });
    }
    if (width, height) != (range_width, range_height) {
        return Err(ChainError::Sizes {
            width,
            height,
            range_width,
            range_height,
        });
    }
    Ok(())
}

/// Counts the holes, or rejects them if the rule does.
pub(super) fn holes<T: Copy + Into<f64>>(range: &Plane<T>, rule: HoleRule) -> Result<u64, ChainError> {
    let holes = vectorized!(range.data().iter().filter(|&&z| is_hole(z)).count());
    if rule == HoleRule::Reject && holes > 0 {
        return Err(ChainError::Holes { holes });
    }
    Ok(holes as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_bad_pixel_is_named_and_negative_light_is_counted() {
        let mut radiance = Rgb::from_fn(3, 2, |x, y| [x as f32 - 1.0, y as f32, 0.5]);
        assert_eq!(check_radiance(&mut radiance), Ok(2));
        assert_eq!(radiance.pixel(0, 1)[0], 0.0);
        radiance.planes_mut()[1][4] = f32::INFINITY;
        let error = check_radiance(&mut radiance).unwrap_err();
        assert_eq!(
            error.to_string(),
            "radiance is inf in channel G of pixel (1, 1) but must be finite"
        );
    }
}
