//! The artifacts of one frame as pictures.

use cli::exit::Failure;
use cli::sheet::with_legend;
use imaging::codec::{Radiance, decode_radiance};
use imaging::{Rgb, Rgb8};
use renderer::{Rendered, SceneSource, Slot};
use spec::Job;

use super::declaration::invalid;
use crate::commands::dataset::sheet::paint::{Paint, Stored};

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

    /// The motion to the next frame.
    ///
    /// # Errors
    /// The job does not make it.
    pub(super) fn flow(&self) -> Result<Rgb<f32>, Failure> {
        match decode_radiance(self.bytes("flow")?) {
            Ok(Radiance::Linear(flow)) => Ok(flow),
            _ => Err(missing("flow")),
        }
    }

    fn stored(&self, kind: &str) -> Result<Stored, Failure> {
        Stored::read(kind, self.bytes(kind)?)
    }

    fn bytes(&self, kind: &str) -> Result<&[u8], Failure> {
        let file = self.rendered.files.iter().find(|file| file.kind == kind);
        Ok(&file.ok_or_else(|| missing(kind))?.bytes)
    }
}

fn missing(kind: &str) -> Failure {
    anyhow::anyhow!("a frame has no artifact `{kind}`").into()
}
