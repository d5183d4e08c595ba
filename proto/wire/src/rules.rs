//! Constraints on single fields.

use crate::MessageError;
use crate::limits;

type Checked = Result<(), MessageError>;

pub(crate) fn check_version(theirs: u32) -> Checked {
    let ours = crate::VERSION;
    if theirs == ours {
        Ok(())
    } else {
        Err(MessageError::Protocol { theirs, ours })
    }
}

/// Rejects the default value, which is how an absent field decodes.
pub(crate) fn require<T: Default + PartialEq>(field: &'static str, value: &T) -> Checked {
    if *value == T::default() {
        Err(MessageError::Missing { field })
    } else {
        Ok(())
    }
}

pub(crate) fn check_id(field: &'static str, value: &str) -> Checked {
    require(field, &value)?;
    check_text(field, value, limits::ID_BYTES)
}

pub(crate) fn check_text(field: &'static str, value: &str, limit: usize) -> Checked {
    check_length(field, value.len(), limit, "bytes")
}

pub(crate) fn check_length(field: &'static str, length: usize, limit: usize, unit: &'static str) -> Checked {
    if length > limit {
        Err(MessageError::TooLong {
            field,
            length,
            limit,
            unit,
        })
    } else {
        Ok(())
    }
}

pub(crate) fn check_digest(field: &'static str, value: &str) -> Checked {
    let is_digest = value.len() == 64
        && value
            .bytes()
            .all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'));
    check_value(field, value, is_digest, "64 lower-case hex digits")
}

pub(crate) fn check_value(
    field: &'static str,
    value: impl ToString,
    is_valid: bool,
    wanted: &'static str,
) -> Checked {
    if is_valid {
        return Ok(());
    }
    let value = value.to_string().chars().take(80).collect();
    Err(MessageError::Value { field, value, wanted })
}
