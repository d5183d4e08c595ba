pub(crate) mod create;
pub(crate) mod list;
pub(crate) mod model;
pub(crate) mod train;
pub(crate) mod training;
