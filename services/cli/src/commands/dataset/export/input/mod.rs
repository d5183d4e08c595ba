//! The exported images: selection, sequences and files from the service.

pub(crate) mod archive;
pub(crate) mod frame;
pub(crate) mod object_filter;
pub(crate) mod order;
pub(crate) mod origins;
pub(crate) mod posed;
pub(crate) mod selection;
pub(crate) mod sequences;
