//! Turbidity along the rays of pixels.
//!
//! In patches the factors of b and c change all paths of a ray, and with them its light. Most of the airlight comes from a stretch
//! near the lamp. If all surfaces are behind it, the factors change only from ray to ray, and each ray is integrated in its actual
//! water. If some are nearer, a parabola through the sums of three degrees of turbidity interpolates between them; the factor of b
//! multiplies only the light.

use imaging::vectorized;

use super::super::intervals::{Murk, Rays, murk_along, murk_of, rays_of};
use super::super::{Glow, Lanes, RUN};
use super::{Frame, nodes};
use crate::lamp::patches::BESIDE;
use crate::turbidity;

/// Largest spacing of degrees, and their number: four reveal the error of a parabola.
const APART: f32 = 0.125;
const FEWEST: usize = 4;
const MOST: usize = 12;
/// If at most one of this number of pixels is near the lamp, such pixels are integrated separately.
const FEW: usize = 64;

/// The water of the rays to a lamp.
pub(super) enum Murkiness {
    Even,
    /// Turbidity of each ray as if it had no end.
    Own,
    Degrees(Degrees),
}

/// The factors of c and b of each pixel of a frame, and the difference of the latter from a mean of the ray, see [`Murk`].
pub(super) struct Degrees {
    path: Vec<f32>,
    source: Vec<f32>,
    lowest: f32,
    apart: f32,
    count: usize,
    span: nodes::Span,
}

impl Murkiness {
    /// Turbidity for the rays of a frame to a lamp.
    pub(super) fn met(frame: &Frame<'_>) -> Self {
        let Some(patches) = &frame.patches else {
            return Self::Even;
        };
        let [x, y, z] = frame.lamp.place;
        let away = (x * x + y * y + z * z).sqrt().max(frame.lamp.radius);
        let reach = BESIDE as f32 * away;
        let pixels = frame.range.data();
        let near = pixels.iter().filter(|&&z| z > 0.0 && z < reach).count();
        if near * FEW <= pixels.len() {
            Self::Own
        } else {
            Self::Degrees(Degrees::look(frame, patches))
        }
    }

    /// Number of degrees of turbidity for each ray.
    pub(super) fn degrees(&self) -> usize {
        match self {
            Self::Even | Self::Own => 1,
            Self::Degrees(degrees) => degrees.count,
        }
    }

    /// The greatest factor of b that sums are multiplied with.
    pub(super) fn most_source(&self) -> f32 {
        match self {
            Self::Even | Self::Own => 1.0,
            Self::Degrees(degrees) => degrees.span.source,
        }
    }

    /// Bounds for all pixels, if known.
    pub(super) fn span(&self) -> Option<nodes::Span> {
        match self {
            Self::Even | Self::Own => None,
            Self::Degrees(degrees) => Some(degrees.span),
        }
    }
}

impl Frame<'_> {
    /// The water of infinite rays for a degree of turbidity.
    pub(super) fn murk_of(&self, degree: usize, rays: &Rays) -> Murk {
        match &self.murkiness {
            Murkiness::Even => Murk::default(),
            Murkiness::Own => self.murk_along(rays),
            Murkiness::Degrees(degrees) => Murk {
                path: [(degree as f32).mul_add(degrees.apart, degrees.lowest); RUN],
                ..Murk::default()
            },
        }
    }

    /// The water along rays up to their ends.
    pub(super) fn murk_along(&self, rays: &Rays) -> Murk {
        let (mut murk, lamp) = (Murk::default(), self.lamp);
        if let Some(patches) = &self.patches {
            vectorized!(murk_along(lamp, rays, patches, &mut murk));
        }
        murk
    }
}

impl Degrees {
    fn look(frame: &Frame<'_>, patches: &turbidity::Rays) -> Self {
        let (width, height) = frame.range.size();
        let mut all = Self {
            path: Vec::with_capacity(width * height),
            source: Vec::with_capacity(width * height),
            lowest: 1.0,
            apart: 0.0,
            count: 1,
            span: nodes::Span::dark(),
        };
        for (x, y) in (0..height).flat_map(|y| (0..width).step_by(RUN).map(move |x| (x, y))) {
            let run = RUN.min(width - x);
            let mut range_m = [f32::INFINITY; RUN];
            range_m[..run].copy_from_slice(&frame.range.row(y)[x..x + run]);
            let mut rays = Rays::default();
            let mut murk = Murk::default();
            let lamp: &Glow = frame.lamp;
            vectorized!({
                rays_of(frame.lens, (x, y), &range_m, &mut rays);
                murk_of(lamp, &rays, patches, (x, y), &mut murk);
            });
            all.span.include(&murk, run);
            all.path.extend_from_slice(&murk.path[..run]);
            all.source.extend_from_slice(&murk.source[..run]);
        }
        let (least, most) = (all.span.clearest, all.span.murkiest);
        all.count = (((most - least) / APART).ceil() as usize + 1).clamp(FEWEST, MOST);
        all.lowest = least;
        all.apart = ((most - least) / (all.count - 1) as f32).max(1e-6);
        all
    }

    /// The factor of b of a pixel, the first of the degrees about its factor of c, and their weights in a parabola through them.
    pub(super) fn weights(&self, pixel: usize) -> (f32, usize, [f32; 3]) {
        let place = (self.path[pixel] - self.lowest) / self.apart;
        let middle = ((place + 0.5) as usize).clamp(1, self.count - 2);
        let t = place - middle as f32;
        let weights = [0.5 * t * (t - 1.0), 1.0 - t * t, 0.5 * t * (t + 1.0)];
        (self.source[pixel], middle - 1, weights)
    }
}

impl nodes::Span {
    /// Empty bounds.
    pub(super) fn dark() -> Self {
        Self {
            from: 0.0,
            to: 0.0,
            least_to: 0.0,
            nearest_m: f32::INFINITY,
            end_m: f32::INFINITY,
            clearest: f32::INFINITY,
            murkiest: 0.0,
            source: 0.0,
            stretch: 0.0,
        }
    }

    /// Includes the water of the first `count` rays of a run.
    pub(super) fn include(&mut self, murk: &Murk, count: usize) {
        let least = |lanes: &Lanes, from: f32| lanes[..count].iter().copied().fold(from, f32::min);
        let most = |lanes: &Lanes, from: f32| lanes[..count].iter().copied().fold(from, f32::max);
        self.clearest = least(&murk.path, self.clearest);
        self.murkiest = most(&murk.path, self.murkiest);
        self.source = most(&murk.source, self.source);
        self.stretch = most(&murk.stretch, self.stretch);
    }

    /// Includes the bounds of another span.
    pub(super) fn join(&mut self, other: &Self) {
        self.clearest = self.clearest.min(other.clearest);
        self.murkiest = self.murkiest.max(other.murkiest);
        self.source = self.source.max(other.source);
        self.stretch = self.stretch.max(other.stretch);
    }
}
