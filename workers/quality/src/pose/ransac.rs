//! Relative pose in the presence of wrong matches: RANSAC with the truncated cost of MSAC (Torr and Zisserman 2000).

use imaging::random::Stream;
use imaging::{cancel, vectorized};

use super::essential::{choose_in_front, find_poses};
use super::five_point::solve_five_points;
use super::matrix::Matrix;
use super::rays::{RayLists, RayPair, RelativePose, square_distances};
use super::refine::{essential_matrix, refine};

/// Largest Sampson distance of an inlier, px.
const INLIER_PX: f64 = 2.0;
/// Most samples of five.
const SAMPLES: usize = 1000;
/// Least samples, and solutions to refine.
const LEAST_SAMPLES: usize = 100;
const REFINED: usize = 10;
/// Sampling ends when the probability that no sample was free of outliers is below this.
const MISSED: f64 = 1e-4;
/// Pairs of a sample.
const FIVE: usize = 5;

/// Matched rays of two frames.
#[derive(Debug, Clone, Copy)]
pub struct MatchedRays<'a> {
    /// One pair of rays per match.
    pub pairs: &'a [RayPair],
    /// Angle of a pixel, rad.
    pub pixel_rad: f64,
    /// Address of the samples in the random stream.
    pub seed: u64,
}

/// Estimates the pose; the translation has length 1. `None` for fewer than five pairs, and if no sample of five has a
/// solution.
#[must_use]
pub fn estimate_pose(matched: &MatchedRays) -> Option<RelativePose> {
    let pairs = matched.pairs;
    if pairs.len() < FIVE {
        return None;
    }
    let limit = INLIER_PX * matched.pixel_rad;
    let mut consensus = Consensus {
        rays: RayLists::new(pairs),
        limit_square: limit * limit,
        squares: vec![0.0; pairs.len()],
    };
    // The cost of inliers is truncated, so refinement ends in the nearest of several minima.
    let mut best: Option<(RelativePose, f64)> = None;
    for e in find_candidates(&mut consensus, pairs, matched.seed) {
        let Some([start, ..]) = find_poses(&e) else {
            continue;
        };
        let limit_square = consensus.limit_square;
        let (pose, cost) = refine(start, pairs, limit_square, |pose| {
            consensus.cost(&essential_matrix(pose))
        });
        if best.is_none_or(|(_, least)| cost < least) {
            best = Some((pose, cost));
        }
    }
    let e = essential_matrix(&best?.0);
    consensus.cost(&e);
    let inliers: Vec<RayPair> = consensus.inliers().map(|index| pairs[index]).collect();
    choose_in_front(find_poses(&e)?, &inliers)
}

/// The essential matrices of samples with the lowest costs.
fn find_candidates(consensus: &mut Consensus, pairs: &[RayPair], seed: u64) -> Vec<Matrix> {
    let stream = Stream::stage(seed, "relative-pose");
    let mut solutions: Vec<(f64, Matrix)> = Vec::new();
    let (mut least, mut inliers) = (f64::INFINITY, 0);
    for sample in 0..SAMPLES {
        cancel::check();
        let five = draw_five(&stream, sample as u64, pairs.len()).map(|index| pairs[index]);
        for e in solve_five_points(&five) {
            let cost = consensus.cost(&e);
            solutions.push((cost, e));
            if cost < least {
                (least, inliers) = (cost, consensus.inliers().count());
            }
        }
        let share = inliers as f64 / pairs.len() as f64;
        if sample + 1 >= LEAST_SAMPLES && (1.0 - share.powi(FIVE as i32)).powi(sample as i32 + 1) < MISSED {
            break;
        }
    }
    // The sort is stable: of equal costs the first sample counts.
    solutions.sort_by(|(one, _), (other, _)| one.total_cmp(other));
    solutions.truncate(REFINED);
    solutions.into_iter().map(|(_, e)| e).collect()
}

/// Five different indices below `count`.
fn draw_five(stream: &Stream, sample: u64, count: usize) -> [usize; FIVE] {
    let mut drawn = [usize::MAX; FIVE];
    for i in 0..FIVE {
        // The index among those not drawn yet, by passing over the drawn ones in their order.
        let mut index = (stream.unit(sample, i as u64) * (count - i) as f64) as usize;
        let mut passed = drawn;
        passed[..i].sort_unstable();
        for &other in &passed[..i] {
            index += usize::from(other <= index);
        }
        drawn[i] = index;
    }
    drawn
}

/// The distances of all pairs from an essential matrix.
struct Consensus {
    rays: RayLists,
    limit_square: f64,
    squares: Vec<f64>,
}

impl Consensus {
    /// `Σ min(d² / limit², 1)`; keeps the distances.
    fn cost(&mut self, e: &Matrix) -> f64 {
        let mut squares = std::mem::take(&mut self.squares);
        vectorized!(square_distances(&self.rays, e, &mut squares));
        self.squares = squares;
        truncated_sum(&self.squares, self.limit_square)
    }

    /// The pairs within the limit of the matrix measured last.
    fn inliers(&self) -> impl Iterator<Item = usize> {
        (0..self.squares.len()).filter(|&index| self.squares[index] < self.limit_square)
    }
}

fn truncated_sum(squares: &[f64], limit_square: f64) -> f64 {
    squares
        .iter()
        .map(|square| (square / limit_square).min(1.0))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::error::pose_error;
    use crate::pose::rays::tests::{Scene, synthetic_pairs};

    const PIXEL_RAD: f64 = 0.002;

    fn estimate(pairs: &[RayPair], seed: u64) -> Option<RelativePose> {
        estimate_pose(&MatchedRays {
            pairs,
            pixel_rad: PIXEL_RAD,
            seed,
        })
    }

    /// Replaces the rays of the current frame in every second pair by those of others.
    fn spoil(pairs: &mut [RayPair]) {
        let rays: Vec<_> = pairs.iter().map(|pair| pair.current).collect();
        let count = pairs.len();
        for (i, pair) in pairs.iter_mut().enumerate().step_by(2) {
            pair.current = rays[(i + 37) % count];
        }
    }

    #[test]
    fn exact_pairs_have_their_exact_pose() {
        for seed in 0..20 {
            let (pairs, truth) = synthetic_pairs(Scene::Cloud, seed, 50, 0.0);
            let error = pose_error(estimate(&pairs, seed).as_ref(), &truth);
            assert!(error.deg < 1e-5 && error.m < 1e-5, "{seed}: {error:?}");
        }
    }

    #[test]
    fn half_a_pixel_of_noise_and_half_the_matches_wrong_leave_the_pose() {
        for seed in 0..20 {
            let (mut pairs, truth) = synthetic_pairs(Scene::Cloud, seed, 300, 0.5 * PIXEL_RAD);
            spoil(&mut pairs);
            let error = pose_error(estimate(&pairs, seed).as_ref(), &truth);
            let most = 0.2 * truth.translation.length();
            assert!(error.deg < 0.5 && error.m < most, "{seed}: {error:?} {most}");
        }
    }

    /// A plane allows two poses: no matches on it decide between them.
    #[test]
    fn a_plane_has_its_pose_or_the_other_that_explains_all_matches() {
        let mut right = 0;
        for seed in 0..20 {
            let (pairs, truth) = synthetic_pairs(Scene::Plane, seed, 50, 0.0);
            let pose = estimate(&pairs, seed).unwrap();
            let mut squares = vec![0.0; pairs.len()];
            square_distances(&RayLists::new(&pairs), &essential_matrix(&pose), &mut squares);
            assert!(
                squares.iter().all(|square| *square < 1e-16),
                "{seed}: {squares:?}"
            );
            right += usize::from(pose_error(Some(&pose), &truth).deg < 1e-5);
        }
        assert!((4..=20).contains(&right), "{right}");
    }

    #[test]
    fn a_pure_rotation_is_found_without_a_translation() {
        for seed in 0..20 {
            let (mut pairs, truth) = synthetic_pairs(Scene::Rotation, seed, 200, 0.5 * PIXEL_RAD);
            spoil(&mut pairs);
            let error = pose_error(estimate(&pairs, seed).as_ref(), &truth);
            assert!(error.deg < 0.5 && error.m == 0.0, "{seed}: {error:?}");
        }
    }

    #[test]
    fn an_estimate_depends_on_pairs_and_seed_alone() {
        let (mut pairs, _) = synthetic_pairs(Scene::Cloud, 5, 80, 0.5 * PIXEL_RAD);
        spoil(&mut pairs);
        assert_eq!(estimate(&pairs, 1), estimate(&pairs, 1));
        assert_ne!(estimate(&pairs, 1), None);
    }

    #[test]
    fn too_few_or_equal_pairs_have_no_pose_or_a_finite_one() {
        let (pairs, truth) = synthetic_pairs(Scene::Cloud, 5, 4, 0.0);
        assert_eq!(estimate(&pairs, 1), None);
        assert_eq!(estimate(&[], 1), None);
        let error = pose_error(estimate(&[pairs[0]; 30], 1).as_ref(), &truth);
        assert!(error.deg.is_finite() && error.m.is_finite());
    }

    #[test]
    fn samples_are_five_different_pairs() {
        let stream = Stream::stage(3, "relative-pose");
        let mut seen = [0; 6];
        for sample in 0..300 {
            let mut five = draw_five(&stream, sample, 6);
            five.sort_unstable();
            assert!(
                five.windows(2).all(|pair| pair[0] < pair[1]) && five[4] < 6,
                "{five:?}"
            );
            for index in five {
                seen[index] += 1;
            }
        }
        assert!(seen.iter().all(|&count| (220..280).contains(&count)), "{seen:?}");
    }
}
