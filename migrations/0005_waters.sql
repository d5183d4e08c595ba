-- Waters of the users' own.

CREATE TABLE waters (
    name         TEXT PRIMARY KEY,
    description  TEXT NOT NULL,              -- as it was submitted, JSON
    created_ms   INTEGER NOT NULL
) STRICT;
