//! Why a message is refused.

/// A message that is not of this protocol, or a field that holds what it must not.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MessageError {
    /// The bytes end inside a field.
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
    /// Longer than the limit.
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
        /// What arrived; 0: from before versions were sent.
        theirs: u32,
        /// What is accepted.
        ours: u32,
    },
    /// The record is not the JSON of a frame record.
    #[error("`record_json` is no frame record: {0}")]
    Record(String),
}
