//! Code histograms of a picture's channels.

use imaging::Rgb8;

pub(crate) type CodeCounts = [u64; 256];

/// Curves of red, green and blue over the codes, in 0..=255.
pub(crate) type Curves = [[f64; 256]; 3];

/// The histograms of red, green and blue.
pub(crate) fn histograms(picture: &Rgb8) -> [CodeCounts; 3] {
    // Two sets, so that equal neighbors do not wait for each other.
    let mut counts = [[[0u32; 256]; 3]; 2];
    for (i, pixel) in picture.data().chunks_exact(3).enumerate() {
        let set = &mut counts[i % 2];
        for c in 0..3 {
            set[c][usize::from(pixel[c])] += 1;
        }
    }
    let [even, odd] = counts;
    std::array::from_fn(|c| std::array::from_fn(|code| u64::from(even[c][code]) + u64::from(odd[c][code])))
}

/// Number of samples.
pub(crate) fn total(histogram: &CodeCounts) -> u64 {
    histogram.iter().sum()
}

/// Sum of the codes.
pub(crate) fn sum(histogram: &CodeCounts) -> u64 {
    (0..).zip(histogram).map(|(code, count)| code * count).sum()
}

/// Mean code; the histogram must not be empty.
pub(crate) fn mean(histogram: &CodeCounts) -> f64 {
    sum(histogram) as f64 / total(histogram) as f64
}

/// The smallest and the largest code present.
pub(crate) fn ends(histogram: &CodeCounts) -> (usize, usize) {
    let low = histogram.iter().position(|&count| count > 0).unwrap_or(0);
    let high = histogram.iter().rposition(|&count| count > 0).unwrap_or(0);
    (low, high)
}

/// The code at a position of the sorted codes.
pub(crate) fn code_at(histogram: &CodeCounts, position: u64) -> usize {
    let mut before = 0;
    let found = histogram.iter().position(|&count| {
        before += count;
        before > position
    });
    found.unwrap_or(255)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_counted_and_ranked() {
        let picture = Rgb8::from_fn(5, 1, |x, _| [[3, 3, 7, 9, 250][x], 0, 255]);
        let [red, green, blue] = histograms(&picture);
        assert_eq!((total(&red), mean(&red), ends(&red)), (5, 54.4, (3, 250)));
        assert_eq!(
            [0, 1, 2, 4].map(|position| code_at(&red, position)),
            [3, 3, 7, 250]
        );
        assert_eq!((ends(&green), ends(&blue)), ((0, 0), (255, 255)));
    }
}
