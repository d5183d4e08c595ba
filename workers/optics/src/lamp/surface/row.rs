//! Where the surfaces of a row are.

use std::ops::Range;

use imaging::Plane;
use imaging::geometry::Intrinsics;

use crate::attenuation::masked;

/// Surfaces of one row, or of a few rows in sequence.
#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    /// Where the surfaces are in camera axes, how far from the camera, and 1, or 0 at a hole.
    pub(super) places: [&'a [f32]; 5],
    pub(super) normals: [&'a [f32]; 3],
    /// Halvings per meter.
    pub(super) attenuation: [f32; 3],
    pub(super) radius: f32,
}

impl<'a> Row<'a> {
    /// Those of some points, with the normals of the frame from a pixel on.
    pub(super) fn new(
        (places, own): (&'a [Vec<f32>; 5], Range<usize>),
        (normals, at): (&'a [Plane<f32>; 3], usize),
        (attenuation, radius): ([f32; 3], f32),
    ) -> Self {
        let count = own.len();
        Self {
            places: places.each_ref().map(|lane| &lane[own.clone()]),
            normals: normals.each_ref().map(|plane| &plane.data()[at..at + count]),
            attenuation,
            radius,
        }
    }
}

/// Camera parameters for [`places_of`]: 1/f and the principal point, px.
pub(super) fn lens(camera: &Intrinsics) -> [f32; 3] {
    [1.0 / camera.focal_px, camera.cx, camera.cy].map(|v| v as f32)
}

/// Computes the surface points of row `y`: the lanes of [`Row::places`].
#[inline(always)]
pub(super) fn places_of([inverse_focal, cx, cy]: [f32; 3], y: f32, range: &[f32], to: &mut [&mut [f32]; 5]) {
    let width = range.len();
    let [px, py, pz, meters, shown] = to.each_mut().map(|lane| &mut lane[..width]);
    let v = (y - cy) * inverse_focal;
    for i in 0..width {
        let u = (i as f32 - cx) * inverse_focal;
        let (valid, z) = masked(range[i]);
        // At this distance no light arrives, and the square is still finite.
        let z = z.min(1e6);
        let planar = z / u.mul_add(u, v.mul_add(v, 1.0)).sqrt();
        (px[i], py[i], pz[i], meters[i]) = (u * planar, v * planar, planar, z);
        shown[i] = if valid { 1.0 } else { 0.0 };
    }
}
