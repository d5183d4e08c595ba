/// A malformed message or an invalid field.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MessageError {
    /// The bytes end inside a field.
    #[error("the message is truncated or not of this protocol")]
    Cut,
    /// A field has the wrong wire type.
    #[error("the message is not of this protocol: {0}")]
    Wire(String),
    /// A required field is absent.
    #[error("`{field}` is missing")]
    Missing {
        /// Field name in the protocol.
        field: &'static str,
    },
    /// The field is too long.
    #[error("`{field}` has {length} {unit}; must be at most {limit}")]
    TooLong {
        /// Field name in the protocol.
        field: &'static str,
        /// Received length.
        length: usize,
        /// Maximum length.
        limit: usize,
        /// Unit of both lengths.
        unit: &'static str,
    },
    /// The value is outside its range.
    #[error("`{field}` is {value}; must be {wanted}")]
    Value {
        /// Field name in the protocol.
        field: &'static str,
        /// The received value, shortened.
        value: String,
        /// Accepted values.
        wanted: &'static str,
    },
    /// The two sides have different protocol versions.
    #[error(
        "the other side uses version {theirs} of the worker protocol and this side version {ours}; run the same \
         version of fathom for service and workers"
    )]
    Protocol {
        /// Version of the other side; 0: the sender predates version numbers.
        theirs: u32,
        /// Version of this side.
        ours: u32,
    },
    /// The record is not the JSON of a frame record.
    #[error("`record_json` is not a frame record: {0}")]
    Record(String),
}
