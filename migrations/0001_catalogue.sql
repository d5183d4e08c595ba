-- The catalogue: jobs, scenes, images, measurements and the names of artifacts. Parameters and metrics are wide columns
-- that are added at start from their registries, so this file holds only what the service itself keeps.

CREATE TABLE jobs (
    id           TEXT PRIMARY KEY,          -- job_ and a UUIDv7, so that the order of ids is the order of arrival
    dataset      TEXT NOT NULL,
    spec         TEXT NOT NULL,             -- canonical description; frames are a formula of it until they have an image
    spec_digest  TEXT NOT NULL,
    frames       INTEGER NOT NULL,
    priority     INTEGER NOT NULL,
    -- queued: no frame has ended yet. running: some have. paused: nothing is offered for now. cancelled: by the user,
    -- what is there stays. done: every frame has its image. done_with_failures: some frames were given up.
    state        TEXT NOT NULL CHECK (state IN ('queued', 'running', 'paused', 'cancelled', 'done', 'done_with_failures')),
    done         INTEGER NOT NULL DEFAULT 0,
    failed       INTEGER NOT NULL DEFAULT 0,
    version      INTEGER NOT NULL DEFAULT 1, -- grows with every change; long-polls wait for it
    digest       TEXT,                       -- over all frames, once the job is done
    created_ms   INTEGER NOT NULL,
    started_ms   INTEGER,
    finished_ms  INTEGER
) STRICT;

-- Lists of one dataset's jobs, newest first.
CREATE INDEX jobs_by_dataset ON jobs (dataset, id);
-- Recovery at start looks only for jobs that have not ended.
CREATE INDEX jobs_open ON jobs (id) WHERE state IN ('queued', 'running', 'paused');

CREATE TABLE idempotency_keys (
    owner        TEXT NOT NULL,              -- hash of the caller's token: keys of different callers never meet
    key          TEXT NOT NULL,
    body_digest  TEXT NOT NULL,
    job_id       TEXT NOT NULL REFERENCES jobs (id),
    PRIMARY KEY (owner, key)
) STRICT, WITHOUT ROWID;

CREATE TABLE datasets (
    name         TEXT PRIMARY KEY,
    images       INTEGER NOT NULL DEFAULT 0,
    bytes        INTEGER NOT NULL DEFAULT 0, -- of artifacts, shared ones counted each time
    jobs         INTEGER NOT NULL DEFAULT 0
) STRICT, WITHOUT ROWID;

CREATE TABLE scenes (
    id               TEXT PRIMARY KEY,
    content_digest   TEXT NOT NULL UNIQUE,   -- the same content is the same scene
    rgb_digest       TEXT NOT NULL,
    range_digest     TEXT,
    range_kind       TEXT CHECK (range_kind IN ('range', 'z_depth')), -- range: along the ray; z_depth: along the axis
    unit_m           REAL,
    invalid_code     INTEGER,
    instances_digest TEXT,
    width            INTEGER NOT NULL,
    height           INTEGER NOT NULL,
    focal_px         REAL,
    cx               REAL,
    cy               REAL,
    created_ms       INTEGER NOT NULL
) STRICT;

CREATE TABLE images (
    job_id       TEXT NOT NULL REFERENCES jobs (id),
    frame        INTEGER NOT NULL,
    dataset      TEXT NOT NULL,
    created_ms   INTEGER NOT NULL,
    digest       TEXT NOT NULL,              -- of the frame: parameters and artifacts
    record       TEXT NOT NULL,              -- everything known about the image, as JSON
    PRIMARY KEY (job_id, frame)              -- a repeated commit finds its row
) STRICT;

-- Pages of one dataset in the default order.
CREATE INDEX images_by_dataset ON images (dataset, job_id, frame);

CREATE TABLE measurements (
    job_id       TEXT NOT NULL,
    frame        INTEGER NOT NULL,
    subject      TEXT NOT NULL,              -- what was measured: rgb, or the method of an enhanced picture
    PRIMARY KEY (job_id, frame, subject)
) STRICT, WITHOUT ROWID;

CREATE TABLE artifacts (
    job_id       TEXT NOT NULL,
    frame        INTEGER NOT NULL,
    kind         TEXT NOT NULL,
    digest       TEXT NOT NULL,
    bytes        INTEGER NOT NULL,
    media_type   TEXT NOT NULL,
    PRIMARY KEY (job_id, frame, kind)
) STRICT, WITHOUT ROWID;

CREATE TABLE failures (
    job_id       TEXT NOT NULL,
    frame        INTEGER NOT NULL,
    strikes      INTEGER NOT NULL,
    quarantined  INTEGER NOT NULL,           -- 1: given up, 0: will be tried again
    error        TEXT NOT NULL,              -- of the last attempt
    PRIMARY KEY (job_id, frame)
) STRICT, WITHOUT ROWID;
