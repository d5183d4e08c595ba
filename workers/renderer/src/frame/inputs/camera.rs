//! The camera of a frame, resolved for its scene.

use std::sync::Arc;

use ::camera::geometry::{Lens, Sampling, SourcePicture, coordinates};
use ::camera::sensor::{FixedPattern, SensorModel};
use ::camera::{Parts, Scenery};
use spec::Frame;

use super::movement::{Moment, moments};
use super::scene::Prepared;
use super::seen::Seen;
use crate::error::RenderError;

/// Maximum pixels of a cached map: 50 MB for three channels.
const MOST_KEPT: usize = 1 << 20;

/// Per-slot cache of cameras. Most frames of a job share one.
#[derive(Default)]
pub(crate) struct Cameras {
    map: Option<(Lens, SourcePicture, Arc<Sampling>)>,
    pattern: Option<FixedPattern>,
}

impl Cameras {
    /// The map of a lens into its source picture.
    fn sampling(&mut self, lens: &Lens, source: &SourcePicture, size: (usize, usize)) -> Arc<Sampling> {
        if let Some((of, from, sampling)) = &self.map
            && (of, from, sampling.size()) == (lens, source, size)
        {
            return Arc::clone(sampling);
        }
        let sampling = Arc::new(Sampling::new(&coordinates(lens, source, size), source.size));
        if size.0 * size.1 <= MOST_KEPT {
            self.map = Some((*lens, *source, Arc::clone(&sampling)));
        }
        sampling
    }

    /// The fixed pattern of a sensor.
    pub(crate) fn pattern(&mut self, sensor: &SensorModel, seed: u64, samples: usize) -> &FixedPattern {
        let kept = self
            .pattern
            .take()
            .filter(|pattern| pattern.is_of(sensor, seed, samples));
        self.pattern
            .insert(kept.unwrap_or_else(|| FixedPattern::new(sensor, seed, samples)))
    }
}

/// The camera of a frame, resolved for its scene.
pub(crate) struct Taking {
    pub(crate) parts: Parts,
    /// The map into the picture of the scene; `None` if no pixel moves.
    pub(crate) sampling: Option<Arc<Sampling>>,
    /// The labels of the picture; `None` if they are those of the scene.
    pub(crate) seen: Option<Seen>,
    /// Exposure times of the rows; one moment without movement.
    pub(crate) moments: Vec<Moment>,
    /// Path length of an uploaded picture's movement in px; `None` without.
    pub(crate) shift_px: Option<[f64; 2]>,
    /// The largest circle of confusion, px.
    pub(crate) most_blur_px: f64,
}

/// The camera parts for rendering a scene; `None` for a pinhole and for an uploaded picture.
pub(crate) fn rendered_parts(frame: &Frame) -> Result<Option<Parts>, RenderError> {
    let is_rendered = matches!(frame.scene, spec::Scene::Procedural { .. });
    if frame.camera.is_pinhole() || !is_rendered {
        return Ok(None);
    }
    Ok(Some(Parts::resolve(&frame.camera, Scenery::Rendered)?))
}

/// The parts of a frame's camera in front of its scene; `None` for a pinhole.
fn parts(frame: &Frame, prepared: &Prepared) -> Result<Option<Parts>, RenderError> {
    if frame.camera.is_pinhole() {
        return Ok(None);
    }
    if let Some(parts) = rendered_parts(frame)? {
        return Ok(Some(parts));
    }
    let view = prepared.view();
    let scenery = Scenery::Picture(view.camera, view.size);
    Ok(Some(Parts::resolve(&frame.camera, scenery)?))
}

/// A camera in front of its scene; `None` for a pinhole.
pub(crate) fn taking(
    frame: &Frame,
    prepared: &Prepared,
    cameras: &mut Cameras,
) -> Result<Option<Taking>, RenderError> {
    let Some(parts) = parts(frame, prepared)? else {
        return Ok(None);
    };
    let source = parts.source.as_ref();
    let sampling = source.map(|source| cameras.sampling(&parts.lens, source, parts.size));
    let shift_px = match (&frame.scene, frame.camera.motion) {
        (spec::Scene::Procedural { .. }, _) | (_, None) => None,
        (_, Some(motion)) => Some([motion.x_px, motion.y_px]),
    };
    let seen = sampling
        .as_ref()
        .map(|sampling| Seen::new(prepared, Some(sampling)));
    Ok(Some(Taking {
        moments: moments(frame, parts.size.1),
        most_blur_px: find_most_blur(&parts, prepared),
        parts,
        sampling,
        seen,
        shift_px,
    }))
}

fn find_most_blur(parts: &Parts, prepared: &Prepared) -> f64 {
    let (Some(focus), Some(range)) = (parts.focus, &prepared.scene.range) else {
        return 0.0;
    };
    let radii = range.data().iter().map(|&z| focus.radius_px(f64::from(z)));
    radii.fold(0.0, f64::max)
}
