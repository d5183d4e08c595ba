//! What every form of a solid computes.

use imaging::vector::Vec3;

use crate::site::bounds::Bounds;
use crate::site::lanes::larger;

/// Geometry of a shape in its frame, in meters. Implementations are inlined into loops over many points or rays.
pub(super) trait ShapeGeometry {
    /// Parameter of the first hit of the ray from `o` along `d`; infinite for a miss.
    fn enter(&self, o: Vec3, d: Vec3) -> f32;
    /// Signed distance of a point from the surface; see [`Solid::approach`].
    fn distance(&self, p: Vec3) -> f32;
    /// Unit normal at a point of the surface and closeness of the point to an edge, 0..1; see [`Solid::normals`].
    fn normal(&self, p: Vec3, bevel: f32) -> (Vec3, f32);
    /// A box around the solid, or around its hollow.
    fn bounds(&self) -> Bounds;
}

/// The distance of a point from a box about the origin; negative inside.
#[inline(always)]
pub(super) fn beyond_box(p: Vec3, half: Vec3) -> f32 {
    let away = p.zip(half, |p, half| larger(p.abs() - half, 0.0)).length();
    if away > 0.0 { away } else { f32::NEG_INFINITY }
}
