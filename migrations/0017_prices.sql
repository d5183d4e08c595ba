-- The caller that submitted a job, and the expected cost of all its frames. Null: imported, or of an earlier version.

ALTER TABLE jobs ADD COLUMN owner TEXT;
ALTER TABLE jobs ADD COLUMN price_ms INTEGER;
ALTER TABLE jobs ADD COLUMN price_bytes INTEGER;
