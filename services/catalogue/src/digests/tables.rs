//! The tables whose rows have a digest, and the columns that it covers.

/// A table whose rows have a digest.
pub(crate) struct Table {
    pub(crate) name: &'static str,
    /// The columns of the digest, separated by commas. Columns without a value are skipped, so that new columns change no digest.
    pub(crate) columns: &'static str,
    /// How many of them, from the first, are the key.
    pub(crate) keys: usize,
}

/// The columns of a job's row, as `jobs` reads them.
macro_rules! job_columns {
    () => {
        "id, dataset, state, frames, done, failed, bytes, version, created_ms, started_ms, finished_ms, digest,
         priority, spec_digest, set_location, owner, price_ms, price_bytes, unproven, mixed, distrusted,
         restarting"
    };
}
pub(crate) use job_columns;

/// The columns of a job's row with its digest.
macro_rules! digested_job_columns {
    () => {
        concat!($crate::digests::tables::job_columns!(), ", row_digest")
    };
}
pub(crate) use digested_job_columns;

/// The columns of a scene's row, as `scenes` reads them.
macro_rules! scene_columns {
    () => {
        "id, content_digest, rgb_digest, range_digest, range_kind, unit_m, invalid_code, instances_digest, width, height,
         focal_px, cx, cy, created_ms, classes, world_from_camera, hfov_deg, scale"
    };
}
pub(crate) use scene_columns;

pub(crate) const JOBS: Table = Table {
    name: "jobs",
    columns: job_columns!(),
    keys: 1,
};

pub(crate) const DATASETS: Table = Table {
    name: "datasets",
    columns: "name, images, bytes, jobs",
    keys: 1,
};

pub(crate) const KEYS: Table = Table {
    name: "idempotency_keys",
    columns: "owner, key, body_digest, job_id",
    keys: 2,
};

pub(crate) const SCENES: Table = Table {
    name: "scenes",
    columns: scene_columns!(),
    keys: 1,
};

pub(crate) const WATERS: Table = Table {
    name: "waters",
    columns: "name, description, created_ms",
    keys: 1,
};

pub(crate) const COLLECTION_SCENES: Table = Table {
    name: "collection_scenes",
    columns: "collection, name, scene_id",
    keys: 2,
};

pub(crate) const VERSION_JOBS: Table = Table {
    name: "version_jobs",
    columns: "dataset, version, job_id, root",
    keys: 3,
};

pub(crate) const VERSIONS: Table = Table {
    name: "versions",
    columns: "dataset, version, root, images, bytes, code_versions, created_ms, unsealed_ms",
    keys: 2,
};

pub(crate) const FAILURES: Table = Table {
    name: "failures",
    columns: "job_id, frame, strikes, quarantined, error",
    keys: 2,
};

pub(crate) const SHARDS: Table = Table {
    name: "shards",
    columns: "job_id, frame, tar, digest, changed_ms",
    keys: 2,
};

pub(crate) const DELETIONS: Table = Table {
    name: "deletions",
    columns: "job_id",
    keys: 1,
};

pub(crate) const FOLDER: Table = Table {
    name: "folder",
    columns: "id",
    keys: 1,
};

/// All of them, apart from `records`, whose digest is over the row of the image, too.
pub(crate) const TABLES: [&Table; 12] = [
    &JOBS,
    &DATASETS,
    &KEYS,
    &SCENES,
    &WATERS,
    &COLLECTION_SCENES,
    &VERSION_JOBS,
    &VERSIONS,
    &FAILURES,
    &SHARDS,
    &DELETIONS,
    &FOLDER,
];
