"""Measures sets beside plain folders; see measure-sets.sh."""

import json
import os
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

FATHOM = os.environ["FATHOM"]
TOUR = json.loads(Path("examples/tour.json").read_text())


def render(job, folder, *options):
    """CPU seconds, seconds, and the peak memory of the process and of its children in MiB."""
    out = folder / "out"
    (folder / "job.json").write_text(json.dumps(job))
    begun = time.monotonic()
    process = subprocess.Popen(
        [FATHOM, "render", folder / "job.json", "--out", out, "--slots", "1", *options],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    peaks = {}
    watcher = threading.Thread(target=watch, args=[process, peaks])
    watcher.start()
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.monotonic() - begun
    process.returncode = os.waitstatus_to_exitcode(status)
    watcher.join()
    assert process.returncode == 0, process.args
    child = max((peak for pid, peak in peaks.items() if pid != process.pid), default=0)
    return {"cpu": usage.ru_utime + usage.ru_stime, "seconds": seconds, "own": peaks[process.pid], "child": child}


def watch(process, peaks):
    """Notes the peak memory of a process and of its children."""
    while process.returncode is None:
        try:
            children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
            for pid in [process.pid, *map(int, children)]:
                lines = Path(f"/proc/{pid}/status").read_text().splitlines()
                peaks[pid] = next(int(line.split()[1]) / 1024 for line in lines if line.startswith("VmHWM:"))
        except (OSError, StopIteration):
            # It is ending.
            pass
        time.sleep(0.02)


def size(folder):
    """Bytes and number of the files."""
    sizes = [path.stat().st_size for path in folder.rglob("*") if path.is_file()]
    return sum(sizes), len(sizes)


def pairs(job, count):
    """CPU time of a set over that of a folder, in pairs that take turns."""
    ratios, plain_cpu, set_cpu = [], [], []
    for _ in range(count):
        with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as two:
            plain = render(job, Path(one))
            shards = render(job, Path(two), "--frames-per-shard", "50")
            plain_cpu.append(plain["cpu"])
            set_cpu.append(shards["cpu"])
            ratios.append(shards["cpu"] / plain["cpu"])
            sizes = size(Path(one) / "out"), size(Path(two) / "out")
    camera = job["camera"]
    print(f"| {camera['width']} × {camera['height']}, {job['count']} frames, {count} pairs | folder | set |")
    print("|---|---|---|")
    print(f"| CPU time, median | {statistics.median(plain_cpu):.2f} s | {statistics.median(set_cpu):.2f} s |")
    overhead = [100 * (ratio - 1) for ratio in ratios]
    spread = f"{min(overhead):+.1f} to {max(overhead):+.1f}"
    print(f"| overhead in pairs | | {statistics.median(overhead):+.1f} % ({spread}) |")
    for number, name in enumerate(["bytes", "files"]):
        print(f"| {name} | {sizes[0][number]} | {sizes[1][number]} |")


def memory():
    """Peak memory with short and long shards."""
    job = TOUR | {"count": 5000, "camera": {"width": 96, "height": 64, "hfov_deg": 80}}
    print("| frames per shard | supervisor | child |\n|---|---|---|")
    for frames in (50, 500, 5000):
        with tempfile.TemporaryDirectory() as folder:
            found = render(job, Path(folder), "--frames-per-shard", str(frames))
            print(f"| {frames} | {found['own']:.0f} MiB | {found['child']:.0f} MiB |")


print(f"load before: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
pairs(TOUR, int(sys.argv[1]))
memory()
print(f"load after: {os.getloadavg()[0]:.1f}")
