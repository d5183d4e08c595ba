//! The truth against closed forms, general laws and an independent program.

mod chain;
mod channels;
mod checks;
mod golden;
mod support;
mod veil;
