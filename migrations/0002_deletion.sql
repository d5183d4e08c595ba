-- Deleting jobs whatever their size: one small transaction hides a job, later ones take its rows away bit by bit, and
-- the digests that lose a name wait here until the artifact store has let go of their bytes.

-- Bytes of the job's artifacts, so that hiding a job corrects the sums of its dataset at once.
ALTER TABLE jobs ADD COLUMN bytes INTEGER NOT NULL DEFAULT 0;
UPDATE jobs SET bytes = (SELECT coalesce(sum(bytes), 0) FROM artifacts WHERE job_id = jobs.id);

-- Jobs that nobody sees any more and whose rows still have to go.
CREATE TABLE deletions (
    job_id       TEXT PRIMARY KEY
) STRICT, WITHOUT ROWID;

-- Digests that a deleted row has named. Some may have other names.
CREATE TABLE orphans (
    digest       TEXT PRIMARY KEY
) STRICT, WITHOUT ROWID;

-- Whether a digest has a name.
CREATE INDEX artifacts_by_digest ON artifacts (digest);
CREATE INDEX scenes_by_rgb ON scenes (rgb_digest);
CREATE INDEX scenes_by_range ON scenes (range_digest) WHERE range_digest IS NOT NULL;
CREATE INDEX scenes_by_instances ON scenes (instances_digest) WHERE instances_digest IS NOT NULL;
-- A job goes with its keys.
CREATE INDEX idempotency_keys_by_job ON idempotency_keys (job_id);
