-- The data folder that this catalogue belongs to. The packs name the same one, so that a catalogue is never taken for that of
-- other packs.

CREATE TABLE folder (
    id            TEXT PRIMARY KEY,
    row_digest    INTEGER
) STRICT, WITHOUT ROWID;
CREATE INDEX folder_undigested ON folder (id) WHERE row_digest IS NULL;
INSERT INTO folder (id) VALUES (lower(hex(randomblob(16))));
