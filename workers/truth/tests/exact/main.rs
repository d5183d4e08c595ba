//! The truth against what is known: closed forms, laws that always hold, and another program.

mod chain;
mod checks;
mod golden;
mod support;
