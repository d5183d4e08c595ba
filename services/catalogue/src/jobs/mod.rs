//! Jobs from submission to deletion.

pub(crate) mod deletion;
pub(crate) mod import;
pub(crate) mod open;
pub(crate) mod proofs;
pub(crate) mod recovery;
pub(crate) mod reopen;
pub(crate) mod restart;
pub(crate) mod rows;
pub(crate) mod submit;
pub(crate) mod warnings;
