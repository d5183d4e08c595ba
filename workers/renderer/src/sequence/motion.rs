//! The motion of a picture's points to another picture of the same world.
//!
//! A pixel shows the point at its range along its ray. The point is visible in the other picture if it is inside the picture and
//! a ray from the other camera meets no surface before it. The ray ends [`OCCLUSION_TOLERANCE`] of its length in front of the
//! point, so surfaces that are closer to it do not occlude it.
//!
//! With a lens, a pixel has the range of the nearest sample of the rendered scene, at most half a sample from its ray. The motion
//! uses this range along the exact ray, and the occlusion test the exact point of the sample.

use std::sync::Arc;

use ::camera::geometry::Sampling;
use imaging::geometry::Intrinsics;
use imaging::rays::{Rays, ShadowRays};
use imaging::{Plane, Rgb, cancel};
use optics::range::is_hole;
use scenes::World;
use spec::ArtifactKind;

use super::viewpoint::Viewpoint;
use crate::context::FrameContext;
use crate::error::RenderError;
use crate::inputs::scene::Place;
use crate::stopwatch::Stopwatch;

/// Share of the distance of a point within which surfaces do not occlude it. Rays and ranges in single precision differ by 1e-6,
/// which grazing angles of 0.1° magnify to 6e-4.
const OCCLUSION_TOLERANCE: f64 = 1e-3;
/// Pixels whose rays are tested together, and between two checks for cancellation.
const TESTED_TOGETHER: usize = 1024;

/// The motions of a frame: x and y in px, and visibility. The first two are NaN without a range and where the other camera has no
/// projection of the point.
#[derive(Default)]
pub(crate) struct Motions {
    /// To the next frame of the path.
    pub(crate) flow: Option<Rgb<f32>>,
    /// Position in this picture minus that in the picture of the right camera.
    pub(crate) disparity: Option<Rgb<f32>>,
}

/// Finds the requested motions of a frame. Empty with a rolling shutter, because its rows have several poses.
pub(crate) fn find_motions(
    context: &FrameContext<'_>,
    watch: &mut Stopwatch,
) -> Result<Motions, RenderError> {
    let artifacts = &context.frame.artifacts;
    let needs_flow = artifacts.contains(&ArtifactKind::Flow);
    let needs_disparity = artifacts.contains(&ArtifactKind::Disparity);
    let has_one_pose = ::camera::preset::complete(&context.frame.camera)
        .readout_s
        .is_none_or(|readout_s| readout_s == 0.0);
    if !(needs_flow || needs_disparity) || !has_one_pose {
        return Ok(Motions::default());
    }
    let flow = watch.time_if(needs_flow, "flow", || {
        needs_flow.then(|| find_flow(context)).transpose()
    })?;
    let disparity = watch.time_if(needs_disparity, "disparity", || {
        needs_disparity.then(|| find_disparity(context)).flatten()
    });
    Ok(Motions {
        flow: flow.flatten(),
        disparity,
    })
}

fn find_flow(context: &FrameContext<'_>) -> Result<Option<Rgb<f32>>, RenderError> {
    let frame = context.frame;
    let Some(next) = frame.next().map_err(RenderError::Resolve)? else {
        return Ok(None);
    };
    let Some(own) = Viewpoint::new(context) else {
        return Ok(None);
    };
    // The height of piles depends on the depth.
    let is_same_world = next.water.depth_m == frame.water.depth_m;
    let place = match &context.prepared.world {
        Some(world) if is_same_world => Place::with_world(&next, Arc::clone(world))?,
        _ => Place::read(&next)?,
    };
    let pose = place.pose_at(&next, 0.0)?;
    let other = own.of_sibling(&frame.camera, &next, pose)?;
    Ok(find_motion_in(context, &own, &other, &place.world))
}

fn find_disparity(context: &FrameContext<'_>) -> Option<Rgb<f32>> {
    let baseline_m = context.frame.camera.stereo?.baseline_m;
    let left = Viewpoint::new(context)?;
    let mut right = left;
    right.pose = left.pose.moved_right(baseline_m);
    let world = context.prepared.world.as_deref()?;
    let mut motion = find_motion_in(context, &left, &right, world)?;
    let [x, y, _] = motion.planes_mut();
    x.iter_mut().chain(y).for_each(|v| *v = -*v);
    Some(motion)
}

fn find_motion_in(
    context: &FrameContext<'_>,
    from: &Viewpoint,
    to: &Viewpoint,
    world: &World,
) -> Option<Rgb<f32>> {
    find_motion(context.range()?, &PixelRays::new(context), [from, to], world)
}

/// The motion from a picture of this range to another one.
fn find_motion(
    range: &Plane<f32>,
    pixels: &PixelRays,
    way: [&Viewpoint; 2],
    world: &World,
) -> Option<Rgb<f32>> {
    let (width, height) = range.size();
    let mut planes = [f32::NAN, f32::NAN, 0.0].map(|value| Plane::filled(width, height, value));
    let all = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    find_motion_of(all, (range, pixels), way, world, |[x, y], moved| {
        for (plane, value) in planes.iter_mut().zip(moved) {
            plane.row_mut(y)[x] = value;
        }
    });
    Rgb::new(planes).ok()
}

/// Finds the motion of some pixels to another picture: `put` receives each pixel that has one, with x and y in px and 1 if it is
/// visible there, else 0.
pub(super) fn find_motion_of(
    pixels: impl Iterator<Item = [usize; 2]>,
    (range, rays_of): (&Plane<f32>, &PixelRays),
    [from, to]: [&Viewpoint; 2],
    world: &World,
    mut put: impl FnMut([usize; 2], [f32; 3]),
) {
    let (way, solids) = (from.relative_to(to), world.rays(&to.pose));
    let mut pixels = pixels.peekable();
    let (mut rays, mut tested, mut clear) = (ShadowRays::default(), Vec::new(), Vec::new());
    while pixels.peek().is_some() {
        cancel::check();
        rays.clear();
        tested.clear();
        for [x, y] in pixels.by_ref().take(TESTED_TOGETHER) {
            let meters = range.pixel(x, y);
            if is_hole(meters) {
                continue;
            }
            let [own, sample] = rays_of
                .points([x, y], f64::from(meters))
                .map(|point| way.apply(point));
            let Some([column, row]) = to.project(own) else {
                continue;
            };
            let moved = [(column - x as f64) as f32, (row - y as f64) as f32];
            if to.contains([column, row]) && length(sample) < World::FAR_M {
                tested.push(([x, y], moved));
                rays.push([0.0; 3], sample.map(|v| (v * (1.0 - OCCLUSION_TOLERANCE)) as f32));
            } else {
                put([x, y], [moved[0], moved[1], 0.0]);
            }
        }
        clear.resize(tested.len(), false);
        solids.trace_shadow_rays(&rays, &mut clear);
        for (&(pixel, [across, down]), &is_clear) in tested.iter().zip(&clear) {
            put(pixel, [across, down, f32::from(u8::from(is_clear))]);
        }
    }
}

/// The rays of the pixels of a picture.
pub(super) struct PixelRays {
    camera: Intrinsics,
    sampling: Option<Arc<Sampling>>,
}

impl PixelRays {
    pub(super) fn new(context: &FrameContext<'_>) -> Self {
        let taking = context.taking.as_ref();
        Self {
            camera: context.prepared.view().camera,
            sampling: taking.and_then(|taking| taking.sampling.clone()),
        }
    }

    /// The point at this range along the ray of a pixel, and the surface point whose range it is, in camera axes.
    fn points(&self, [x, y]: [usize; 2], meters: f64) -> [[f64; 3]; 2] {
        match &self.sampling {
            None => [self.point([x as f64, y as f64], meters); 2],
            Some(sampling) => {
                [sampling.position(x, y), sampling.nearest(x, y)].map(|place| self.point(place, meters))
            }
        }
    }

    fn point(&self, [x, y]: [f64; 2], meters: f64) -> [f64; 3] {
        let ray = self.camera.ray(x, y);
        (ray * (meters / ray.length())).into()
    }
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}
