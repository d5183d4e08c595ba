//! What a field must hold.

use crate::MessageError;
use crate::limits;

type Checked = Result<(), MessageError>;

pub(crate) fn version(theirs: u32) -> Checked {
    let ours = crate::VERSION;
    if theirs == ours {
        Ok(())
    } else {
        Err(MessageError::Protocol { theirs, ours })
    }
}

/// Refuses the default, which an absent field decodes to.
pub(crate) fn present<T: Default + PartialEq>(field: &'static str, value: &T) -> Checked {
    if *value == T::default() {
        Err(MessageError::Missing { field })
    } else {
        Ok(())
    }
}

pub(crate) fn id(field: &'static str, value: &str) -> Checked {
    present(field, &value)?;
    text(field, value, limits::ID_BYTES)
}

pub(crate) fn text(field: &'static str, value: &str, limit: usize) -> Checked {
    length(field, value.len(), limit, "bytes")
}

pub(crate) fn length(field: &'static str, length: usize, limit: usize, unit: &'static str) -> Checked {
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

pub(crate) fn digest(field: &'static str, value: &str) -> Checked {
    let hex = |byte: u8| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte);
    let holds = value.len() == 64 && value.bytes().all(hex);
    value_holds(field, value, holds, "64 lower-case hex digits")
}

/// Refuses a value that does not hold what is wanted.
pub(crate) fn value_holds(
    field: &'static str,
    value: impl ToString,
    holds: bool,
    wanted: &'static str,
) -> Checked {
    if holds {
        return Ok(());
    }
    let value = value.to_string().chars().take(80).collect();
    Err(MessageError::Value { field, value, wanted })
}
