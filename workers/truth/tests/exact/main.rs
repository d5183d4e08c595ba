//! The truth against what is known: closed forms, laws that always hold, and another program.

mod checks;
mod golden;
mod support;
