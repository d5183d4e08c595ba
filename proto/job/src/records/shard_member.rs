//! File names inside a WebDataset tar.

/// The name of a frame's file, such as `000000000017.rgb.png` for `rgb.png`.
#[must_use]
pub fn shard_member(frame: u64, name: &str) -> String {
    format!("{frame:012}.{name}")
}
