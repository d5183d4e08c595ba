-- Sealed versions of datasets. All jobs of a version have ended; while it is sealed nothing adds to them or deletes them, so
-- that its images are those of its jobs. A number is never used twice: what was unsealed stays as a row without jobs.

CREATE TABLE versions (
    dataset       TEXT NOT NULL,
    version       INTEGER NOT NULL,
    root          TEXT NOT NULL,             -- of the Merkle tree over the roots of its jobs
    images        INTEGER NOT NULL,
    bytes         INTEGER NOT NULL,          -- of artifacts, shared ones counted each time
    code_versions TEXT NOT NULL,             -- JSON list: versions of the program that made the images
    created_ms    INTEGER NOT NULL,
    unsealed_ms   INTEGER,
    PRIMARY KEY (dataset, version)
) STRICT, WITHOUT ROWID;

CREATE TABLE version_jobs (
    dataset       TEXT NOT NULL,
    version       INTEGER NOT NULL,
    job_id        TEXT NOT NULL,
    root          TEXT NOT NULL,             -- of the Merkle tree over the digests of its images in the order of frames
    PRIMARY KEY (dataset, version, job_id)
) STRICT, WITHOUT ROWID;

-- Whether a job is sealed.
CREATE INDEX version_jobs_by_job ON version_jobs (job_id);
