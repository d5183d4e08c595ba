//! Artifacts by digest in append-only SQLite packs.
//!
//! Blobs are named by their SHA-256 and stored in `packs/pack-000001.sqlite`, `packs/pack-000002.sqlite`, …: databases
//! with 64 KiB pages that only grow. At a size limit a pack is closed and the next one created. One task writes; it
//! groups the blobs of many callers into one transaction, and [`Store::put_all`] returns when that transaction is
//! durable. Readers have separate connections and never wait for the writer.
//!
//! Bytes are hashed when stored and on every read. Bytes that no longer match their digest are
//! [`StoreError::Corrupt`] and never served; storing them again repairs the blob. A damaged pack is closed for
//! writing.
//!
//! Deleting removes a blob's entry. Its bytes stay in the pack until [`Store::compact`] moves the live blobs to the
//! open pack and removes the file.
//!
//! The index from digest to pack takes 50 to 85 bytes of memory per blob and is read from the packs at start. There
//! is no index file that could disagree with them.

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
