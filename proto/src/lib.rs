//! The worker protocol: wire messages, plain messages, and the only conversions between them.
//!
//! Bytes become a [`wire`] type by prost, and a [`message`] type by `TryFrom`, which checks everything that the rest
//! of the program then trusts: presence, lengths, digests, numbers, the JSON of a record. [`decode`] does both. A
//! transport is the only place that names wire types.

mod check;
mod convert;
mod decode;
pub mod limits;
pub mod message;

pub use check::MessageError;
pub use decode::decode;

/// Content type of every message.
pub const CONTENT_TYPE: &str = "application/x-protobuf";

/// Version of this protocol: it grows with every change that an older worker or service would misunderstand.
pub const VERSION: u32 = 2;

/// What prost makes of `fathom/worker/v1.proto`; a test compares.
#[allow(missing_docs)]
#[rustfmt::skip]
pub mod wire;
