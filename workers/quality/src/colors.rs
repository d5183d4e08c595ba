//! The distinct colors of a picture, usually far fewer than pixels.

use crate::work::{MetricInput, SharedPart};

/// All colors in the order of R, then G, then B, and their counts.
pub(crate) struct Colors {
    /// Codes of one color after the other.
    pub(crate) codes: Vec<u8>,
    pub(crate) counts: Vec<u32>,
    /// Number of pixels of the picture.
    pub(crate) pixels: usize,
}

impl SharedPart for Colors {
    fn new(work: &MetricInput) -> Self {
        let picture = work.picture();
        let pixels = picture.data().len() / 3;
        // Sorted by red and green in one pass over their pairs; the blues of a pair are few.
        let pair = |pixel: &[u8; 3]| usize::from(pixel[0]) << 8 | usize::from(pixel[1]);
        let mut ends = vec![0u32; 1 << 16];
        for pixel in picture.pixels() {
            ends[pair(&pixel)] += 1;
        }
        let mut start = 0;
        for end in &mut ends {
            start += std::mem::replace(end, start);
        }
        let mut blues = vec![0u8; pixels];
        for pixel in picture.pixels() {
            let end = &mut ends[pair(&pixel)];
            blues[*end as usize] = pixel[2];
            *end += 1;
        }
        let (mut codes, mut counts) = (Vec::new(), Vec::new());
        let mut start = 0;
        for (pair, end) in ends.into_iter().enumerate() {
            let blues = &mut blues[start..end as usize];
            blues.sort_unstable();
            for run in blues.chunk_by(|a, b| a == b) {
                codes.extend([(pair >> 8) as u8, pair as u8, run[0]]);
                counts.push(run.len() as u32);
            }
            start = end as usize;
        }
        Self {
            codes,
            counts,
            pixels,
        }
    }
}

#[cfg(test)]
mod tests {
    use imaging::Rgb8;

    use super::*;
    use crate::subject::Subject;

    #[test]
    fn equal_colors_are_counted_together_in_order() {
        let picture = Rgb8::from_fn(5, 1, |x, _| {
            [[9, 0, 5], [0, 255, 3], [9, 0, 2], [0, 255, 3], [9, 0, 5]][x]
        });
        let colors = Colors::new(&MetricInput::new(&Subject::new(&picture)));
        assert_eq!(colors.codes, [0, 255, 3, 9, 0, 2, 9, 0, 5]);
        assert_eq!((colors.counts, colors.pixels), (vec![2, 1, 2], 5));
    }
}
