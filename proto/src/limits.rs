//! Limits on the parts of a message.

/// Fields of a message, repeated ones counted each time: a beat with all its tokens has half as many.
pub const MESSAGE_FIELDS: usize = 8192;
/// Ids are a prefix and a UUID: 40 characters.
pub const ID_BYTES: usize = 64;
/// Names of workers, versions, lists of CPU features.
pub const NAME_BYTES: usize = 256;
/// An error message; senders shorten theirs with [`shorten`].
pub const ERROR_BYTES: usize = 4096;
/// A record holds the resolved frame, the plan and the measurements: a few tens of kilobytes, and the user's labels.
pub const RECORD_BYTES: usize = 4 << 20;
/// Most frames of a lease.
pub const LEASE_FRAMES: usize = 256;
/// Most leases of a worker: four for each of 1024 slots.
pub const BEAT_TOKENS: usize = 4096;
/// Most slots of a worker.
pub const SLOTS: u32 = 1024;
/// There are fourteen fixed kinds and one for each enhancement.
pub const ARTIFACTS: usize = 64;
/// A style's card: a page of text.
pub const CARD_BYTES: usize = 64 << 10;
/// Most styles of a service.
pub const STYLES: usize = 1024;
/// Stages of a frame that can have a time.
pub const TIMINGS: usize = 64;

/// Returns the beginning of a text, at most [`ERROR_BYTES`].
#[must_use]
pub fn shorten(text: &str) -> String {
    text[..text.floor_char_boundary(ERROR_BYTES)].to_owned()
}
