//! `state.json`: whether a set is to be worked on. Without it, the set is running.

use serde::{Deserialize, Serialize};
use spec::SetState;

use crate::error::SetError;
use crate::storage::layout;

#[derive(Serialize, Deserialize)]
struct Document {
    state: SetState,
}

pub(crate) fn read(text: Option<&[u8]>) -> Result<SetState, SetError> {
    let Some(text) = text else {
        return Ok(SetState::Running);
    };
    let document: Document =
        serde_json::from_slice(text).map_err(|error| SetError::unreadable(layout::STATE, error))?;
    Ok(document.state)
}

/// The new content of a state; `None` if it does not change. A cancelled set stays cancelled.
///
/// # Errors
/// [`SetError::Refused`] for a cancelled set.
pub(crate) fn changed(text: Option<&[u8]>, wanted: SetState) -> Result<Option<Vec<u8>>, SetError> {
    match read(text)? {
        before if before == wanted => Ok(None),
        SetState::Cancelled => allow_work(SetState::Cancelled).map(|()| None),
        _ => serde_json::to_vec(&Document { state: wanted })
            .map(Some)
            .map_err(|error| SetError::Machine(format!("{} cannot be written: {error}", layout::STATE))),
    }
}

/// Refuses to begin a shard in this state.
///
/// # Errors
/// [`SetError::Later`] of a paused set, [`SetError::Refused`] of a cancelled one.
pub fn allow_work(state: SetState) -> Result<(), SetError> {
    match state {
        SetState::Running => Ok(()),
        SetState::Paused => Err(SetError::Later(
            "the set is paused; run again when it is running".to_owned(),
        )),
        SetState::Cancelled => Err(SetError::Refused("the set is cancelled".to_owned())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_running_set_is_worked_on() {
        let allowed = |text: &[u8]| read(Some(text)).and_then(allow_work);
        assert!(read(None).and_then(allow_work).is_ok());
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
