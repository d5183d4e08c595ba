pub(crate) mod create;
pub(crate) mod water;
