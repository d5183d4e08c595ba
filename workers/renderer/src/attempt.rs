//! One attempt at a frame: converts panics and cancellations into errors.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use imaging::cancel::Cancelled;
use spec::Frame;

use crate::content::Contents;
use crate::error::RenderError;
use crate::slot::{Rendered, Slot};
use crate::source::SceneSource;

impl Slot {
    /// Renders a frame. A panic resets the caches, which may be inconsistent.
    ///
    /// # Errors
    /// As [`Slot::render`], [`RenderError::Panic`], and [`RenderError::Cancelled`] within [`imaging::cancel::watched`].
    pub fn attempt(&mut self, frame: &Frame, source: &SceneSource) -> Result<Rendered, RenderError> {
        self.guard(frame, |slot| slot.render(frame, source))
    }

    /// The same without encoding the artifacts.
    ///
    /// # Errors
    /// As [`Slot::attempt`].
    pub fn attempt_contents(&mut self, frame: &Frame, source: &SceneSource) -> Result<Contents, RenderError> {
        self.guard(frame, |slot| slot.contents(frame, source))
    }

    /// Converts a panic into an error and resets the caches.
    pub(crate) fn guard<T>(
        &mut self,
        frame: &Frame,
        render: impl FnOnce(&mut Self) -> Result<T, RenderError>,
    ) -> Result<T, RenderError> {
        let guarded = || {
            let _ = faults::frame_point("frame", frame.index);
            render(self)
        };
        catch_unwind(AssertUnwindSafe(guarded)).unwrap_or_else(|panic| {
            *self = Self::new(&self.networks.engine);
            Err(failure(&*panic))
        })
    }
}

fn failure(panic: &(dyn Any + Send)) -> RenderError {
    if panic.is::<Cancelled>() {
        return RenderError::Cancelled;
    }
    RenderError::Panic(message(panic))
}

fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(ToString::to_string);
    text.or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "no message".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_tells_its_message_and_may_be_tried_again() {
        let caught =
            |panic: Box<dyn FnOnce() + std::panic::UnwindSafe>| message(&*catch_unwind(panic).unwrap_err());
        assert_eq!(caught(Box::new(|| panic!("plain"))), "plain");
        let index = 7;
        assert_eq!(caught(Box::new(move || panic!("row {index}"))), "row 7");
        assert_eq!(caught(Box::new(|| std::panic::panic_any(1u8))), "no message");
        assert!(RenderError::Panic("plain".to_owned()).retryable());
    }
}
