//! Sets: imported, listed, followed.

pub(crate) mod create;
pub(crate) mod set;
