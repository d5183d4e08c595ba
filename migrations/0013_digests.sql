-- Every row that is data has a digest of its values beside it: 64 bits of SHA-256. It is made when the row is written, and
-- compared when the row is read. Within the writer's transaction a changed row has none; outside of it a row without one is
-- damaged. Wide columns, measurements and artifacts have none: they are compared with the record, from which they follow.

ALTER TABLE records ADD COLUMN row_digest INTEGER; -- also over the job, frame, dataset, time and digest of its image
ALTER TABLE jobs ADD COLUMN row_digest INTEGER;    -- over all but the description, which spec_digest covers
ALTER TABLE datasets ADD COLUMN row_digest INTEGER;
ALTER TABLE idempotency_keys ADD COLUMN row_digest INTEGER;
ALTER TABLE scenes ADD COLUMN row_digest INTEGER;
ALTER TABLE waters ADD COLUMN row_digest INTEGER;
ALTER TABLE collection_scenes ADD COLUMN row_digest INTEGER;
ALTER TABLE versions ADD COLUMN row_digest INTEGER;
ALTER TABLE version_jobs ADD COLUMN row_digest INTEGER;
ALTER TABLE failures ADD COLUMN row_digest INTEGER;
ALTER TABLE shards ADD COLUMN row_digest INTEGER;
ALTER TABLE deletions ADD COLUMN row_digest INTEGER;

-- The rows that a transaction has changed so far.
CREATE INDEX jobs_undigested ON jobs (id) WHERE row_digest IS NULL;
CREATE INDEX datasets_undigested ON datasets (name) WHERE row_digest IS NULL;
CREATE INDEX idempotency_keys_undigested ON idempotency_keys (owner, key) WHERE row_digest IS NULL;
CREATE INDEX scenes_undigested ON scenes (id) WHERE row_digest IS NULL;
CREATE INDEX waters_undigested ON waters (name) WHERE row_digest IS NULL;
CREATE INDEX collection_scenes_undigested ON collection_scenes (collection, name) WHERE row_digest IS NULL;
CREATE INDEX versions_undigested ON versions (dataset, version) WHERE row_digest IS NULL;
CREATE INDEX version_jobs_undigested ON version_jobs (dataset, version, job_id) WHERE row_digest IS NULL;
CREATE INDEX failures_undigested ON failures (job_id, frame) WHERE row_digest IS NULL;
CREATE INDEX shards_undigested ON shards (job_id, frame) WHERE row_digest IS NULL;
CREATE INDEX deletions_undigested ON deletions (job_id) WHERE row_digest IS NULL;

-- Rows of before get theirs at the next start.
INSERT INTO unfilled (column_name, filled_to) VALUES ('row_digest', -1);
