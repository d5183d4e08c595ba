//! The artifacts of one frame as pictures.

use cli::exit::Failure;
use cli::sheet::with_legend;
use imaging::{Plane, Rgb8};
use renderer::{Rendered, SceneSource, Slot};
use spec::{Job, SceneRecord};

use super::declaration::invalid;
use crate::commands::dataset::sheet::paint::{Paint, RANGE_UNIT_M, Stored};

/// A rendered frame.
pub(super) struct Shot {
    rendered: Rendered,
}

impl Shot {
    /// Renders a frame of a job.
    ///
    /// # Errors
    /// The frame cannot be rendered.
    pub(super) fn take(job: &Job, index: u64, slot: &mut Slot) -> Result<Self, Failure> {
        let frame = job.resolve(index).map_err(invalid)?;
        let rendered = slot.render(&frame, &SceneSource::Local).map_err(Failure::input)?;
        Ok(Self { rendered })
    }

    /// An artifact as a picture; a range has its scale below.
    ///
    /// # Errors
    /// The job does not make it.
    pub(super) fn picture(&self, kind: &str) -> Result<Rgb8, Failure> {
        let stored = [self.stored(kind)?];
        let paint = Paint::new(stored.iter());
        let picture = paint.picture(&stored[0]);
        let legend = paint.legend(&stored, &Default::default());
        Ok(legend.map_or_else(|| picture.clone(), |legend| with_legend(&picture, &legend)))
    }

    /// The range in meters, 0 without a return.
    ///
    /// # Errors
    /// The job does not make it.
    pub(super) fn range_m(&self) -> Result<Plane<f32>, Failure> {
        match self.stored("range")? {
            Stored::Range(codes) => Ok(codes.map(|&code| (f64::from(code) * RANGE_UNIT_M) as f32)),
            _ => Err(missing("range")),
        }
    }

    /// The camera and its pose.
    pub(super) fn scene(&self) -> Option<&SceneRecord> {
        self.rendered.record.scene.as_ref()
    }

    fn stored(&self, kind: &str) -> Result<Stored, Failure> {
        let file = self.rendered.files.iter().find(|file| file.kind == kind);
        Stored::read(kind, &file.ok_or_else(|| missing(kind))?.bytes)
    }
}

fn missing(kind: &str) -> Failure {
    anyhow::anyhow!("a frame has no artifact `{kind}`").into()
}
