-- Images of sets that were made without this service: their rows are here, their bytes stay in the tars of the set.

-- Where the set of an imported job lies: a folder or a URL. Null: the job was submitted here.
ALTER TABLE jobs ADD COLUMN set_location TEXT;
CREATE INDEX jobs_by_set ON jobs (set_location) WHERE set_location IS NOT NULL;

-- Where an artifact begins in the tar of its shard. Null: its bytes are in the packs.
ALTER TABLE artifacts ADD COLUMN tar_offset INTEGER;

-- Shards of imported jobs. Digest and time are null while only some of the shard's images are stored.
CREATE TABLE shards (
    job_id       TEXT NOT NULL,
    frame        INTEGER NOT NULL,           -- the first of the shard
    tar          TEXT NOT NULL,              -- name below the set
    digest       TEXT,                       -- over its images, as its marker has it
    changed_ms   INTEGER,                    -- of its marker, by the clock of the store
    PRIMARY KEY (job_id, frame)
) STRICT, WITHOUT ROWID;
