//! Where the sun is seen.

use imaging::rays::{OFFSET, Rays, ShadowRays, leaving};
use imaging::vector::DVec3;
use imaging::{Plane, vectorized};

use super::super::SunLight;
use super::{SQUARE, Surfaces, to_sea};
use crate::attenuation::masked;
use crate::daylight::conditions::Daylight;
use crate::range::is_hole;

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

/// [`sunlit_reference`] in ray packets.
#[must_use]
pub fn sunlit(surfaces: Surfaces<'_>, daylight: &Daylight, sun: &SunLight, rays: &dyn Rays) -> Plane<f32> {
    let (width, height) = surfaces.range.size();
    let sight = Sight::new(daylight, sun);
    let mut lit = Plane::filled(width, height, 0.0f32);
    let mut band = Band::new(width);
    let (mut ways, mut pixels, mut clear) = (ShadowRays::default(), Vec::new(), Vec::new());
    for top in (0..height).step_by(SQUARE) {
        let rows = SQUARE.min(height - top);
        for row in 0..rows {
            band.fill(row, top + row, surfaces, &sight);
        }
        ways.clear();
        pixels.clear();
        for left in (0..width).step_by(SQUARE) {
            let columns = left..(left + SQUARE).min(width);
            for row in 0..rows {
                let first = row * width;
                let ends = first + columns.start..first + columns.end;
                if band.counts[ends.clone()].iter().all(|&counts| counts) {
                    let axes = ways.from.iter_mut().chain(&mut ways.to);
                    for (axis, band) in axes.zip(band.from.iter().chain(&band.to)) {
                        axis.extend_from_slice(&band[ends.clone()]);
                    }
                    pixels.extend(ends.map(|at| (top * width + at) as u32));
                    continue;
                }
                for at in ends.filter(|&at| band.counts[at]) {
                    let place = |ends: &[Vec<f32>; 3]| ends.each_ref().map(|axis| axis[at]);
                    ways.push(place(&band.from), place(&band.to));
                    pixels.push((top * width + at) as u32);
                }
            }
        }
        clear.clear();
        clear.resize(ways.len(), false);
        rays.trace_shadow_rays(&ways, &mut clear);
        let light = lit.data_mut();
        for (&pixel, &clear) in pixels.iter().zip(&clear) {
            light[pixel as usize] = if clear { 1.0 } else { 0.0 };
        }
    }
    lit
}

/// Direction and reach of rays toward the sun, in f32.
#[derive(Clone, Copy)]
struct Sight {
    inverse_focal: f32,
    center: [f32; 2],
    up: [f32; 3],
    toward: [f32; 3],
    depth: f32,
    /// Meters of path toward the sun for each meter of depth.
    slant: f32,
}

impl Sight {
    fn new(daylight: &Daylight, sun: &SunLight) -> Self {
        let camera = &daylight.gaze.camera;
        Self {
            inverse_focal: (1.0 / camera.focal_px) as f32,
            center: [camera.cx as f32, camera.cy as f32],
            up: daylight.gaze.up.map(|v| v as f32),
            toward: sun.toward(&daylight.gaze).map(|v| v as f32),
            depth: daylight.depth as f32,
            slant: (1.0 / sun.rise) as f32,
        }
    }
}

/// The shadow rays of some rows, row by row.
struct Band {
    width: usize,
    from: [Vec<f32>; 3],
    to: [Vec<f32>; 3],
    /// Which pixels have one.
    counts: Vec<bool>,
}

impl Band {
    fn new(width: usize) -> Self {
        let blank = || [(); 3].map(|()| vec![0.0f32; SQUARE * width]);
        Self {
            width,
            from: blank(),
            to: blank(),
            counts: vec![false; SQUARE * width],
        }
    }

    fn fill(&mut self, row: usize, y: usize, surfaces: Surfaces<'_>, sight: &Sight) {
        let own = row * self.width..(row + 1) * self.width;
        let [fx, fy, fz] = self.from.each_mut().map(|axis| &mut axis[own.clone()]);
        let [tx, ty, tz] = self.to.each_mut().map(|axis| &mut axis[own.clone()]);
        let counts = &mut self.counts[own];
        let normals = surfaces.normals.each_ref().map(|axis| axis.row(y));
        let range = surfaces.range.row(y);
        let sight = *sight;
        vectorized!(find_ways(
            sight,
            y as f32,
            range,
            normals,
            [fx, fy, fz],
            [tx, ty, tz],
            counts
        ));
    }
}

#[inline(always)]
fn find_ways(
    of: Sight,
    y: f32,
    range: &[f32],
    [nx, ny, nz]: [&[f32]; 3],
    [fx, fy, fz]: [&mut [f32]; 3],
    [tx, ty, tz]: [&mut [f32]; 3],
    counts: &mut [bool],
) {
    let len = range.len();
    let (nx, ny, nz, counts) = (&nx[..len], &ny[..len], &nz[..len], &mut counts[..len]);
    let (fx, fy, fz) = (&mut fx[..len], &mut fy[..len], &mut fz[..len]);
    let (tx, ty, tz) = (&mut tx[..len], &mut ty[..len], &mut tz[..len]);
    let v = (y - of.center[1]) * of.inverse_focal;
    for i in 0..len {
        let (valid, z) = masked(range[i]);
        let u = (i as i32 as f32 - of.center[0]) * of.inverse_focal;
        let ahead = z / (u * u + (v * v + 1.0)).sqrt();
        let (x, y) = (u * ahead, v * ahead);
        let off = OFFSET as f32 * if z > 1.0 { z } else { 1.0 };
        let height = of.up[0] * x + of.up[1] * y + of.up[2] * ahead;
        let under = of.depth - height;
        let under = if under > 0.0 { under } else { 0.0 };
        let way = under * of.slant;
        let (x, y, ahead) = (x + off * nx[i], y + off * ny[i], ahead + off * nz[i]);
        (fx[i], fy[i], fz[i]) = (x, y, ahead);
        tx[i] = x + of.toward[0] * way;
        ty[i] = y + of.toward[1] * way;
        tz[i] = ahead + of.toward[2] * way;
        let facing = nx[i] * of.toward[0] + ny[i] * of.toward[1] + nz[i] * of.toward[2];
        counts[i] = valid & (facing > 0.0);
    }
}
