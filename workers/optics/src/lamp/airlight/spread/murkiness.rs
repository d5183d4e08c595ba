//! How murky the water is that the rays of pixels meet, and the few degrees of it that sums are taken at.
//!
//! In patches the factor of c changes all paths of a ray, and with them its light, smoothly: a parabola through three degrees stands
//! for what is between. The factor of b multiplies the light alone.

use imaging::vectorized;

use super::super::intervals::{Murk, Rays, murk_of, rays_of};
use super::super::{Glow, RUN};
use super::Frame;
use crate::turbidity;

/// Degrees lie at most this far apart, and how many there are: four show what a parabola leaves.
const APART: f32 = 0.125;
const FEWEST: usize = 4;
const MOST: usize = 12;

/// The factors of c and b of each pixel of a frame, and how far the latter is from a mean of the ray, see [`Murk`]; none in even
/// water, where all are 1.
pub(super) struct Murkiness {
    path: Vec<f32>,
    source: Vec<f32>,
    stretch: Vec<f32>,
    most_source: f32,
    lowest: f32,
    apart: f32,
    degrees: usize,
}

impl Murkiness {
    pub(super) fn even() -> Self {
        Self {
            path: Vec::new(),
            source: Vec::new(),
            stretch: Vec::new(),
            most_source: 1.0,
            lowest: 1.0,
            apart: 0.0,
            degrees: 1,
        }
    }

    /// Of the rays of a frame to a lamp.
    pub(super) fn met(frame: &Frame<'_>) -> Self {
        let mut all = Self::even();
        if let Some(patches) = &frame.patches {
            all.look(frame, patches);
        }
        all
    }

    fn look(&mut self, frame: &Frame<'_>, patches: &turbidity::Rays) {
        let (width, height) = frame.range.size();
        let (mut least, mut most) = (f32::INFINITY, 0.0f32);
        for (x, y) in (0..height).flat_map(|y| (0..width).step_by(RUN).map(move |x| (x, y))) {
            let run = RUN.min(width - x);
            let mut range_m = [f32::INFINITY; RUN];
            range_m[..run].copy_from_slice(&frame.range.row(y)[x..x + run]);
            let mut rays = Rays::default();
            vectorized!(rays_of(frame.lens, (x, y), &range_m, &mut rays));
            let mut murk = Murk::default();
            let lamp: &Glow = frame.lamp;
            vectorized!(murk_of(lamp, &rays, patches, (x, y), &mut murk));
            for &path in &murk.path[..run] {
                (least, most) = (least.min(path), most.max(path));
            }
            self.path.extend_from_slice(&murk.path[..run]);
            self.source.extend_from_slice(&murk.source[..run]);
            self.stretch.extend_from_slice(&murk.stretch[..run]);
        }
        self.degrees = (((most - least) / APART).ceil() as usize + 1).clamp(FEWEST, MOST);
        self.most_source = self.source.iter().copied().fold(0.0, f32::max);
        self.lowest = least;
        self.apart = ((most - least) / (self.degrees - 1) as f32).max(1e-6);
    }

    /// The factors of c that sums are taken at.
    pub(super) fn degrees(&self) -> impl ExactSizeIterator<Item = f32> {
        let (lowest, apart) = (self.lowest, self.apart);
        (0..self.degrees).map(move |degree| (degree as f32).mul_add(apart, lowest))
    }

    /// The factors of a run of pixels, by their places in the frame.
    pub(super) fn of(&self, pixels: impl Iterator<Item = usize>) -> Murk {
        let mut murk = Murk::default();
        if !self.path.is_empty() {
            for (i, at) in pixels.enumerate() {
                (murk.path[i], murk.source[i]) = (self.path[at], self.source[at]);
                murk.stretch[i] = self.stretch[at];
            }
        }
        murk
    }

    /// The greatest factor of b of a frame.
    pub(super) fn most_source(&self) -> f32 {
        self.most_source
    }

    /// The factor of b of a pixel, the first of the degrees about its factor of c, and their weights in a parabola through them.
    pub(super) fn weights(&self, pixel: usize) -> (f32, usize, [f32; 3]) {
        if self.degrees == 1 {
            return (1.0, 0, [1.0, 0.0, 0.0]);
        }
        let place = (self.path[pixel] - self.lowest) / self.apart;
        let middle = ((place + 0.5) as usize).clamp(1, self.degrees - 2);
        let t = place - middle as f32;
        let weights = [0.5 * t * (t - 1.0), 1.0 - t * t, 0.5 * t * (t + 1.0)];
        (self.source[pixel], middle - 1, weights)
    }
}
