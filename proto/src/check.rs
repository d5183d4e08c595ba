//! What the fields of a message must hold, and the error of one that does not.

use crate::limits;

/// A message that arrived whole but does not make sense.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MessageError {
    /// The bytes end inside of a field.
    #[error("the message is cut off or no message of this protocol")]
    Cut,
    /// A field has another type than the protocol says.
    #[error("the message is not of this protocol: {0}")]
    Wire(String),
    /// The sender must set this field.
    #[error("`{field}` is missing")]
    Missing {
        /// Name in the protocol.
        field: &'static str,
    },
    /// Longer than anything sensible.
    #[error("`{field}` has {length} {unit}, the limit is {limit}")]
    TooLong {
        /// Name in the protocol.
        field: &'static str,
        /// What arrived.
        length: usize,
        /// What is accepted.
        limit: usize,
        /// What is counted.
        unit: &'static str,
    },
    /// A value outside its range.
    #[error("`{field}` is {value}, it must be {wanted}")]
    Value {
        /// Name in the protocol.
        field: &'static str,
        /// What arrived, shortened.
        value: String,
        /// What is accepted.
        wanted: &'static str,
    },
    /// The two sides are of different versions.
    #[error(
        "the other side speaks version {theirs} of the worker protocol and this one version {ours}: use the same \
         version of fathom for service and workers"
    )]
    Protocol {
        /// What arrived; 0: a version before it was said.
        theirs: u32,
        /// What is accepted.
        ours: u32,
    },
    /// The record is not the JSON of a frame record.
    #[error("`record_json` is no frame record: {0}")]
    Record(String),
}

type Checked<T> = Result<T, MessageError>;

pub(crate) fn version(theirs: u32) -> Checked<()> {
    let ours = crate::VERSION;
    if theirs == ours {
        Ok(())
    } else {
        Err(MessageError::Protocol { theirs, ours })
    }
}

/// A number that names something: 0 is what an absent field decodes to.
pub(crate) fn number<T: Default + PartialEq>(field: &'static str, value: T) -> Checked<T> {
    if value == T::default() {
        Err(MessageError::Missing { field })
    } else {
        Ok(value)
    }
}

pub(crate) fn id(field: &'static str, value: String) -> Checked<String> {
    text(field, number(field, value)?, limits::ID_BYTES)
}

pub(crate) fn text(field: &'static str, value: String, limit: usize) -> Checked<String> {
    length(field, value.len(), limit, "bytes")?;
    Ok(value)
}

pub(crate) fn length(field: &'static str, length: usize, limit: usize, unit: &'static str) -> Checked<()> {
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

pub(crate) fn digest(field: &'static str, value: String) -> Checked<String> {
    let hex = |byte: u8| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte);
    if value.len() == 64 && value.bytes().all(hex) {
        return Ok(value);
    }
    Err(wrong(field, &value, "64 lower-case hex digits"))
}

pub(crate) fn finite(field: &'static str, value: f64) -> Checked<f64> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(wrong(field, &value, "a finite number"))
    }
}

pub(crate) fn not_negative(field: &'static str, value: f64) -> Checked<f64> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(wrong(field, &value, "0 or more"))
    }
}

pub(crate) fn positive(field: &'static str, value: f64) -> Checked<f64> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(wrong(field, &value, "above 0"))
    }
}

pub(crate) fn wrong(field: &'static str, value: &impl ToString, wanted: &'static str) -> MessageError {
    let value = value.to_string();
    MessageError::Value {
        field,
        value: value.chars().take(80).collect(),
        wanted,
    }
}
