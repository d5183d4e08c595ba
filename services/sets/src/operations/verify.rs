//! Compares the files of a set with its markers.

use sha2::{Digest, Sha256};

use crate::error::SetError;
use crate::set::opened::Set;
use crate::storage::upload::FileSum;

/// Bytes per read.
const CHUNK_BYTES: u64 = 8 << 20;

/// The findings of a shard.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Report {
    /// Bytes that were read.
    pub bytes: u64,
    /// Damage; empty for an intact shard.
    pub damage: Vec<String>,
}

impl Set {
    /// Reads both files of a completed shard and compares them with its marker.
    ///
    /// # Errors
    /// [`SetError`] of the store; damage is part of the report.
    pub fn verify(&self, shard: u64) -> Result<Report, SetError> {
        let mut report = Report::default();
        let marker = match self.marker(shard) {
            Ok(Some(marker)) => marker,
            Ok(None) => return Ok(report.with_damage(format!("shard {shard} has no marker"))),
            Err(SetError::Damaged(reason)) => return Ok(report.with_damage(reason)),
            Err(error) => return Err(error),
        };
        for (name, sum) in [
            (marker.tar_name(), &marker.tar),
            (marker.rows_name(), &marker.rows),
        ] {
            self.compare(&name, sum, &mut report)?;
        }
        if report.damage.is_empty() {
            match marker.frame_digests(&self.store) {
                Ok(digests) if digest(&digests) == marker.digest => {}
                Ok(_) => report.damage.push(format!(
                    "{} and its marker differ in their digest",
                    marker.rows_name()
                )),
                Err(SetError::Damaged(reason)) => report.damage.push(reason),
                Err(error) => return Err(error),
            }
        }
        Ok(report)
    }

    /// Reads a file piece by piece.
    fn compare(&self, name: &str, sum: &FileSum, report: &mut Report) -> Result<(), SetError> {
        let found = self.store.entry(name)?.map(|entry| entry.bytes);
        if let Some(damage) = sum.contradiction(name, found) {
            report.damage.push(damage);
            return Ok(());
        }
        let mut hash = Sha256::new();
        let mut start = 0;
        while start < sum.bytes {
            let end = sum.bytes.min(start + CHUNK_BYTES);
            hash.update(&self.store.range(name, start..end)?);
            start = end;
        }
        report.bytes += sum.bytes;
        let found = hex::encode(hash.finalize());
        if found != sum.sha256 {
            report.damage.push(format!(
                "{name} has SHA-256 {found}, its marker says {}",
                sum.sha256
            ));
        }
        Ok(())
    }
}

impl Report {
    fn with_damage(mut self, damage: String) -> Self {
        self.damage.push(damage);
        self
    }
}

fn digest(frames: &[String]) -> String {
    spec::job_digest(frames.iter().map(String::as_str))
}
