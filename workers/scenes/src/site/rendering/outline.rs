//! The part of the picture where a solid can appear.

use std::ops::Range;

use imaging::vector::Vec3;

use crate::site::camera::ViewCamera;
use crate::site::solid::Solid;

/// Near plane of outlines, m.
const NEAR_M: f32 = 0.02;
/// Margin around the outline, px.
const MARGIN_PX: f32 = 1.0;

/// The convex outline of a solid's box in the picture.
pub(crate) struct Outline {
    rows: Range<usize>,
    /// Segments whose hull is the outline.
    lines: Vec<[(f32, f32); 2]>,
    width: usize,
}

impl Outline {
    pub(crate) fn new(solid: &Solid, camera: &ViewCamera) -> Self {
        let corners = solid.corners().map(|corner| camera.axes_of(corner));
        let mut points: Vec<Vec3> = corners
            .iter()
            .copied()
            .filter(|corner| corner.z >= NEAR_M)
            .collect();
        let whole = points.len() == corners.len();
        let edges = (0..8usize).flat_map(|i| [1, 2, 4].map(|bit| (i, i | bit)));
        let edges = edges.filter(|(a, b)| a != b);
        for (a, b) in edges.clone() {
            let (a, b) = (corners[a], corners[b]);
            if (a.z < NEAR_M) != (b.z < NEAR_M) {
                points.push(a + (b - a) * ((NEAR_M - a.z) / (b.z - a.z)));
            }
        }
        let seen: Vec<(f32, f32)> = points.iter().map(|point| camera.project(*point)).collect();
        // A convex body is inside the hull of its edges; a clipped one inside the hull of all its corners.
        let lines: Vec<_> = if whole {
            edges.map(|(a, b)| [seen[a], seen[b]]).collect()
        } else {
            let pairs = (0..seen.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
            pairs.map(|(a, b)| [seen[a], seen[b]]).collect()
        };
        let low = seen.iter().fold(f32::INFINITY, |low, point| low.min(point.1));
        let high = seen
            .iter()
            .fold(f32::NEG_INFINITY, |high, point| high.max(point.1));
        Self {
            rows: pixel_range(low, high, camera.height),
            lines,
            width: camera.width,
        }
    }

    /// The columns of a row where the solid may be hit.
    pub(crate) fn columns(&self, y: usize) -> Range<usize> {
        if !self.rows.contains(&y) {
            return 0..0;
        }
        let (top, bottom) = (y as f32 - MARGIN_PX, y as f32 + MARGIN_PX);
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        for [a, b] in &self.lines {
            let (a, b) = if a.1 <= b.1 { (a, b) } else { (b, a) };
            if b.1 < top || a.1 > bottom {
                continue;
            }
            let first = crossing(*a, *b, top.max(a.1));
            let last = if b.1 > bottom {
                crossing(*a, *b, bottom)
            } else {
                b.0
            };
            low = low.min(first.min(last));
            high = high.max(first.max(last));
        }
        pixel_range(low, high, self.width)
    }
}

fn pixel_range(low: f32, high: f32, side: usize) -> Range<usize> {
    if low > high {
        return 0..0;
    }
    let start = (low - MARGIN_PX).floor().clamp(0.0, side as f32) as usize;
    start..((high + MARGIN_PX).ceil() + 1.0).clamp(start as f32, side as f32) as usize
}

/// The column of a segment at a row between its ends.
fn crossing(a: (f32, f32), b: (f32, f32), y: f32) -> f32 {
    let slope = (b.0 - a.0) / (b.1 - a.1);
    if b.1 > a.1 { a.0 + (y - a.1) * slope } else { a.0 }
}

#[cfg(test)]
mod tests {
    use imaging::geometry::Intrinsics;
    use imaging::vector::vec3;

    use super::*;
    use crate::CameraPose;
    use crate::site::pose::Pose;
    use crate::site::solid::{EyeRays, Nearest, Tube};

    /// Tubes in every direction, some of them past the camera.
    #[test]
    fn no_ray_outside_the_outline_meets_the_solid() {
        let lens = Intrinsics::centered(40.0, 64, 48);
        let pose = CameraPose::looking(vec3(0.0, -3.0, 0.3), vec3(0.2, 0.0, 0.1), 0.1);
        let camera = ViewCamera::new(&pose, (64, 48), &lens);
        let mut met = 0;
        for turn in 0..60 {
            let (sin, cos) = libm::sincosf(turn as f32 * 0.4);
            let lift = (turn % 7) as f32 - 3.0;
            let (a, b) = (
                vec3(-2.0 * cos, -2.0 * sin, -0.2 * lift),
                vec3(4.0 * cos, 4.0 * sin, lift),
            );
            let tube = Tube {
                radius: 0.2,
                length: (b - a).length(),
            };
            let solid = Solid {
                shape: tube.into(),
                pose: Pose::pointing(a, b, 0.0),
                object: 1,
            };
            let outline = Outline::new(&solid, &camera);
            for y in 0..48 {
                let (mut parameter, mut owner) = ([f32::INFINITY; 64], [1; 64]);
                let rays = EyeRays {
                    eye: camera.eye,
                    first: camera.ray(0.0, y as f32),
                    step: camera.column_step(),
                };
                let nearest = Nearest {
                    parameter: &mut parameter,
                    owner: &mut owner,
                };
                solid.meet(&rays, nearest, 0);
                let columns = outline.columns(y);
                for x in (0..64).filter(|&x| owner[x] == 0) {
                    assert!(columns.contains(&x), "tube {turn} at ({x}, {y}): {columns:?}");
                    met += 1;
                }
            }
        }
        assert!(met > 1000);
    }
}
