//! The exported images: selection, sequences and files from the service.

pub(crate) mod archive;
pub(crate) mod fields;
pub(crate) mod frame;
pub(crate) mod member;
pub(crate) mod one_camera;
pub(crate) mod order;
pub(crate) mod origins;
pub(crate) mod posed;
pub(crate) mod selection;
pub(crate) mod sequences;
pub(crate) mod times;
