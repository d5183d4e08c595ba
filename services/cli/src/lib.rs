//! What the commands `fathom` and `fathom-lab` share: exit statuses, files, progress, tables, contact sheets, the client of
//! a service, and jobs and styles as a user names them.

#![allow(missing_docs, reason = "read by two binaries of ours alone")]

pub mod exit;
pub mod files;
pub mod images;
pub mod job;
pub mod progress;
pub mod remote;
pub mod sheet;
pub mod styles;
pub mod table;
