//! `state.json`: whether a set is to be worked on.

use serde::{Deserialize, Serialize};

use crate::error::SetError;
use crate::layout;

/// Whether a set is to be worked on. Without a `state.json` it is running.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// Shards are rendered.
    Running,
    /// Shards that were begun are finished, and no others are begun.
    Paused,
    /// Nothing is rendered any more.
    Cancelled,
}

#[derive(Serialize, Deserialize)]
struct Document {
    state: State,
}

impl State {
    pub(crate) fn read(text: Option<&[u8]>) -> Result<Self, SetError> {
        let Some(text) = text else {
            return Ok(Self::Running);
        };
        let document: Document =
            serde_json::from_slice(text).map_err(|error| SetError::unreadable(layout::STATE, error))?;
        Ok(document.state)
    }

    pub(crate) fn document(self) -> Result<Vec<u8>, SetError> {
        serde_json::to_vec(&Document { state: self })
            .map_err(|error| SetError::Machine(format!("{} cannot be written: {error}", layout::STATE)))
    }

    /// Refuses to begin a shard in this state.
    ///
    /// # Errors
    /// [`SetError::Later`] of a paused set, [`SetError::Refused`] of a cancelled one.
    pub fn allow(self) -> Result<(), SetError> {
        match self {
            Self::Running => Ok(()),
            Self::Paused => Err(SetError::Later(
                "the set is paused; run again when it is running".to_owned(),
            )),
            Self::Cancelled => Err(SetError::Refused("the set is cancelled".to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_running_set_is_worked_on() {
        let allowed = |text: &[u8]| State::read(Some(text)).and_then(State::allow);
        assert!(State::read(None).and_then(State::allow).is_ok());
        assert!(allowed(br#"{"state": "running"}"#).is_ok());
        assert!(matches!(
            allowed(br#"{"state": "paused"}"#),
            Err(SetError::Later(_))
        ));
        assert!(matches!(
            allowed(br#"{"state": "cancelled"}"#),
            Err(SetError::Refused(_))
        ));
        assert!(matches!(
            allowed(br#"{"state": "gone"}"#),
            Err(SetError::Damaged(_))
        ));
    }
}
