"""Measures sets beside plain folders; see measure-sets.sh."""

import json
import os
import random
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
    """CPU seconds with those of children, CPU seconds of the process alone, and the peak memory of it and of its children in MiB."""
    out = folder / "out"
    (folder / "job.json").write_text(json.dumps(job))
    process = subprocess.Popen(
        [FATHOM, "render", folder / "job.json", "--out", out, "--slots", "1", *options],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    peaks = {}
    watcher = threading.Thread(target=watch, args=[process, peaks])
    watcher.start()
    # Dead, but still there to be asked: what it has used of the CPU itself, in ticks.
    os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT)
    ticks = Path(f"/proc/{process.pid}/stat").read_text().rsplit(")", 1)[1].split()[11:13]
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    watcher.join()
    assert process.returncode == 0, process.args
    child = max((peak for pid, peak in peaks.items() if pid != process.pid), default=0)
    own = sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")
    return {"cpu": usage.ru_utime + usage.ru_stime, "own": own, "memory": peaks[process.pid], "child": child}


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
    """CPU time of a set over that of a folder, in pairs that take turns, and what the process that writes the set takes of it."""
    plain_cpu, set_cpu, own = [], [], []
    for number in range(count):
        with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as two:
            ways = [(Path(one), []), (Path(two), ["--frames-per-shard", "50"])]
            # Each goes first as often as the other: a machine that is getting busier favors neither.
            turns = [render(job, folder, *options) for folder, options in ways[:: 1 if number % 2 else -1]]
            plain, shards = turns[:: 1 if number % 2 else -1]
            plain_cpu.append(plain["cpu"])
            set_cpu.append(shards["cpu"])
            own.append(shards["own"])
            sizes = size(Path(one) / "out"), size(Path(two) / "out")
    camera, frames = job["camera"], job["count"]
    print(f"| {camera['width']} × {camera['height']}, {frames} frames, {count} pairs | folder | set |")
    print("|---|---|---|")
    of_frame = [1000 * statistics.median(times) / frames for times in (plain_cpu, set_cpu, own)]
    print(f"| CPU time of a frame, median | {of_frame[0]:.2f} ms | {of_frame[1]:.2f} ms |")
    middle, error = overhead(plain_cpu, set_cpu)
    print(f"| overhead, mean of the middle half of the pairs | | {middle:+.1f} ± {error:.1f} % |")
    share = 100 * of_frame[2] / of_frame[0]
    print(f"| of it the process that writes tar, rows and marker | | {of_frame[2]:.2f} ms, {share:.1f} % |")
    for number, name in enumerate(["bytes", "files"]):
        print(f"| {name} | {sizes[0][number]} | {sizes[1][number]} |")


def overhead(plain, shards):
    """Percent by which sets take longer: the mean over the middle half of the pairs, and its standard error from pairs drawn again."""
    ratios = [100 * (one / other - 1) for one, other in zip(shards, plain)]

    def middle(found):
        found, cut = sorted(found), len(found) // 4
        return statistics.fmean(found[cut : len(found) - cut])

    chance = random.Random(1)
    drawn = [middle(chance.choices(ratios, k=len(ratios))) for _ in range(2000)]
    return middle(ratios), statistics.stdev(drawn)


def memory():
    """Peak memory with short and long shards."""
    job = TOUR | {"count": 5000, "camera": {"width": 96, "height": 64, "hfov_deg": 80}}
    print("| frames per shard | supervisor | child |\n|---|---|---|")
    for frames in (50, 500, 5000, 20000):
        job["count"] = max(5000, frames)
        with tempfile.TemporaryDirectory() as folder:
            found = render(job, Path(folder), "--frames-per-shard", str(frames))
            print(f"| {frames} | {found['memory']:.0f} MiB | {found['child']:.0f} MiB |")


print(f"load before: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
pairs(TOUR, int(sys.argv[1]))
memory()
print(f"load after: {os.getloadavg()[0]:.1f}")
