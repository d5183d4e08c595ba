//! Maintenance of a catalogue: backups, checks, repair, and the columnar replica.

pub(crate) mod folder;
pub(crate) mod replica;
pub(crate) mod restore;
pub(crate) mod scrub;
pub(crate) mod upkeep;
