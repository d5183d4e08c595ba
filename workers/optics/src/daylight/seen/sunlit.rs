//! Where the sun is seen.

use imaging::rays::{Rays, ShadowRays, leaving};
use imaging::vector::DVec3;
use imaging::{Plane, vectorized};

use super::super::SunLight;
use super::{Surfaces, to_sea};
use crate::attenuation::masked;
use crate::daylight::conditions::Daylight;
use crate::range::is_hole;
use crate::view::lattice::trace_changes;

/// Whether each pixel's surface sees the sun: 1, or 0; 0 also where it turns away from the sun, and at holes.
#[must_use]
pub fn sunlit_reference(
    surfaces: Surfaces<'_>,
    daylight: &Daylight,
    sun: &SunLight,
    rays: &dyn Rays,
) -> Plane<f32> {
    let toward = sun.toward(&daylight.gaze);
    Plane::from_fn(surfaces.range.width(), surfaces.range.height(), |x, y| {
        let normal = surfaces.normal(x, y).map(f64::from);
        if is_hole(surfaces.range.pixel(x, y)) || DVec3::from(normal).dot(toward.into()) <= 0.0 {
            return 0.0;
        }
        let place = surfaces.place(daylight, x, y);
        let meters = to_sea(daylight, place, sun.rise);
        let start = leaving(place.into(), normal);
        let is_seen = meters <= start.from || !rays.occluded(start.origin, toward, start.from, meters);
        f32::from(u8::from(is_seen))
    })
}

/// [`sunlit_reference`] in ray packets, traced where it changes. In large pictures, shadows of a few pixels may be missed.
#[must_use]
pub fn sunlit(surfaces: Surfaces<'_>, daylight: &Daylight, sun: &SunLight, rays: &dyn Rays) -> Plane<f32> {
    let (width, height) = surfaces.range.size();
    let toward = sun.toward(&daylight.gaze);
    let single = toward.map(|v| v as f32);
    let mut is_facing = vec![false; width * height];
    for (y, is_facing) in is_facing.chunks_mut(width).enumerate() {
        let normals = surfaces.normals.each_ref().map(|axis| axis.row(y));
        vectorized!(find_facing(surfaces.range.row(y), normals, single, is_facing));
    }
    let (mut ways, mut clear) = (ShadowRays::default(), Vec::new());
    let lit = trace_changes(
        (surfaces.range, daylight.gaze.camera.focal_px),
        |at| is_facing[at],
        0.0,
        |pixels, shares| {
            ways.clear();
            for &at in pixels {
                let (x, y) = (at % width, at / width);
                let place = surfaces.place(daylight, x, y);
                let start = DVec3::from(leaving(place.into(), surfaces.normal(x, y).map(f64::from)).origin);
                let way = DVec3::from(toward) * to_sea(daylight, place, sun.rise);
                ways.push(super::single(start), super::single(start + way));
            }
            clear.clear();
            clear.resize(pixels.len(), false);
            rays.trace_shadow_rays(&ways, &mut clear);
            shares.clear();
            shares.extend(clear.iter().map(|&clear| f32::from(u8::from(clear))));
        },
    );
    Plane::new(width, height, lit).expect("one value for each pixel")
}

/// Which surfaces face a direction.
#[inline(always)]
fn find_facing(range: &[f32], [nx, ny, nz]: [&[f32]; 3], toward: [f32; 3], is_facing: &mut [bool]) {
    let len = range.len();
    let (nx, ny, nz, is_facing) = (&nx[..len], &ny[..len], &nz[..len], &mut is_facing[..len]);
    for i in 0..len {
        let facing = nx[i] * toward[0] + ny[i] * toward[1] + nz[i] * toward[2];
        is_facing[i] = masked(range[i]).0 & (facing > 0.0);
    }
}
