//! Uploaded scenes.
