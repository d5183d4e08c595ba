pub(crate) mod dataset;
pub(crate) mod density;
pub(crate) mod histogram;
pub(crate) mod metadata;
pub(crate) mod stats;
pub(crate) mod verify;
pub(crate) mod versions;
