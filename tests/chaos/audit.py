#!/usr/bin/env python3
"""Reads a data folder without any code of Fathom: sqlite3 and hashlib alone.

    audit.py facts FOLDER          prints one digest over everything that is stored, or fails if it cannot be read
    audit.py whole FOLDER [IDS]    prints what is wrong with the folder: pages, counts, rows without bytes, bytes with another
                                   digest, a frame with two images, an open job; IDS is a file of jobs that were accepted
    audit.py answers FOLDER URL    compares what a service over the folder responds with what is stored
"""

import glob
import hashlib
import json
import os
import shutil
import sqlite3
import sys
import tempfile
import urllib.request

# Not facts: which migrations ran, SQLite's own statistics, and lists of what is still to be done.
BOOKKEEPING = ("_sqlx_migrations", "sqlite_stat1", "sqlite_stat4", "unfilled", "orphans")
OPEN = ("queued", "running", "paused")


def database(path, mode="rw"):
    connection = sqlite3.connect(f"file:{path}?mode={mode}", uri=True)
    connection.text_factory = bytes
    return connection


def packs(folder):
    return sorted(glob.glob(os.path.join(folder, "packs", "pack-*.sqlite")))


def tables(connection):
    names = connection.execute("SELECT name FROM sqlite_schema WHERE type = 'table' ORDER BY name")
    return [name.decode() for (name,) in names]


def facts(folder):
    total = hashlib.sha256()
    connection = database(os.path.join(folder, "catalogue.sqlite"), "ro")
    for table in tables(connection):
        if table not in BOOKKEEPING:
            rows = sorted(repr(row) for row in connection.execute(f'SELECT * FROM "{table}" NOT INDEXED'))
            total.update(repr((table, rows)).encode())
    blobs = []
    for path in packs(folder):
        pack = database(path, "ro")
        data = {key: hashlib.sha256(value).hexdigest() for key, value in pack.execute("SELECT id, bytes FROM data")}
        for digest, length, key in pack.execute("SELECT digest, length, data FROM entry"):
            blobs.append((digest.hex(), length, data.get(key)))
    total.update(repr(sorted(blobs, key=repr)).encode())
    return total.hexdigest()


def stored(folder, wrong):
    """The digest of every blob whose bytes have it."""
    good = set()
    for path in packs(folder):
        pack = database(path)
        for (finding,) in pack.execute("PRAGMA integrity_check"):
            if finding != b"ok":
                wrong.append(f"{path}: {finding.decode()}")
        for digest, value in pack.execute("SELECT digest, bytes FROM entry JOIN data ON data.id = entry.data"):
            if hashlib.sha256(value).digest() == digest:
                good.add(digest.hex())
            else:
                wrong.append(f"{path}: {digest.hex()} has other bytes")
    return good


def whole(folder, accepted):
    wrong = []
    connection = database(os.path.join(folder, "catalogue.sqlite"))
    for (finding,) in connection.execute("PRAGMA integrity_check"):
        if finding != b"ok":
            wrong.append(f"catalogue: {finding.decode()}")
    good = stored(folder, wrong)
    jobs = {}
    for row in connection.execute("SELECT id, state, frames, done, failed, spec, spec_digest FROM jobs"):
        name, state, frames, done, failed, spec, digest = row
        jobs[name.decode()] = state.decode()
        if hashlib.sha256(spec).hexdigest() != digest.decode():
            wrong.append(f"{name.decode()}: another description")
        images = [frame for (frame,) in connection.execute("SELECT frame FROM images WHERE job_id = ?", (name.decode(),))]
        if len(images) != done or len(set(images)) != done or any(not 0 <= frame < frames for frame in images):
            wrong.append(f"{name.decode()}: {len(images)} images, {done} counted, {frames} frames")
        if (done + failed >= frames) == (state.decode() in OPEN) and state != b"cancelled":
            wrong.append(f"{name.decode()}: {state.decode()} with {done} + {failed} of {frames}")
    for job, frame, record in connection.execute("SELECT job_id, frame, record FROM records"):
        named = {entry["kind"]: entry["digest"] for entry in json.loads(record)["artifacts"]}
        rows = connection.execute("SELECT kind, digest FROM artifacts WHERE job_id = ? AND frame = ?", (job.decode(), frame))
        if named != {kind.decode(): digest.decode() for kind, digest in rows}:
            wrong.append(f"{job.decode()}/{frame}: artifacts differ from the record")
        missing = [kind for kind, digest in named.items() if digest not in good]
        if missing:
            wrong.append(f"{job.decode()}/{frame}: no bytes of {missing}")
    wrong.extend(f"{name} was accepted and is gone" for name in accepted if name not in jobs)
    return wrong


def answers(folder, url):
    wrong = []
    connection = database(os.path.join(folder, "catalogue.sqlite"), "ro")
    for job, frame, record in connection.execute("SELECT job_id, frame, record FROM records ORDER BY 1, 2").fetchall():
        job, record = job.decode(), json.loads(record)
        with urllib.request.urlopen(f"{url}/v1/images/{job}/{frame}") as response:
            told = json.load(response)
        for extra in ("job", "dataset", "created_at"):
            told.pop(extra)
        if told != record:
            wrong.append(f"{job}/{frame}: another record is served")
        for entry in record["artifacts"]:
            with urllib.request.urlopen(f"{url}/v1/images/{job}/{frame}/artifacts/{entry['kind']}") as response:
                if hashlib.sha256(response.read()).hexdigest() != entry["digest"]:
                    wrong.append(f"{job}/{frame}: other bytes of {entry['kind']} are served")
    return wrong


def main():
    what, folder = sys.argv[1:3]
    if what == "facts":
        print(facts(folder))
        return 0
    if what == "answers":
        wrong = answers(folder, sys.argv[3])
    else:
        accepted = open(sys.argv[3]).read().split() if len(sys.argv) > 3 else []
        with tempfile.TemporaryDirectory() as copies:
            # SQLite takes up its logs, which changes files.
            copy = os.path.join(copies, "data")
            shutil.copytree(folder, copy, ignore=shutil.ignore_patterns("space.reserve", "*-shm"))
            wrong = whole(copy, accepted)
    print("\n".join(wrong))
    return 1 if wrong else 0


sys.exit(main())
