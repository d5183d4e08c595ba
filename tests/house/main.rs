//! The rules of ARCHITECTURE.md and CONTRIBUTING.md, checked on sources, manifests and pages.

mod architecture;
mod documents;
mod modules;
