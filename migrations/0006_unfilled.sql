-- Columns that a newer program has added to images stored before, until they are filled from the records: a start that
-- is cut off goes on where it was.

CREATE TABLE unfilled (
    column_name  TEXT PRIMARY KEY,
    filled_to    INTEGER NOT NULL            -- the last rowid of images that has its value
) STRICT, WITHOUT ROWID;
