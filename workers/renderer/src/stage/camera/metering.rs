//! The expected exposure of a frame before it is rendered, metered on a thinned picture of its scene.

use std::collections::BTreeMap;

use ::camera::exposure::{MOST_GAIN, metered};
use ::camera::vignette::FallOff;
use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb};
use spec::{Camera, Fidelity, Frame, Metering};

use crate::context::FrameContext;
use crate::inputs::scene::Prepared;

/// Maximum pixels per side represented by one pixel of the thinned picture.
const STEP_PX: usize = 16;
/// Minimum pixels along the shorter side of the thinned picture, if the scene has as many.
const LEAST_PX: usize = 32;
/// The factor is expected to exceed that of the thinned picture by at most this share plus `SAMPLING` over the root of the pixels on
/// the smaller side of the percentile. A frame with a larger factor is planned and rendered again.
const MARGIN: f64 = 0.04;
const SAMPLING: f64 = 0.8;
/// Tolerance of the thinned picture: loose, but below the margin of dark scenes.
const TOLERANCE: f64 = 3e-3;

/// An exposure before the frame is rendered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Expected {
    /// The factor, or an upper bound if it will be metered.
    pub(crate) gain: f64,
    /// The metering; `None` if the factor is known.
    pub(crate) metering: Option<Metering>,
}

impl Expected {
    /// A known factor.
    pub(crate) fn known(gain: f64) -> Self {
        Self { gain, metering: None }
    }

    /// A factor to be metered, with this upper bound.
    pub(crate) fn metered(gain: f64, metering: &Metering) -> Self {
        Self {
            gain: gain.min(MOST_GAIN),
            metering: Some(*metering),
        }
    }
}

/// The spacing of the sampled pixels.
fn step_of((width, height): (usize, usize)) -> usize {
    (width.min(height) / LEAST_PX).clamp(1, STEP_PX)
}

/// The scene with one pixel for each square of pixels, taken from its center.
pub(crate) fn thin_scene(prepared: &Prepared) -> Prepared {
    let scene = &prepared.scene;
    let step = step_of(scene.radiance.size());
    let camera = prepared.view().camera;
    let offset = (step / 2) as f64;
    let thin = Intrinsics {
        focal_px: camera.focal_px / step as f64,
        cx: (camera.cx - offset) / step as f64,
        cy: (camera.cy - offset) / step as f64,
    };
    let planes = scene
        .radiance
        .planes()
        .each_ref()
        .map(|plane| thin_plane(plane, step));
    Prepared {
        scene: scenes::Scene {
            radiance: Rgb::new(planes).expect("planes of one size"),
            range: scene.range.as_ref().map(|range| thin_plane(range, step)),
            normals: (scene.normals.as_ref()).map(|axes| axes.each_ref().map(|axis| thin_plane(axis, step))),
            instances: scene.instances.as_ref().map(|numbers| thin_plane(numbers, step)),
            intrinsics: Some(thin),
        },
        codes: None,
        focal_px: thin.focal_px,
        hfov_deg: None,
        negative_radiance: 0,
        holes: 0,
        pose: prepared.pose,
        world: prepared.world.clone(),
        labels: None,
        classes: None,
        inputs: BTreeMap::new(),
    }
}

fn thin_plane<T: Copy>(plane: &Plane<T>, step: usize) -> Plane<T> {
    let (width, height) = plane.size();
    let middle = |i: usize, side: usize| (i * step + step / 2).min(side - 1);
    Plane::from_fn(width.div_ceil(step), height.div_ceil(step), |x, y| {
        plane.pixel(middle(x, width), middle(y, height))
    })
}

/// The frame of a thinned scene: with a pinhole and without snow, whose number of particles would not shrink with the picture.
pub(crate) fn thin_frame(frame: &Frame, (width, height): (usize, usize)) -> Frame {
    let mut thin = Frame {
        camera: Camera {
            path: frame.camera.path,
            up: frame.camera.up,
            ..Camera::pinhole(width, height, frame.camera.hfov_deg)
        },
        artifacts: Vec::new(),
        fidelity: Fidelity::Tolerance(TOLERANCE),
        ..frame.clone()
    };
    thin.water.snow = None;
    thin.water.style = None;
    thin.enhance.clear();
    thin
}

/// Upper bound on the factor, expected from the light of the thinned picture.
pub(crate) fn expect_factor(context: &FrameContext<'_>, light: &Rgb<f32>, metering: &Metering) -> f64 {
    let law = ::camera::preset::complete(&context.frame.camera).vignette;
    let falloff = context.taking.as_ref().zip(law).map(|(taking, law)| {
        let (width, height) = light.size();
        let Intrinsics { focal_px, cx, cy } = taking.parts.lens.camera;
        let scale = width as f64 / taking.parts.size.0 as f64;
        let camera = Intrinsics {
            focal_px: focal_px * scale,
            cx: cx * scale,
            cy: cy * scale,
        };
        FallOff::new(law, camera, (width, height))
    });
    let pixels = (light.width() * light.height()) as f64;
    let rarest = metering.percentile.min(1.0 - metering.percentile) * pixels;
    let margin = 1.0 + MARGIN + SAMPLING / rarest.max(1.0).sqrt();
    margin * metered(light, falloff.as_ref(), metering)
}
