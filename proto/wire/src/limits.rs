/// Fields of a message, with each repeated element counted: twice what the largest heartbeat needs.
pub const MESSAGE_FIELDS: usize = 8192;
/// Ids are a prefix and a UUID: 40 characters.
pub const ID_BYTES: usize = 64;
/// Names of workers, versions, lists of CPU features.
pub const NAME_BYTES: usize = 256;
/// Senders shorten longer messages with [`shorten`].
pub const ERROR_BYTES: usize = 4096;
/// A record holds the resolved frame, the plan, the measurements and the user's labels: usually some tens of
/// kilobytes.
pub const RECORD_BYTES: usize = 4 << 20;
/// Maximum frames of a lease.
pub const LEASE_FRAMES: usize = 256;
/// Maximum leases of a worker: four for each of 1024 slots.
pub const BEAT_TOKENS: usize = 4096;
/// Maximum slots of a worker.
pub const SLOTS: u32 = 1024;
/// Fourteen fixed kinds and one for each enhancement.
pub const ARTIFACTS: usize = 64;
/// A style's card: a page of text.
pub const CARD_BYTES: usize = 64 << 10;
/// Maximum styles of a service.
pub const STYLES: usize = 1024;
/// Maximum timed stages of a frame.
pub const TIMINGS: usize = 64;

/// Returns the first [`ERROR_BYTES`] of a text, cut at a character boundary.
#[must_use]
pub fn shorten(text: &str) -> String {
    text[..text.floor_char_boundary(ERROR_BYTES)].to_owned()
}
