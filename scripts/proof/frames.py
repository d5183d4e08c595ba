"""Renders every case with a binary and reads what it says of each frame."""

import collections
import concurrent.futures
import hashlib
import json
import os
import pathlib
import struct
import subprocess
import zlib

# What one column of frames.txt covers, so that a difference says what changed.
COLUMNS = ["frame", "files", "pixels", "parameters", "optics", "plan", "measured", "rest"]
Frame = collections.namedtuple("Frame", COLUMNS + ["details"])


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


def frame(line, folder, known):
    """A frame from its record and its files. `known` holds the pixels of files by the digest of their bytes."""
    record = json.loads(line)
    parameters = member_text(line, "parameters")
    files = {entry["kind"]: entry for entry in record["artifacts"]}
    stored = {path.stem: path.read_bytes() for path in pathlib.Path(folder, str(record["frame"])).iterdir()}
    assert {kind: digest(data) for kind, data in stored.items()} == {kind: entry["digest"] for kind, entry in files.items()}
    rest = {key: record.get(key) for key in ("counts", "warnings", "scene")} | {"inputs": record["provenance"]["inputs"]}
    rest["artifacts"] = {kind: [entry["bytes"], entry["media_type"]] for kind, entry in files.items()}
    rest["timings"] = sorted(record["timings_ms"])
    kinds = sorted(stored)
    details = {"parameters": record["parameters"], "optics": record["optics"], "plan": record["plan"], "measured": record["measurements"], "rest": rest,
               "files": {kind: files[kind]["digest"] for kind in kinds}}
    details["pixels"] = {kind: known.get(files[kind]["digest"]) or digest(pixels(stored[kind])) for kind in kinds}
    short = {column: digest(canonical(details[column]))[:16] for column in COLUMNS[1:]}
    return Frame(frame=product_digest(record, parameters), details=details, **short)


def render(binary, name, job, work, known):
    """The frames of a case: a `Frame`, or the text of an error, by number; and the digest of the canonical job, or why it is
    refused, as `job`."""
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
    frames = {"job": digest((out / "job.json").read_bytes())}
    for line in (out / "records.jsonl").read_text().splitlines():
        frames[json.loads(line)["frame"]] = frame(line, out, known)
    for line in (out / "errors.jsonl").read_text().splitlines():
        failure = json.loads(line)
        frames[failure["frame"]] = failure["error"]
    images = [frames[key].frame for key in sorted(key for key in frames if key != "job") if isinstance(frames[key], Frame)]
    whole = digest(b"fathom-job-v1" + "".join(images).encode())
    assert f"digest {whole}" in done.stdout.splitlines(), f"{name}: the digest of the job is not that of its frames"
    return frames


def render_all(binary, jobs, work, known):
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        running = {name: pool.submit(render, binary, name, job, work, known) for name, job in jobs.items()}
        return {name: task.result() for name, task in running.items()}


def cpu_features(work):
    """The CPU features of this machine, as the binary names them in a record."""
    for records in sorted(pathlib.Path(work, "out").glob("*/records.jsonl")):
        for line in records.read_text().splitlines():
            return json.loads(line)["provenance"]["cpu_features"]
    return ""
