"""Renders every case with a binary and reads the record and files of each frame."""

import concurrent.futures
import hashlib
import json
import os
import pathlib
import struct
import subprocess
import zlib

# What one column of frames.txt covers, so that a difference names what changed.
COLUMNS = ["frame", "pixels", "parameters", "optics", "plan", "measured", "rest"]


def digest(data):
    return hashlib.sha256(data if isinstance(data, bytes) else data.encode()).hexdigest()


def canonical(value):
    return json.dumps(value, sort_keys=True, separators=(",", ":"))


def pixels(data):
    """Pixels of a PNG with their form, whatever it was compressed with; any other file as it is."""
    if not data.startswith(b"\x89PNG\r\n\x1a\n"):
        return data
    place, stream, head = 8, b"", b""
    while place < len(data):
        length, kind = struct.unpack(">I4s", data[place:place + 8])
        body = data[place + 8:place + 8 + length]
        head = body if kind == b"IHDR" else head
        stream += body if kind == b"IDAT" else b""
        place += length + 12
    width, height, depth, color = struct.unpack(">IIBB", head[:10])
    step = max(1, depth * {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[color] // 8)
    line = (width * depth * {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[color] + 7) // 8
    return head[:10] + unfiltered(zlib.decompress(stream), height, line, step)


def unfiltered(raw, height, line, step):
    out, before = bytearray(), bytearray(line)
    for row in range(height):
        start = row * (line + 1)
        kind, now = raw[start], bytearray(raw[start + 1:start + 1 + line])
        if kind:
            for i in range(line):
                left = now[i - step] if i >= step else 0
                corner = before[i - step] if i >= step else 0
                now[i] = now[i] + predicted(kind, left, before[i], corner) & 255
        out += now
        before = now
    return bytes(out)


def predicted(kind, left, up, corner):
    if kind < 3:
        return left if kind == 1 else up
    if kind == 3:
        return (left + up) // 2
    toward = left + up - corner
    return min([left, up, corner], key=lambda value: abs(toward - value))


def member_text(line, name):
    """The text of a member of a JSON object, as it stands in the line."""
    start = line.index(f'"{name}":') + len(name) + 3
    return line[start:json.JSONDecoder().raw_decode(line, start)[1]]


def product_digest(record, parameters):
    """`spec::FrameRecord::digest`."""
    hashed = hashlib.sha256(b"fathom-frame-v1" + struct.pack("<Q", record["frame"]))
    for kind, content in sorted((entry["kind"], entry["digest"]) for entry in record["artifacts"]):
        hashed.update(kind.encode() + b"\0" + content.encode() + b"\0")
    hashed.update(parameters.encode())
    return hashed.hexdigest()


def read_frame(line, folder):
    """The columns of a frame from its record and its files."""
    record = json.loads(line)
    files = {entry["kind"]: entry for entry in record["artifacts"]}
    stored = {path.stem: path.read_bytes() for path in pathlib.Path(folder, str(record["frame"])).iterdir()}
    assert {kind: digest(data) for kind, data in stored.items()} == {kind: entry["digest"] for kind, entry in files.items()}
    rest = {key: record.get(key) for key in ("counts", "warnings", "scene", "promise")} | {"inputs": record["provenance"]["inputs"]}
    rest["media_types"] = {kind: entry["media_type"] for kind, entry in files.items()}
    covered = {"pixels": {kind: digest(pixels(stored[kind])) for kind in sorted(stored)}, "parameters": record["parameters"],
               "optics": record["optics"], "plan": record["plan"], "measured": record["measurements"], "rest": rest}
    return [product_digest(record, member_text(line, "parameters")), *(digest(canonical(covered[column]))[:16] for column in COLUMNS[1:])]


def changed(before, after):
    """What changed from one row to another."""
    old, new = before.split(), after.split()
    if len(old) != len(COLUMNS) or len(new) != len(COLUMNS):
        return f"{before} -> {after}"
    return ", ".join(column for column, was, now in zip(COLUMNS, old, new) if was != now)


def render(binary, name, job, work):
    """The rows of a case: digests of a frame, or an error, by number; and the digest of the canonical job, or why it is refused, as
    `job`."""
    place = work / "jobs"
    place.mkdir(exist_ok=True)
    (place / f"{name}.json").write_text(json.dumps(job))
    out = work / "out" / name
    environment = {key: value for key, value in os.environ.items() if not key.startswith("FATHOM_")}
    done = subprocess.run([binary, "render", f"jobs/{name}.json", "--out", str(out), "--slots", "1", "--styles", "styles"],
                          cwd=work, env=environment, capture_output=True, text=True)
    if done.returncode == 2:
        return {"job": "refused: " + " ".join(done.stderr.split())}
    if done.returncode not in (0, 1):
        raise SystemExit(f"{name}: exit status {done.returncode}\n{done.stderr}")
    rows = {line["frame"]: f"error: {line['error']}" for line in map(json.loads, (out / "errors.jsonl").read_text().splitlines())}
    images = {json.loads(line)["frame"]: read_frame(line, out) for line in (out / "records.jsonl").read_text().splitlines()}
    rows |= {number: " ".join([row[0][:16], *row[1:]]) for number, row in images.items()}
    whole = digest(b"fathom-job-v1" + "".join(images[number][0] for number in sorted(images)).encode())
    assert f"digest {whole}" in done.stdout.splitlines(), f"{name}: the digest of the job is not that of its frames"
    return {"job": digest((out / "job.json").read_bytes())[:16]} | {number: rows[number] for number in sorted(rows)}


def render_all(binary, jobs, work):
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        running = {name: pool.submit(render, binary, name, job, work) for name, job in jobs.items()}
        return {name: task.result() for name, task in running.items()}


def cpu_features(work):
    """The CPU features of this machine, as the binary names them in a record."""
    for records in sorted(pathlib.Path(work, "out").glob("*/records.jsonl")):
        for line in records.read_text().splitlines():
            return json.loads(line)["provenance"]["cpu_features"]
    return ""
