//! Plans of forward scatter.

pub(crate) mod gates;
pub(crate) mod layered;
pub(crate) mod passages;
pub(crate) mod scatter;
