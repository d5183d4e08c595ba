//! Records of frames and shards.

pub(crate) mod comparison;
pub(crate) mod merkle;
pub(crate) mod record;
pub(crate) mod record_text;
pub(crate) mod scene_record;
pub(crate) mod set_state;
pub(crate) mod shard_member;
