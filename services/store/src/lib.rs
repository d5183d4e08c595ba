//! Artifacts by digest in append-only SQLite packs.
//!
//! Bytes are named by their SHA-256 and live in `packs/pack-000001.sqlite`, `packs/pack-000002.sqlite`, …: databases
//! with 64 KiB pages that only ever grow, until a limit closes one and opens the next. One task writes; it gathers the
//! blobs of many callers into one transaction, and [`Store::put_all`] returns when that transaction is on the disk.
//! Readers have their own connections and never wait for the writer.
//!
//! Bytes are hashed when they come in and again whenever they go out: what no longer has its name is
//! [`StoreError::Corrupt`] and is never served. Putting the same bytes again repairs it. A pack with damage grows no more.
//!
//! Deleting takes a blob's entry away; its bytes stay in the pack until [`Store::compact`] moves what is left of the pack
//! to the one that grows and removes the file.
//!
//! Which pack holds a digest is kept in memory, 50 to 85 bytes a blob, and read from the packs at start. There is no
//! index file that could disagree with them.

mod check;
mod compaction;
mod digest;
mod error;
mod index;
mod pack;
mod readers;
mod store;
mod writer;

pub use compaction::Compaction;
pub use error::StoreError;
pub use store::{Blob, Scrubbed, Store, StoreStats};
