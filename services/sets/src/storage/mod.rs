//! Access to stores: folders and buckets.

pub(crate) mod change;
pub(crate) mod failure;
#[cfg(test)]
pub(crate) mod faulty;
pub(crate) mod layout;
pub(crate) mod location;
pub(crate) mod store;
pub(crate) mod transport;
pub(crate) mod upload;
