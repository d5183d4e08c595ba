//! The folder of an export, its parts and its lists.

pub(crate) mod documents;
pub(crate) mod fields;
pub(crate) mod lists;
pub(crate) mod part;
pub(crate) mod shards;
pub(crate) mod split;
pub(crate) mod target;
pub(crate) mod work;
