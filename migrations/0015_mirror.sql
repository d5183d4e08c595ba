-- Files that hold rows of images by columns, for counting: folder `mirror` beside the catalogue. They are a copy. What no file holds is
-- counted from the tables, and a file whose row is gone holds nothing.

CREATE TABLE mirror_files (
    name         TEXT PRIMARY KEY,
    first_row    INTEGER NOT NULL,           -- it holds the images of these rowids, apart from jobs that were being deleted
    last_row     INTEGER NOT NULL,
    images       INTEGER NOT NULL,
    digest       TEXT NOT NULL,              -- of its footer, which has a checksum of each column
    bytes        INTEGER NOT NULL,
    columns      TEXT NOT NULL               -- digest of the names of all columns that it may have
) STRICT, WITHOUT ROWID;

-- The jobs of which a file has rows that count. A job that is deleted leaves its rows in the file, but not here.
CREATE TABLE mirror_jobs (
    job_id       TEXT NOT NULL,
    file         TEXT NOT NULL REFERENCES mirror_files (name) ON DELETE CASCADE,
    images       INTEGER NOT NULL,
    PRIMARY KEY (job_id, file)
) STRICT, WITHOUT ROWID;
CREATE INDEX mirror_jobs_by_file ON mirror_jobs (file);

-- Grows whenever images that are stored go or change: a file that was being written meanwhile is not taken.
CREATE TABLE mirror_changes (changes INTEGER NOT NULL) STRICT;
INSERT INTO mirror_changes (changes) VALUES (0);
