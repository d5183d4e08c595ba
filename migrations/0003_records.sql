-- Records apart from the columns that are asked for: a question over parameters then reads a tenth of the pages.

CREATE TABLE records (
    job_id       TEXT NOT NULL,
    frame        INTEGER NOT NULL,
    record       TEXT NOT NULL,              -- everything known about the image, as JSON
    PRIMARY KEY (job_id, frame)
) STRICT;

INSERT INTO records (job_id, frame, record) SELECT job_id, frame, record FROM images ORDER BY rowid;
ALTER TABLE images DROP COLUMN record;

-- Pages of one dataset in the default order, and the digests of one job in frame order, from the index alone.
DROP INDEX images_by_dataset;
CREATE INDEX images_by_dataset ON images (dataset, job_id, frame, digest);
