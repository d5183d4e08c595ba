//! Who renders which frames: the lease table, the workers, and what they report.

pub(crate) mod changes;
pub(crate) mod costs;
pub(crate) mod dispatch;
mod granted;
pub(crate) mod routes;
pub(crate) mod strikes;
pub mod table;
