//! Warnings about frames that probably nobody wants: saturated, hidden by the water, or of one color.

use imaging::Rgb8;

use crate::context::FrameContext;

/// Share of clamped samples above which a frame is saturated.
const CLAMPED_SHARE: f64 = 0.5;
/// Transmittance that at least one pixel must have.
const LEAST_TRANSMITTANCE: f64 = 1e-3;

const SATURATED: &str = "more than half of the samples are outside 0 to 1 and clamped; check the exposure, the scale of a float \
                         picture, and whether the style's network gives 0 to 1";
const HIDDEN: &str = "no pixel has a transmittance above 0.001, so the water hides the scene; check the unit of the range and the water";
const UNIFORM: &str = "the standard deviation of the picture is below one code";

/// The warnings of a developed frame with this number of clamped samples.
pub(crate) fn list_warnings(context: &FrameContext<'_>, rgb: &Rgb8, clamped: u64) -> Vec<String> {
    let samples = rgb.data().len() as f64;
    let is_saturated = clamped as f64 > CLAMPED_SHARE * samples;
    let is_hidden =
        find_greatest_transmittance(context).is_some_and(|greatest| greatest <= LEAST_TRANSMITTANCE);
    let warnings = [
        (is_saturated, SATURATED),
        (is_hidden, HIDDEN),
        (is_uniform(rgb), UNIFORM),
    ];
    let warnings = warnings.into_iter().filter(|(applies, _)| *applies);
    warnings.map(|(_, warning)| warning.to_owned()).collect()
}

/// An upper bound of the transmittance of all pixels, reached in uniform water; `None` without water or range.
fn find_greatest_transmittance(context: &FrameContext<'_>) -> Option<f64> {
    let [nearest_m, _] = context.view.as_ref()?.range_m()?;
    let attenuation = context.setting.water.as_ref()?.direct_attenuation();
    let clearest = attenuation.into_iter().fold(f64::INFINITY, f64::min);
    let [_, shortest, _] = context.path_factors.unwrap_or([1.0; 3]);
    Some((-clearest * nearest_m * shortest).exp())
}

/// Whether the variance of all samples about the means of their channels is below 1. The sum of squares of the first
/// rows is a lower bound, so pictures with structure end after a few rows.
fn is_uniform(picture: &Rgb8) -> bool {
    let samples = picture.data().len() as f64;
    let width = picture.width().max(1);
    let (mut pixels, mut sums, mut squares) = (0.0, [0u64; 3], [0u64; 3]);
    for row in picture.data().chunks(3 * width) {
        for pixel in row.as_chunks::<3>().0 {
            for (band, &code) in pixel.iter().enumerate() {
                sums[band] += u64::from(code);
                squares[band] += u64::from(code) * u64::from(code);
            }
        }
        pixels += (row.len() / 3) as f64;
        let deviations: f64 = sums
            .iter()
            .zip(&squares)
            .map(|(&sum, &square)| square as f64 - sum as f64 * sum as f64 / pixels)
            .sum();
        if deviations >= samples {
            return false;
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The definition.
    fn variance(picture: &Rgb8) -> f64 {
        let pixels = (picture.data().len() / 3) as f64;
        let band = |band: usize| {
            picture
                .data()
                .iter()
                .skip(band)
                .step_by(3)
                .map(|&code| f64::from(code))
        };
        let deviations = (0..3).map(|index| {
            let mean = band(index).sum::<f64>() / pixels;
            band(index).map(|code| (code - mean).powi(2)).sum::<f64>()
        });
        deviations.sum::<f64>() / (3.0 * pixels)
    }

    #[test]
    fn a_picture_is_uniform_if_its_variance_is_below_one() {
        let pictures = [
            Rgb8::from_fn(9, 7, |_, _| [255; 3]),
            Rgb8::from_fn(9, 7, |x, _| [(x % 2) as u8, 40, 200]),
            Rgb8::from_fn(9, 7, |_, y| if y == 6 { [90; 3] } else { [80; 3] }),
            Rgb8::from_fn(9, 7, |x, y| [(20 * x) as u8, (20 * y) as u8, 3]),
            Rgb8::from_fn(9, 7, |x, y| if (x, y) == (8, 6) { [17; 3] } else { [10; 3] }),
            Rgb8::from_fn(9, 7, |x, y| if (x, y) == (8, 6) { [19; 3] } else { [10; 3] }),
        ];
        let uniform = pictures.each_ref().map(is_uniform);
        assert_eq!(
            uniform,
            pictures.each_ref().map(|picture| variance(picture) < 1.0)
        );
        assert_eq!(uniform, [true, true, false, false, true, false]);
    }
}
