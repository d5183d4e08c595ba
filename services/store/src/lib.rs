//! Artifacts by digest in append-only SQLite packs.
