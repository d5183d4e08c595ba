//! Bodies of responses.

pub(crate) mod docs;
pub(crate) mod lines;
pub(crate) mod page;
pub(crate) mod picture;
pub(crate) mod problem_page;
pub(crate) mod stored;
