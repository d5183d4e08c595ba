"""Makes and checks the reference data of tests/proof; see scripts/proof.sh."""

import argparse
import gzip
import json
import os
import pathlib
import shutil
import sys
import tempfile

import catalogue
import compare
import frames
import inputs
import refusals
from cases import cases
from service import serve

ROOT = pathlib.Path(__file__).resolve().parents[2]
KEPT = ROOT / "tests" / "proof"
RUNTIME = ROOT / ".onnxruntime" / "libonnxruntime.so"
PARTS = ["frames", "openapi", "catalogue", "words"]
# Without these two, loops take another form and the last bits differ; the glibc of another machine may do the same.
NEEDED_FEATURES = {"avx2", "fma"}


def write_json(path, value):
    path.write_text(json.dumps(value, indent=1, sort_keys=True, ensure_ascii=False) + "\n")


def write_packed(path, value):
    path.write_bytes(gzip.compress(json.dumps(value, sort_keys=True, separators=(",", ":")).encode(), 9, mtime=0))


def read_packed(path):
    return json.loads(gzip.decompress(path.read_bytes()))


def rendered(binary, work, known):
    jobs = cases()
    if not RUNTIME.is_file():
        print("SKIPPED: the cases onnx-*: ONNX Runtime is missing (scripts/get-onnxruntime.sh fetches it)")
        jobs = {name: job for name, job in jobs.items() if not name.startswith("onnx-")}
    return frames.render_all(binary, jobs, work, known)


def rows(found):
    """The lines of frames.txt by (case, frame)."""
    for name in sorted(found):
        for key, frame in sorted(found[name].items(), key=lambda item: (isinstance(item[0], int), item[0])):
            yield (name, str(key)), frame if isinstance(frame, str) else frame[:-1]


def make_frames(binary, work):
    found = rendered(binary, work, {})
    lines = [f"# {len(found)} cases on {frames.cpu_features(work)}: case, frame, {', '.join(frames.COLUMNS)}"]
    for (name, key), row in rows(found):
        lines.append(f"{name} {key} {row if isinstance(row, str) and key == 'job' else 'error: ' + row if isinstance(row, str) else ' '.join(row)}")
    (KEPT / "frames.txt").write_text("\n".join(lines) + "\n")
    details = {name: {str(key): frame.details for key, frame in case.items() if not isinstance(frame, str)} for name, case in found.items()}
    write_packed(KEPT / "frames.json.gz", details)


def check_frames(binary, work, report):
    old = {}
    for line in (KEPT / "frames.txt").read_text().splitlines()[1:]:
        name, key, row = line.split(" ", 2)
        old[name, key] = row.removeprefix("error: ") if key == "job" or row.startswith("error: ") else tuple(row.split())
    details = read_packed(KEPT / "frames.json.gz")
    known = {digest: frame["pixels"][kind] for case in details.values() for frame in case.values() for kind, digest in frame["files"].items()}
    found = rendered(binary, work, known)
    if not NEEDED_FEATURES <= set(frames.cpu_features(work).split(",")):
        print(f"SKIPPED: frames: they are compared only on machines with {' and '.join(sorted(NEEDED_FEATURES))}")
        return
    new = dict(rows(found))
    for place in sorted(old.keys() | new.keys()):
        if place not in new and place[0] in found or place not in old:
            report.add("frames", "/".join(place), "gone" if place not in new else "new", "")
        elif place in new and new[place] != old[place]:
            tell_frame(report, place, old[place], new[place], details, found)


def tell_frame(report, place, old, new, details, found):
    name, key = place
    if isinstance(old, str) or isinstance(new, str):
        return report.add("frames", f"{name}/{key}", "text", f"{old} -> {new}")
    for column, before, after in zip(frames.COLUMNS, old, new):
        if before != after:
            there = compare.differences(details[name][key].get(column), found[name][int(key)].details.get(column)) if column != "frame" else []
            first = [f"{path} {kind}: {compare.shown(was)} -> {compare.shown(now)}" for path, kind, was, now in there][:3]
            report.add("frames", f"{name}/{key}", column, "; ".join(first))


def document(binary, work):
    with serve(binary, work / "empty", work, 0) as service:
        return service.json("/openapi.json")


def make_openapi(binary, work):
    write_json(KEPT / "openapi.json", document(binary, work))


def tell(report, area, old, new):
    for path, kind, before, after in compare.differences(old, new):
        report.add(area, path, kind, f"{compare.shown(before)} -> {compare.shown(after)}")


def check_openapi(binary, work, report):
    tell(report, "openapi", json.loads((KEPT / "openapi.json").read_text()), document(binary, work))


def make_catalogue(binary, work):
    open_jobs = catalogue.fill(binary, work / "data", work)
    catalogue.pack(work / "data", KEPT / "data.tar.gz")
    with serve(binary, work / "data", work, 0) as service:
        answers = catalogue.answers(service, list(catalogue.questions(service)))
    images = [path.split("/")[3:] for path in answers if path.startswith("/v1/images/job_") and path.endswith(("/0", "/1"))]
    later = catalogue.goes_on(binary, work / "data", work, open_jobs, images)
    write_packed(KEPT / "answers.json.gz", {"answers": answers, "open": open_jobs, "images": images, "later": later})


def check_catalogue(binary, work, report):
    kept = read_packed(KEPT / "answers.json.gz")
    data = catalogue.unpack(KEPT / "data.tar.gz", work / "old")
    with serve(binary, data, work, 0) as service:
        for path, old in kept["answers"].items():
            tell_answer(report, path, old, catalogue.answer(service, path))
    tell(report, "later", kept["later"], catalogue.goes_on(binary, data, work, kept["open"], kept["images"]))


def tell_answer(report, path, old, new):
    for below, kind, before, after in compare.differences(old, new):
        report.add("answers", f"{path} {below}", kind, f"{compare.shown(before)} -> {compare.shown(after)}")


def words(binary, work):
    return {"refusals": refusals.refusals(binary, work), "options": refusals.options(binary), "outputs": refusals.outputs(binary, work)}


def make_words(binary, work):
    write_json(KEPT / "words.json", words(binary, work))


def check_words(binary, work, report):
    """Errors must name the same places; their words may change. Options may move to the laboratory's binary."""
    old, new = json.loads((KEPT / "words.json").read_text()), words(binary, work)
    tell(report, "outputs", old["outputs"], new["outputs"])
    tell(report, "refusals", *({name: refusals.pointers(lines) for name, lines in each["refusals"].items()} for each in (old, new)))
    laboratory = pathlib.Path(binary).with_name("fathom-lab")
    if not laboratory.is_file():
        print("SKIPPED: options: fathom-lab is not built beside this binary")
        return report.leave_out("options")
    also = refusals.options(str(laboratory))
    known = {command: sorted({*new["options"].get(command, []), *also.get(command, [])}) for command in new["options"].keys() | also.keys()}
    tell(report, "options", old["options"], {command: known[command] for command in known if command in old["options"]})


def main():
    parser = argparse.ArgumentParser(prog="scripts/proof.sh")
    parser.add_argument("--make", action="store_true", help="write the reference data anew, with this binary")
    parser.add_argument("--check", action="store_true", help="compare this binary with the reference data")
    parser.add_argument("--all", action="store_true", help="print every unexpected difference")
    parser.add_argument("parts", nargs="*", help=f"of {', '.join(PARTS)}; without any: all")
    wanted = parser.parse_args()
    parts = wanted.parts or PARTS
    if wanted.make == wanted.check or not set(parts) <= set(PARTS):
        parser.error(f"give --make or --check, and parts of {', '.join(PARTS)}")
    target = os.environ.get("CARGO_TARGET_DIR", str(ROOT / "target"))
    binary = os.path.abspath(os.environ.get("FATHOM", f"{target}/release/fathom"))
    if wanted.all:
        compare.MOST_SHOWN = 10**9
    with tempfile.TemporaryDirectory(prefix="fathom-proof-") as folder:
        return run(binary, prepared(pathlib.Path(folder)), parts, wanted.make)


def prepared(work):
    inputs.write(work / "inputs", KEPT / "inputs")
    shutil.copytree(KEPT / "styles", work / "styles")
    inputs.foreign_styles(work / "styles")
    if RUNTIME.is_file():
        os.symlink(RUNTIME.parent, work / ".onnxruntime")
    return work


def run(binary, work, parts, is_making):
    report = compare.Report(KEPT / "expected.txt")
    report.keep_areas(parts)
    for part in parts:
        step = globals()[f"{'make' if is_making else 'check'}_{part}"]
        step(binary, work) if is_making else step(binary, work, report)
        print(f"{part}: {'made' if is_making else 'compared'}", flush=True)
    return 0 if is_making else report.end()


if __name__ == "__main__":
    sys.exit(main())
