//! Names of the members of a tar that holds frames as WebDataset reads them.

/// The name of a file of a frame, such as `000000000017.rgb.png` of `rgb.png`.
#[must_use]
pub fn shard_member(frame: u64, name: &str) -> String {
    format!("{frame:012}.{name}")
}
