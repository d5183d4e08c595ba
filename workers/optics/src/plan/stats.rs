//! What a plan needs to know of a scene.

use imaging::{Plane, Rgb};

use crate::range::{HoleRule, is_hole};
use crate::water::Water;

/// Distinct ranges are counted up to here: with more, interpolation takes fewer kernels than there are ranges.
const MOST_DISTINCT: usize = 32;

/// Bounds of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneStats {
    /// Nearest and farthest valid range in metres, holes by the water's rule; none if every pixel is a hole.
    pub range_m: Option<(f64, f64)>,
    /// The distinct ranges, if there are few.
    pub distinct_m: Option<Vec<f32>>,
    /// Pixels without a valid range.
    pub holes: usize,
    /// Largest radiance of each channel.
    pub brightest: [f32; 3],
    /// The longer side of the frame in pixels.
    pub longer_side: usize,
}

impl SceneStats {
    /// Measures a scene.
    #[must_use]
    pub fn measure(radiance: &Rgb<f32>, range: &Plane<f32>, water: &Water) -> Self {
        let holes = range.data().iter().filter(|&&z| is_hole(z)).count();
        let stand_in = match water.holes {
            HoleRule::Range(metres) if holes > 0 => Some(metres as f32),
            _ => None,
        };
        let mut distinct = Some(Vec::new());
        let (mut nearest, mut farthest, mut last) = (f32::INFINITY, 0.0f32, f32::NAN);
        for z in range
            .data()
            .iter()
            .copied()
            .filter(|&z| !is_hole(z))
            .chain(stand_in)
        {
            nearest = nearest.min(z);
            farthest = farthest.max(z);
            if z != last {
                last = z;
                note(&mut distinct, z);
            }
        }
        Self {
            range_m: (nearest <= farthest).then_some((f64::from(nearest), f64::from(farthest))),
            distinct_m: distinct,
            holes,
            brightest: radiance
                .planes()
                .each_ref()
                .map(|p| p.data().iter().copied().fold(0.0, f32::max)),
            longer_side: radiance.width().max(radiance.height()),
        }
    }
}

fn note(distinct: &mut Option<Vec<f32>>, z: f32) {
    if let Some(seen) = distinct
        && !seen.contains(&z)
    {
        if seen.len() == MOST_DISTINCT {
            *distinct = None;
        } else {
            seen.push(z);
        }
    }
}
