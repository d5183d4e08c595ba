//! Cross-checked nearest neighbors: two features match if each has the smallest Hamming distance to the other of all
//! features of the other frame, and that distance is at most [`MOST_BITS`]. Of equal distances the first feature counts.

use imaging::{cancel, vectorized};

use super::descriptor::Descriptor;
use super::features::Features;

/// Largest distance of a match. Unrelated descriptors differ in 128 of 256 bits with a standard deviation of about 20.
pub const MOST_BITS: u32 = 64;

/// A feature of a frame and one of its previous frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Match {
    /// Index of the feature in the current frame.
    pub current: u32,
    /// Index of the feature in the previous frame.
    pub previous: u32,
}

/// All matches, in the order of the current frame's features.
#[must_use]
pub fn match_features(current: &Features, previous: &Features) -> Vec<Match> {
    if previous.descriptors.is_empty() {
        return Vec::new();
    }
    // One word of all descriptors after the other, so that a loop over features is a vector loop.
    let words: [Vec<u64>; 4] =
        std::array::from_fn(|word| previous.descriptors.iter().map(|bits| bits[word]).collect());
    let mut best_current = vec![u32::MAX; previous.descriptors.len()];
    let mut best_previous = Vec::with_capacity(current.descriptors.len());
    for (index, bits) in current.descriptors.iter().enumerate() {
        if index % 64 == 0 {
            cancel::check();
        }
        best_previous.push(vectorized!(nearest(
            *bits,
            words.each_ref().map(Vec::as_slice),
            index as u32,
            &mut best_current
        )));
    }
    let pairs = best_previous.into_iter().enumerate();
    let mutual = pairs.filter(|&(index, key)| {
        key >> INDEX_BITS <= MOST_BITS && best_current[(key & INDEX) as usize] & INDEX == index as u32
    });
    mutual
        .map(|(index, key)| Match {
            current: index as u32,
            previous: key & INDEX,
        })
        .collect()
}

/// A distance and the index of a feature in one number: the smallest is the nearest, of equal ones the first.
const INDEX_BITS: u32 = 16;
const INDEX: u32 = (1 << INDEX_BITS) - 1;

/// The key of the nearest feature; updates the nearest of each of them.
#[inline(always)]
fn nearest(bits: Descriptor, words: [&[u64]; 4], index: u32, best_current: &mut [u32]) -> u32 {
    let count = best_current.len();
    let words = words.map(|word| &word[..count]);
    let mut best = u32::MAX;
    for other in 0..count {
        let mut distance = 0;
        for word in 0..4 {
            distance += (bits[word] ^ words[word][other]).count_ones();
        }
        let distance = distance << INDEX_BITS;
        best_current[other] = best_current[other].min(distance | index);
        best = best.min(distance | other as u32);
    }
    best
}

#[cfg(test)]
mod tests {
    use imaging::random::Stream;

    use super::*;

    fn random(seed: u64, count: u64) -> Features {
        let stream = Stream::stage(seed, "descriptors");
        let near = Stream::stage(1, "descriptors");
        Features {
            keypoints: Vec::new(),
            // Some bits of common descriptors are flipped, so that many match.
            descriptors: (0..count)
                .map(|i| {
                    [0, 1, 2, 3].map(|word| {
                        near.bits(i % 40, word)
                            ^ (stream.bits(i, word) & stream.bits(i, word + 4) & stream.bits(i, word + 8))
                    })
                })
                .collect(),
        }
    }

    fn match_by_definition(current: &Features, previous: &Features) -> Vec<Match> {
        let distance = |a: &Descriptor, b: &Descriptor| -> u32 {
            (0..256)
                .filter(|bit| (a[bit / 64] ^ b[bit / 64]) >> (bit % 64) & 1 == 1)
                .count() as u32
        };
        let find_nearest = |bits: &Descriptor, others: &[Descriptor]| {
            (0..others.len()).min_by_key(|&other| (distance(bits, &others[other]), other))
        };
        let mut matches = Vec::new();
        for (i, bits) in current.descriptors.iter().enumerate() {
            let Some(j) = find_nearest(bits, &previous.descriptors) else {
                continue;
            };
            let back = find_nearest(&previous.descriptors[j], &current.descriptors);
            if back == Some(i) && distance(bits, &previous.descriptors[j]) <= MOST_BITS {
                matches.push(Match {
                    current: i as u32,
                    previous: j as u32,
                });
            }
        }
        matches
    }

    #[test]
    fn matches_agree_with_the_definition() {
        let frames = [random(2, 150), random(3, 131), random(4, 1), random(5, 0)];
        for current in &frames {
            for previous in &frames {
                let matches = match_features(current, previous);
                assert_eq!(matches, match_by_definition(current, previous));
            }
        }
        assert!(match_features(&frames[0], &frames[1]).len() > 15);
    }

    #[test]
    fn a_frame_matches_itself_and_unrelated_descriptors_do_not_match() {
        let stream = |seed| Stream::stage(seed, "unrelated");
        let [one, other] = [7, 8].map(|seed| Features {
            keypoints: Vec::new(),
            descriptors: (0..200)
                .map(|i| [0, 1, 2, 3].map(|word| stream(seed).bits(i, word)))
                .collect(),
        });
        let itself = match_features(&one, &one);
        assert!(itself.len() == 200 && itself.iter().all(|pair| pair.current == pair.previous));
        assert!(match_features(&one, &other).is_empty());
    }
}
