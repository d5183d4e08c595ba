"""Measures what depends on the number of shards of a set: its status, planning what is missing, and finding what is new of it.

The set is one of 10^8 frames in a folder. One shard of it is rendered; the others have markers that name empty files.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

FRAMES_PER_SHARD = 714
FRAMES = 100_000_000


def job(frames):
    """A job of the smallest frames."""
    return {
        "dataset": "markers",
        "count": frames,
        "scene": {"kind": "procedural", "family": "structure", "seed": 1},
        "camera": {"width": 8, "height": 8, "hfov_deg": 80},
        "artifacts": ["rgb"],
    }


def measured(command, given=""):
    """Seconds and peak memory of a command."""
    begun = time.monotonic()
    process = subprocess.Popen(list(map(str, command)), stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    if given:
        process.stdin.write(given)
    process.stdin.close()
    said = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        sys.exit(f"{command}: {status}")
    return time.monotonic() - begun, usage.ru_maxrss / 1024, said


def fill(folder, shards):
    """Markers for all shards but the first and the last, and the files that they name."""
    first = json.loads((folder / "done/000000.json").read_text())
    for shard in range(1, shards - 1):
        marker = first | {"shard": shard}
        (folder / f"done/{shard:06}.json").write_text(json.dumps(marker))
        for name in (f"shards/{shard:06}-{first['attempt']}.tar", f"rows/{shard:06}-{first['attempt']}.parquet"):
            (folder / name).touch()


def known(folder):
    """What a service knows that has imported every shard but the first: the time of each marker by its first frame."""
    times = {}
    for entry in os.scandir(folder / "done"):
        shard = int(entry.name.removesuffix(".json"))
        times[str(shard * FRAMES_PER_SHARD)] = entry.stat().st_mtime_ns // 1_000_000
    times.pop("0")
    return json.dumps(times) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--fathom", default="target/release/fathom")
    parser.add_argument("--shards", type=int, nargs="+", default=[1400, 14_000, 140_000])
    arguments = parser.parse_args()
    fathom = Path(arguments.fathom).resolve()
    print("| shards | status | planning | finding what is new | memory |\n|---|---|---|---|---|")
    for shards in arguments.shards:
        work = Path(tempfile.mkdtemp())
        folder = work / "set"
        (work / "job.json").write_text(json.dumps(job(min(FRAMES, shards * FRAMES_PER_SHARD))))
        render = [fathom, "render", work / "job.json", "--out", f"file://{folder}"]
        measured([*render, "--frames-per-shard", FRAMES_PER_SHARD, "--frames", f"0..{FRAMES_PER_SHARD}"])
        fill(folder, shards)
        status = measured([fathom, "status", folder, "--json"])
        assert json.loads(status[2])["done"] == shards - 1
        # The shard is done: nothing is rendered.
        planning = measured([*render, "--frames", f"0..{FRAMES_PER_SHARD}"])
        shards_of = [fathom, "child", "shards", folder, "--below", work]
        new = measured(shards_of, known(folder))
        assert new[2].count('{"part"') == 2, "the images of the first shard, in two parts"
        memory = max(found[1] for found in (status, planning, new))
        print(f"| {shards} | {status[0]:.2f} s | {planning[0]:.2f} s | {new[0]:.2f} s | {memory:.0f} MiB |", flush=True)
        shutil.rmtree(work)


main()
