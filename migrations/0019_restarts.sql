-- 1: the job starts again and may still have images of its earlier run. Its frames are not offered until they are removed.
ALTER TABLE jobs ADD COLUMN restarting INTEGER;

CREATE INDEX jobs_restarting ON jobs (id) WHERE restarting = 1;
