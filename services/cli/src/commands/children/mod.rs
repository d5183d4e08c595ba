//! Child processes of the service.

pub(crate) mod check_style;
pub(crate) mod decode;
pub(crate) mod live;
pub(crate) mod rerender;
