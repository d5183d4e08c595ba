-- Frames from workers that the service did not start, and which of them were rendered again with the same result. Rows stay
-- until their job has ended with every frame proven. They have no digests: a damaged row costs a check, not a fact.
CREATE TABLE deliveries (
    job_id       TEXT NOT NULL,
    frame        INTEGER NOT NULL,
    worker       TEXT NOT NULL,              -- id of its registration
    place        INTEGER NOT NULL,           -- order of commits
    proof        INTEGER NOT NULL DEFAULT 0, -- 0: none; 1: a good check of a frame drawn after it; 2: rendered again itself
    due          INTEGER NOT NULL,           -- 1: to be rendered again
    covers       INTEGER NOT NULL,           -- a good check proves the worker's frames up to this place
    PRIMARY KEY (job_id, frame)
) STRICT, WITHOUT ROWID;

CREATE INDEX deliveries_due ON deliveries (job_id, frame) WHERE due = 1;
CREATE INDEX deliveries_unproven ON deliveries (job_id, worker, place) WHERE proof = 0;

-- The key of the draw of checked frames. Workers never see it.
CREATE TABLE check_key (key TEXT PRIMARY KEY) STRICT, WITHOUT ROWID;
INSERT INTO check_key VALUES (lower(hex(randomblob(32))));

ALTER TABLE jobs ADD COLUMN unproven INTEGER;   -- number of deliveries without proof; null: 0
ALTER TABLE jobs ADD COLUMN mixed INTEGER;      -- 1: frames of any version and kind of machine
ALTER TABLE jobs ADD COLUMN distrusted INTEGER; -- 1: a check found a wrong frame, so every delivery is checked
