//! End-to-end tests of the `fathom` binary.

mod backup;
mod command_line;
mod compose;
mod datasets;
mod earlier;
mod environment;
mod faults;
mod folders;
mod hostile_service;
mod pictures;
mod proof;
mod reproduce;
mod same_bytes;
mod service;
mod terminal;
mod tradeoff;
mod trained;
mod typed_values;
mod uploader;
