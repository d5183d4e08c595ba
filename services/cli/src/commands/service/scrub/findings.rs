//! The findings of a scrub.

use cli::plural::count;
use serde::Serialize;
use store::Scrubbed;

/// The findings of a scrub.
#[derive(Default, Serialize)]
pub(super) struct Findings {
    /// Blobs that were read.
    pub(super) blobs: u64,
    /// Artifacts in the tars of sets that were read.
    pub(super) imported: u64,
    pub(super) bytes: u64,
    /// Errors in the catalogue itself.
    pub(super) catalogue: Vec<String>,
    /// Damaged rows of the catalogue.
    pub(super) rows: Vec<Row>,
    /// Packs that cannot be read at all.
    pub(super) packs_set_aside: u64,
    /// Errors in files of the replica.
    pub(super) mirror: Vec<String>,
    /// Number of written files of the replica.
    pub(super) mirror_written: u64,
    /// Errors in packs, apart from the bytes of blobs.
    pub(super) packs: Vec<String>,
    pub(super) damaged: Vec<Damaged>,
    pub(super) unnamed: Unnamed,
}

/// A damaged row of the catalogue.
#[derive(Serialize)]
pub(super) struct Row {
    /// The row and the damaged part.
    pub(super) what: String,
    /// None: repair was not requested.
    pub(super) repaired: Option<bool>,
    /// Why it was not repaired.
    pub(super) reason: Option<String>,
}

/// Unreferenced space, which is not damage.
#[derive(Default, Serialize)]
pub(super) struct Unnamed {
    /// Blobs that no row names.
    pub(super) blobs: u64,
    /// Bytes of the disk that are free again.
    pub(super) freed: u64,
}

/// A damaged or missing blob that a row names.
#[derive(Serialize)]
pub(super) struct Damaged {
    pub(super) digest: String,
    pub(super) state: &'static str,
    /// Such as `rgb of job_…/3`.
    pub(super) owner: String,
    /// None: repair was not requested.
    pub(super) repaired: Option<bool>,
    /// Why it was not repaired.
    pub(super) reason: Option<String>,
}

impl Damaged {
    pub(super) fn new(
        digest: String,
        state: Scrubbed,
        owner: String,
        repair: Option<Result<(), String>>,
    ) -> Self {
        Self {
            digest,
            state: match state {
                Scrubbed::Good => "good",
                Scrubbed::Corrupt => "corrupt",
                Scrubbed::Missing => "missing",
            },
            owner,
            repaired: repair.as_ref().map(Result::is_ok),
            reason: repair.and_then(Result::err),
        }
    }
}

impl Findings {
    pub(super) fn left(&self) -> usize {
        let left = self
            .damaged
            .iter()
            .filter(|damaged| damaged.repaired != Some(true));
        // A pack that was set aside does not count once all its blobs are restored.
        let rows = self.rows.iter().filter(|row| row.repaired != Some(true));
        let mirror = if self.mirror_written > 0 {
            0
        } else {
            self.mirror.len()
        };
        mirror + self.catalogue.len() + self.packs.len() + rows.count() + left.count()
    }

    pub(super) fn print(&self) {
        println!(
            "{} blobs and {} artifacts in sets, {} MB read",
            self.blobs,
            self.imported,
            self.bytes / 1_000_000
        );
        for finding in &self.catalogue {
            println!("catalogue: {finding}");
        }
        for Row {
            what,
            repaired,
            reason,
        } in &self.rows
        {
            println!(
                "catalogue: damaged {what}{}",
                outcome(*repaired, reason.as_deref())
            );
        }
        for finding in &self.mirror {
            println!("mirror: {finding}");
        }
        if self.mirror_written > 0 {
            println!("{} of the mirror written", count(self.mirror_written, "file"));
        }
        for finding in &self.packs {
            println!("packs: {finding}");
        }
        if self.unnamed.blobs > 0 {
            let Unnamed { blobs, freed } = self.unnamed;
            println!("{blobs} blobs that no row names; {freed} bytes freed");
        }
        if self.packs_set_aside > 0 {
            println!(
                "{} packs could not be read and were set aside",
                self.packs_set_aside
            );
        }
        for damaged in &self.damaged {
            let Damaged {
                digest, state, owner, ..
            } = damaged;
            let outcome = outcome(damaged.repaired, damaged.reason.as_deref());
            println!("{state} {digest}: {owner}{outcome}");
        }
        if self.left() == 0 {
            println!("all is well");
        }
    }
}

pub(super) fn outcome(repaired: Option<bool>, reason: Option<&str>) -> String {
    match (repaired, reason) {
        (Some(true), _) => "; restored".to_owned(),
        (_, Some(reason)) => format!("; not repaired: {reason}"),
        (_, None) => String::new(),
    }
}
