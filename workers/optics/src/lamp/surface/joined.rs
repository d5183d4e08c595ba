//! The light of a lamp on a row of surfaces, with scattered lamp light.

use imaging::vectorized;

use super::shade::RowShade;
use super::{Row, Source, reborrow};
use crate::elementary::{HALVINGS, fade, power_0_7};
use crate::lamp::blurred::{Turned, blurred};
use crate::lamp::multiple::{MOST_LOSS, SURFACE_SCALE, WIDEST, loss_factor};
use crate::lamp::{Lamp, Lighting};
use crate::turbidity::RUN;

/// Of each channel: b in 1/m; a, the factor of κ b and the most of it in halvings per meter.
#[derive(Clone, Copy)]
pub(super) struct Joined {
    scattering: [f32; 3],
    absorption: [f32; 3],
    loss: [f32; 3],
    most_loss: [f32; 3],
}

impl Joined {
    /// `None` if multiple scattering is not modeled.
    pub(super) fn new(lighting: &Lighting) -> Option<Self> {
        let (a, b) = (lighting.absorption?, lighting.scattering);
        let halvings = |rate: f64| rate as f32 * HALVINGS;
        Some(Self {
            scattering: b.map(|b| b as f32),
            absorption: a.map(halvings),
            loss: [0, 1, 2].map(|i| halvings(loss_factor(a[i], b[i]))),
            most_loss: b.map(|b| halvings(MOST_LOSS * b)),
        })
    }
}

const SCALE: [f32; 3] = [
    SURFACE_SCALE[0] as f32,
    SURFACE_SCALE[1] as f32,
    SURFACE_SCALE[2] as f32,
];
const FARTHEST: f32 = WIDEST as f32;

/// The blurred profile of a spot on the surfaces of a row. In a separate loop: together with the rest of a pixel it runs out of
/// registers and is six times slower.
pub(super) struct Blur([Vec<f32>; 3]);

/// Positions of the surfaces of a run in the beam, the scale of the kernel of each channel, and the blurred profile.
struct InBeam {
    turned: Turned,
    scale: [[f32; RUN]; 3],
    blurs: [[f32; RUN]; 3],
}

impl Blur {
    /// `None` for an isotropic lamp, or if multiple scattering is not modeled.
    pub(super) fn new(lamp: &Lamp, lighting: &Lighting, width: usize) -> Option<Self> {
        lighting.absorption?;
        lamp.is_spot().then(|| Self([(); 3].map(|()| vec![0.0; width])))
    }

    /// Computes it for a row.
    pub(super) fn look(&mut self, row: Row<'_>, lamp: Source, water: Joined, murk: &[f32]) {
        let mut run = InBeam {
            turned: Turned::new(),
            scale: [[0.0; RUN]; 3],
            blurs: [[0.0; RUN]; 3],
        };
        for start in (0..murk.len()).step_by(RUN) {
            let count = RUN.min(murk.len() - start);
            vectorized!(in_beam(row, lamp, water, (murk, start, count), &mut run));
            blurred(&lamp.profile, &run.turned, &run.scale, &mut run.blurs);
            for (lane, blur) in self.0.iter_mut().zip(&run.blurs) {
                lane[start..start + count].copy_from_slice(&blur[..count]);
            }
        }
    }

    /// The lanes of the latest row.
    pub(super) fn lanes(&self) -> [&[f32]; 3] {
        self.0.each_ref().map(Vec::as_slice)
    }
}

#[inline(always)]
fn in_beam(
    row: Row<'_>,
    lamp: Source,
    water: Joined,
    (murk, start, count): (&[f32], usize, usize),
    to: &mut InBeam,
) {
    let [x, y, z, ..] = row.places.map(|lane| &lane[start..start + count]);
    let murk = &murk[start..start + count];
    let ([px, py, pz], [ax, ay, az]) = (lamp.place, lamp.profile.axis);
    let slope = lamp.profile.slope;
    for i in 0..count.min(RUN) {
        let (lx, ly, lz) = (px - x[i], py - y[i], pz - z[i]);
        let distance = lx.mul_add(lx, ly.mul_add(ly, lz * lz)).sqrt().max(row.radius);
        let inverse = 1.0 / distance;
        // The cross product keeps the sine accurate near the axis.
        let (cx, cy, cz) = (ay * lz - az * ly, az * lx - ax * lz, ax * ly - ay * lx);
        to.turned.along[i] = slope * (-ax.mul_add(lx, ay.mul_add(ly, az * lz)) * inverse);
        to.turned.across[i] = slope * (cx.mul_add(cx, cy.mul_add(cy, cz * cz)).sqrt() * inverse);
        for channel in 0..3 {
            let x = (water.scattering[channel] * (murk[i] * distance)).min(FARTHEST);
            to.scale[channel][i] = x.mul_add(x.mul_add(SCALE[2], SCALE[1]), SCALE[0]);
        }
    }
}

/// Adds the light of a lamp to a row, of a spot with its blurred profile there.
pub(super) fn shine_unshaded(
    row: Row<'_>,
    lamp: Source,
    water: Joined,
    (murk, blur): (&[f32], Option<[&[f32]; 3]>),
    mut to: [&mut [f32]; 5],
) {
    let open = RowShade::default();
    if let Some(blur) = blur {
        let around = (murk, open, blur);
        vectorized!(shine::<true, false>(row, lamp, water, around, reborrow(&mut to)));
    } else {
        let around = (murk, open, [&[][..]; 3]);
        vectorized!(shine::<false, false>(row, lamp, water, around, reborrow(&mut to)));
    }
}

/// Adds the visible light of a lamp to a row.
pub(super) fn shine_shaded(
    row: Row<'_>,
    lamp: Source,
    water: Joined,
    (murk, shade, blur): (&[f32], RowShade<'_>, Option<[&[f32]; 3]>),
    mut to: [&mut [f32]; 5],
) {
    if let Some(blur) = blur {
        let around = (murk, shade, blur);
        vectorized!(shine::<true, true>(row, lamp, water, around, reborrow(&mut to)));
    } else {
        let around = (murk, shade, [&[][..]; 3]);
        vectorized!(shine::<false, true>(row, lamp, water, around, reborrow(&mut to)));
    }
}

/// Adds the light of a lamp, a spot or not, to a row, if `SHADED` times its visible share.
#[inline(always)]
fn shine<const SPOT: bool, const SHADED: bool>(
    row: Row<'_>,
    lamp: Source,
    water: Joined,
    (murk, shade, blur): (&[f32], RowShade<'_>, [&[f32]; 3]),
    [red, green, blue, near, seen]: [&mut [f32]; 5],
) {
    let width = red.len();
    let [x, y, z, range, shown] = row.places.map(|lane| &lane[..width]);
    let [nx, ny, nz] = row.normals.map(|lane| &lane[..width]);
    let murk = &murk[..width];
    let blur = blur.map(|lane| if SPOT { &lane[..width] } else { lane });
    let lit = if SHADED { &shade.direct[..width] } else { &[] };
    let spread = shade
        .spread
        .map(|lane| if SHADED { &lane[..width] } else { lane });
    let (near, seen) = (&mut near[..width], &mut seen[..width]);
    let (green, blue) = (&mut green[..width], &mut blue[..width]);
    let ([px, py, pz], [ir, ig, ib]) = (lamp.place, lamp.intensity);
    let ([ax, ay, az], slope, offset) = (lamp.profile.axis, lamp.profile.slope, lamp.profile.offset);
    for i in 0..width {
        let (lx, ly, lz) = (px - x[i], py - y[i], pz - z[i]);
        let distance = lx.mul_add(lx, ly.mul_add(ly, lz * lz)).sqrt().max(row.radius);
        let inverse = 1.0 / distance;
        let facing = nx[i].mul_add(lx, ny[i].mul_add(ly, nz[i] * lz)).max(0.0);
        let fall = facing * shown[i] * (inverse * inverse * inverse);
        let meters = murk[i] * distance;
        let power = power_0_7(meters);
        let mut profile = 1.0;
        if SPOT {
            let cos = -ax.mul_add(lx, ay.mul_add(ly, az * lz)) * inverse;
            profile = slope.mul_add(cos, offset).max(0.0).min(1.0);
        }
        let mut arriving = [0.0; 3];
        for channel in 0..3 {
            let direct = fade(row.attenuation[channel], meters);
            let lost = (water.loss[channel] * power).min(water.most_loss[channel]);
            let joined = (fade(water.absorption[channel] + lost, meters) - direct).max(0.0);
            let blur = if SPOT { blur[channel][i] } else { 1.0 };
            arriving[channel] = if SHADED {
                blur.mul_add(joined * spread[channel][i], profile * direct * lit[i])
            } else {
                blur.mul_add(joined, profile * direct)
            };
        }
        (near[i], seen[i]) = (shown[i] * inverse, shown[i] * range[i] * inverse);
        red[i] = (ir * fall).mul_add(arriving[0], red[i]);
        green[i] = (ig * fall).mul_add(arriving[1], green[i]);
        blue[i] = (ib * fall).mul_add(arriving[2], blue[i]);
    }
}
