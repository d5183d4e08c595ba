//! Length of feature tracks.

use super::nearest::Match;

/// Most earlier frames of a track.
pub const TRACK_FRAMES: usize = 5;

/// Mean length of the tracks that end in the features of the current frame: the number of consecutive earlier frames
/// reached by correct matches. 0 for a frame without features.
///
/// `pairs` holds the correct matches of neighboring frames, the newest pair first: the features of the current frame with
/// those of the previous one, and so on. The result is at most their number.
#[must_use]
pub fn track_length(features: usize, pairs: &[Vec<Match>]) -> f64 {
    if features == 0 {
        return 0.0;
    }
    // The features of a frame that a track from the current frame has reached. Matches are one to one.
    let mut reached: Vec<u32> = (0..features as u32).collect();
    let mut steps = 0;
    for matches in pairs {
        let mut next = Vec::new();
        for pair in matches {
            if reached.binary_search(&pair.current).is_ok() {
                next.push(pair.previous);
            }
        }
        next.sort_unstable();
        steps += next.len();
        reached = next;
    }
    steps as f64 / features as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(current: u32, previous: u32) -> Match {
        Match { current, previous }
    }

    #[test]
    fn a_track_ends_at_the_first_missing_match() {
        // Of four features: 0 is followed over three frames, 1 over one, 2 and 3 not at all. The match of feature 9 of
        // the second frame belongs to no track.
        let pairs = [
            vec![pair(0, 7), pair(1, 3)],
            vec![pair(7, 2), pair(9, 4)],
            vec![pair(2, 0), pair(4, 1), pair(3, 5)],
        ];
        assert_eq!(track_length(4, &pairs), 1.0);
        assert_eq!(track_length(4, &pairs[..1]), 0.5);
    }

    #[test]
    fn without_features_or_pairs_the_length_is_0() {
        assert_eq!(track_length(0, &[vec![]]), 0.0);
        assert_eq!(track_length(10, &[]), 0.0);
        assert_eq!(track_length(3, &[vec![], vec![pair(0, 0)]]), 0.0);
    }
}
