//! Renders of pictures that a request carries. Nothing is stored.
//!
//! The service reads the form and checks everything that needs no decoding; a separate process decodes the files and
//! renders them with [`renderer::Stream`].

mod child;
mod decode;
pub(crate) mod form;
pub(crate) mod protocol;
pub(crate) mod reply;

pub use child::render_pictures;
