//! Where the rays of all pixels end, as a share of w at the camera that is behind them.

use std::f32::consts::FRAC_PI_2;

use imaging::simd::{larger, smaller};
use imaging::vectorized;

use super::super::intervals::{Beside, Rays, beside, extreme, rays_of};
use super::super::{Glow, Lanes, RUN};
use super::beside::opening;
use super::{Frame, STEP, nodes};
use crate::elementary::angle;
use crate::lamp::patches::BESIDE;

/// Marks a separately integrated pixel.
pub(super) const BY_ITSELF: f32 = -1.0;

/// The ends of all rays of a frame.
pub(super) struct Ends<'a> {
    /// 0 at the camera, 1 at infinity; negative for separately integrated pixels.
    pub(super) places: &'a [f32],
    /// Of each run of columns, band by band.
    extremes: Vec<Extremes>,
    /// The least and the greatest place.
    first: f32,
    last: f32,
}

/// Lane by lane of some rows: the most w at the camera, the least and the most w of an end, the least distances of the lamp from a
/// ray and from its end.
struct Extremes {
    start: Lanes,
    least: Lanes,
    most: Lanes,
    near: Lanes,
    end: Lanes,
}

impl<'a> Ends<'a> {
    /// Writes into `room`. If rays are `alone`, a ray that ends before the main part of the airlight is integrated separately.
    pub(super) fn new(frame: &Frame<'_>, alone: bool, room: &'a mut Vec<f32>) -> Self {
        let (width, height) = frame.range.size();
        let runs = width.div_ceil(RUN);
        room.resize(width * height, 0.0);
        let mut ends = Self {
            places: &[],
            extremes: (0..runs * height.div_ceil(STEP))
                .map(|_| Extremes::none())
                .collect(),
            first: 1.0,
            last: 0.0,
        };
        let (mut nearest, mut farthest) = ([1.0f32; RUN], [0.0f32; RUN]);
        for (y, x) in (0..height).flat_map(|y| (0..width).step_by(RUN).map(move |x| (y, x))) {
            let run = RUN.min(width - x);
            let first = y * width + x;
            let mut range_m = [f32::INFINITY; RUN];
            range_m[..run].copy_from_slice(&frame.range.data()[first..first + run]);
            let mut rays = Rays::default();
            let mut places = [0.0f32; RUN];
            let extremes = &mut ends.extremes[y / STEP * runs + x / RUN];
            vectorized!({
                rays_of(frame.lens, (x, y), &range_m, &mut rays);
                extremes.include(frame.lamp, &rays, alone, &mut places);
            });
            for i in 0..run {
                let place = larger(places[i], 0.0);
                nearest[i] = smaller(place, nearest[i]);
                farthest[i] = larger(place, farthest[i]);
            }
            room[first..first + run].copy_from_slice(&places[..run]);
        }
        ends.places = room;
        (ends.first, ends.last) = (extreme(&nearest, smaller), extreme(&farthest, larger));
        ends
    }

    /// First and last end cell of rays, with `cells` cells.
    pub(super) fn cells(&self, cells: usize) -> (usize, usize) {
        let cell = |place: f32| ((place * cells as f32) as usize).min(cells - 1);
        (cell(self.first), cell(self.last))
    }

    /// Bounds that hold for all rays of a run of columns, in water of this turbidity.
    pub(super) fn span(&self, run: usize, murk: &nodes::Span) -> nodes::Span {
        let of = &self.extremes[run];
        let beta = |w: f32| angle(1.0 - w, w).min(FRAC_PI_2);
        nodes::Span {
            from: beta(extreme(&of.start, larger)),
            to: beta(extreme(&of.least, smaller)),
            least_to: beta(extreme(&of.most, larger)),
            nearest_m: extreme(&of.near, smaller),
            end_m: extreme(&of.end, smaller),
            ..*murk
        }
    }
}

impl Extremes {
    fn none() -> Self {
        let [greatest, least] = [[0.0; RUN], [f32::INFINITY; RUN]];
        Self {
            start: greatest,
            least,
            most: greatest,
            near: least,
            end: least,
        }
    }

    #[inline(always)]
    fn include(&mut self, lamp: &Glow, rays: &Rays, alone: bool, places: &mut Lanes) {
        let by_itself = if alone { 1.0 } else { 0.0 };
        for i in 0..RUN {
            let Beside {
                nearest, distance, ..
            } = beside(lamp, rays, i);
            let behind = rays.end[i] - nearest;
            let (start, end) = (opening(distance, -nearest), opening(distance, behind));
            let place = larger(1.0 - end / start, 0.0);
            let is_near = rays.end[i] < by_itself * larger(nearest, BESIDE as f32 * distance);
            places[i] = if is_near { BY_ITSELF } else { place };
            self.start[i] = larger(start, self.start[i]);
            self.least[i] = smaller(end, self.least[i]);
            self.most[i] = larger(end, self.most[i]);
            self.near[i] = smaller(distance, self.near[i]);
            let to_end = behind.mul_add(behind, distance * distance).sqrt();
            self.end[i] = smaller(to_end, self.end[i]);
        }
    }
}
