//! Effects that successive frames of a stream share.

use crate::context::FrameContext;
use crate::effects::Effects;

/// Successive frames of a stream with a deadline that have the same effects: one to three seconds of a camera. Choosing them for each
/// frame takes too long.
const KEPT_FRAMES: u32 = 30;

/// The effects of the last frames.
#[derive(Default)]
pub(super) struct KeptEffects {
    last: Option<(FrameShape, Effects)>,
    /// Number of frames that may still have them.
    left: u32,
}

/// What two frames with the same effects have in common, apart from their job.
#[derive(Clone, Copy, PartialEq)]
struct FrameShape {
    size: (usize, usize),
    has_range: bool,
}

impl FrameShape {
    fn measure(context: &FrameContext<'_>) -> Self {
        Self {
            size: context.setting.size,
            has_range: context.prepared.scene.range.is_some(),
        }
    }
}

impl KeptEffects {
    /// The effects of the last frames, if this one may have them, too.
    pub(super) fn reuse(&mut self, context: &FrameContext<'_>) -> Option<Effects> {
        self.left = self.left.checked_sub(1)?;
        let (shape, effects) = self.last.as_ref()?;
        (*shape == FrameShape::measure(context)).then(|| effects.clone())
    }

    pub(super) fn keep(&mut self, context: &FrameContext<'_>, effects: Effects) {
        self.last = Some((FrameShape::measure(context), effects));
        self.left = KEPT_FRAMES - 1;
    }
}
