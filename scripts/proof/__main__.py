"""Makes and checks the reference data of tests/proof; see scripts/proof.sh."""

import argparse
import json
import os
import pathlib
import shutil
import sys
import tempfile

import frames
import inputs
import refusals
from cases import cases
from service import serve

ROOT = pathlib.Path(__file__).resolve().parents[2]
KEPT = ROOT / "tests" / "proof"
MOST_SHOWN = 30
# Without these two, loops are compiled differently and the last bits differ.
NEEDED_FEATURES = {"avx2", "fma"}


def rendered(binary, work):
    """The rows of frames.txt by case and frame."""
    found = frames.render_all(binary, cases(), work)
    return {f"{name} {key}": row for name, rows in found.items() for key, row in rows.items()}


def make_frames(binary, work):
    rows = rendered(binary, work)
    head = f"# {len(rows)} lines on {frames.cpu_features(work)}: case, frame, {', '.join(frames.COLUMNS)}"
    (KEPT / "frames.txt").write_text("\n".join([head, *(f"{place} {row}" for place, row in rows.items())]) + "\n")


def check_frames(binary, work):
    lines = (line.split(" ", 2) for line in (KEPT / "frames.txt").read_text().splitlines()[1:])
    kept = {f"{name} {key}": row for name, key, row in lines}
    found = rendered(binary, work)
    if not NEEDED_FEATURES <= set(frames.cpu_features(work).split(",")):
        print(f"SKIPPED: frames: they are compared only on machines with {' and '.join(sorted(NEEDED_FEATURES))}")
        return
    for place in sorted(kept.keys() | found.keys()):
        before, after = kept.get(place, "nothing"), found.get(place, "nothing")
        if before != after:
            yield f"frame {place}: {frames.changed(before, after)}"


def document(binary, work):
    with serve(binary, work / "empty", work, 0) as service:
        return service.json("/openapi.json")


def words(binary, work):
    return {"refusals": refusals.refusals(binary, work), "options": refusals.options(binary), "outputs": refusals.outputs(binary, work)}


SNAPSHOTS = {"openapi": document, "words": words}


def make_snapshot(part, binary, work):
    (KEPT / f"{part}.json").write_text(lines_of(SNAPSHOTS[part](binary, work)) + "\n")


def lines_of(value, levels=3):
    """JSON with its upper levels on lines of their own, so that a change shows in few lines."""
    if levels == 0 or not isinstance(value, dict):
        return json.dumps(value, sort_keys=True, ensure_ascii=False, separators=(",", ":"))
    members = (f"{json.dumps(key)}: {lines_of(value[key], levels - 1)}" for key in sorted(value))
    return "{\n" + ",\n".join(members) + "\n}"


def check_snapshot(part, binary, work):
    kept = json.loads((KEPT / f"{part}.json").read_text())
    for path, before, after in differences(kept, SNAPSHOTS[part](binary, work)):
        yield f"{part} {path}: {shown(before)} -> {shown(after)}"


def differences(old, new, path=""):
    """Places at which two JSON values differ, with both values; `None` is absent."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in sorted(old.keys() | new.keys()):
            yield from differences(old.get(key), new.get(key), f"{path}/{key}")
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for index, (before, after) in enumerate(zip(old, new)):
            yield from differences(before, after, f"{path}/{index}")
    elif old != new or type(old) is not type(new):
        yield path, old, new


def shown(value):
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 90 else text[:87] + "…"


def main():
    parts = ["frames", *SNAPSHOTS]
    parser = argparse.ArgumentParser(prog="scripts/proof.sh")
    parser.add_argument("--make", action="store_true", help="write the reference data again, with this binary")
    parser.add_argument("--check", action="store_true", help="compare this binary with the reference data")
    parser.add_argument("parts", nargs="*", help=f"of {', '.join(parts)}; without any: all")
    wanted = parser.parse_args()
    chosen = wanted.parts or parts
    if wanted.make == wanted.check or not set(chosen) <= set(parts):
        parser.error(f"give --make or --check, and parts of {', '.join(parts)}")
    target = os.environ.get("CARGO_TARGET_DIR", str(ROOT / "target"))
    binary = os.path.abspath(os.environ.get("FATHOM", f"{target}/release/fathom"))
    with tempfile.TemporaryDirectory(prefix="fathom-proof-") as folder:
        work = pathlib.Path(folder)
        inputs.write(work / "inputs", KEPT / "inputs")
        shutil.copytree(KEPT / "styles", work / "styles")
        return make(binary, work, chosen) if wanted.make else check(binary, work, chosen)


def make(binary, work, parts):
    for part in parts:
        make_frames(binary, work) if part == "frames" else make_snapshot(part, binary, work)
        print(f"{part}: made", flush=True)
    return 0


def check(binary, work, parts):
    count = 0
    for part in parts:
        found = list(check_frames(binary, work) if part == "frames" else check_snapshot(part, binary, work))
        count += len(found)
        print(f"{part}: {len(found)} differences", *found[:MOST_SHOWN], sep="\n  ", flush=True)
    if count:
        print("after a wanted change: scripts/proof.sh --make, and explain the change in the commit")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
