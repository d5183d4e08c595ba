"""A set of very many images: some are rendered, the others are copies of their rows with other numbers and frames of their own.

The bytes of a copy are those of the image it was copied from. The service makes the digests of all rows anew when it starts, as after an
upgrade.
"""

import sqlite3

JOB = {
    "dataset": "many",
    "count": 400,
    "seed": 7,
    "scene": {"kind": "procedural", "family": "shaft", "seed": 1},
    "camera": {"width": 32, "height": 24},
    "water": {"optics": {"choice": ["jerlov-IB", "jerlov-1C"]}, "style": "atlantic"},
    "alpha": {"uniform": [0, 1]},
    "artifacts": ["rgb"],
    "metrics": ["uiqm"],
}

# Numbers of six decimals: their text in a record is read as the very double of the column.
NUMBERS = """CREATE TEMP TABLE copies AS
    WITH RECURSIVE frames(frame) AS (SELECT :rendered UNION ALL SELECT frame + 1 FROM frames WHERE frame + 1 < :images)
    SELECT frame, frame % :rendered AS source, abs(random() % 1000000) / 1e6 AS alpha,
           (abs(random() % 1000000) + abs(random() % 1000000)) / 5e5 AS uiqm FROM frames"""


def copied(base, table, values):
    """A statement that copies rows of a table; values has those that a copy does not share."""
    columns = [row[1] for row in base.execute(f"PRAGMA table_info({table})")]
    filled = base.execute(f"SELECT {', '.join(f'count({quoted(name)})' for name in columns)} FROM {table}").fetchone()
    columns = [name for name, count in zip(columns, filled) if count > 0]
    shown = [values.get(name, f"row.{quoted(name)}") for name in columns]
    return f"""INSERT INTO {table} ({", ".join(map(quoted, columns))}) SELECT {", ".join(shown)} FROM copies
        JOIN {table} AS row ON row.job_id = :job AND row.frame = copies.source ORDER BY copies.frame"""


def quoted(name):
    return f'"{name}"'


def multiply(catalogue, job, images):
    """Makes the images of a finished job that many. No service may run."""
    base = sqlite3.connect(catalogue, isolation_level=None)
    # A set of a test: what is cut off is made anew.
    base.execute("PRAGMA journal_mode = OFF")
    base.execute("PRAGMA synchronous = OFF")
    base.execute("PRAGMA cache_size = -200000")
    rendered = base.execute("SELECT count(*) FROM images WHERE job_id = ?", [job]).fetchone()[0]
    base.execute(NUMBERS, {"rendered": rendered, "images": images})
    indexes = base.execute("SELECT name, sql FROM sqlite_master WHERE type = 'index' AND tbl_name IN ('images', 'artifacts') AND sql IS NOT NULL")
    indexes = indexes.fetchall()
    base.execute("BEGIN")
    for name, _ in indexes:
        base.execute(f"DROP INDEX {name}")
    # Short records: most of the time is spent on them.
    record = "json_set(json_remove(row.record, '$.plan', '$.optics', '$.scene', '$.timings_ms'), '$.frame', copies.frame, '$.parameters.alpha', copies.alpha, '$.measurements.rgb.uiqm', copies.uiqm)"
    own = {
        "images": {"frame": "copies.frame", "alpha": "copies.alpha"},
        "records": {"frame": "copies.frame", "record": record, "row_digest": "NULL"},
        "measurements": {"frame": "copies.frame", "uiqm": "copies.uiqm"},
        "artifacts": {"frame": "copies.frame"},
    }
    for table, values in own.items():
        base.execute(copied(base, table, values), {"job": job})
    for _, sql in indexes:
        base.execute(sql)
    base.execute("UPDATE jobs SET frames = ?1, done = ?1, row_digest = NULL WHERE id = ?2", [images, job])
    base.execute("UPDATE datasets SET images = ?, row_digest = NULL WHERE name = ?", [images, JOB["dataset"]])
    base.execute("INSERT OR REPLACE INTO unfilled (column_name, filled_to) VALUES ('row_digest', -1)")
    base.execute("COMMIT")
    base.close()
