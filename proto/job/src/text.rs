//! Texts of descriptions and their errors.

pub(crate) mod earlier;
pub(crate) mod encode;
pub(crate) mod invalid;
pub(crate) mod json;
pub mod migration;
pub(crate) mod suggest;
