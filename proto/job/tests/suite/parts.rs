//! Parts of a description.

pub(crate) mod daylight;
pub(crate) mod enhance;
pub(crate) mod lights;
pub(crate) mod paths;
pub(crate) mod scenes;
pub(crate) mod site_errors;
pub(crate) mod sites;
pub(crate) mod suspended;
pub(crate) mod truth;
pub(crate) mod waters;
