"""Measures jobs of a service beside renders into a folder; see measure-service.sh."""

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

FATHOM = os.environ["FATHOM"]
JOB = json.loads(Path("examples/tour.json").read_text()) | {"count": 60}
SERVER = "http://127.0.0.1:7399"
TICKS = os.sysconf("SC_CLK_TCK")


def cpu_s(pid):
    """CPU seconds of a process, of its ended children and of those that still run."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    children = [child for task in Path(f"/proc/{pid}/task").iterdir() for child in (task / "children").read_text().split()]
    return sum(map(int, fields[11:15])) / TICKS + sum(cpu_s(int(child)) for child in children)


def own_children_cpu_s():
    """CPU seconds of the children of this process that have ended."""
    times = os.times()
    return times.children_user + times.children_system


def render(job, folder):
    """Wall and CPU seconds of a render into a folder."""
    begun, before = time.perf_counter(), own_children_cpu_s()
    command = [FATHOM, "render", job, "--out", folder / "out", "--slots", "1"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return time.perf_counter() - begun, own_children_cpu_s() - before


def serve(job, folder):
    """Wall and CPU seconds of the same frames as a job of a running service with one slot: its processes and the command that submits."""
    command = [FATHOM, "serve", "--data", folder / "data", "--listen", SERVER.removeprefix("http://"), "--workers", "1", "--slots", "1"]
    service = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        time.sleep(2)
        begun, before = time.perf_counter(), cpu_s(service.pid) + own_children_cpu_s()
        command = [FATHOM, "submit", job, "--wait", "--server", SERVER]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        return time.perf_counter() - begun, cpu_s(service.pid) + own_children_cpu_s() - before
    finally:
        service.terminate()
        service.wait()


def measure(count):
    """Wall and CPU seconds of each way, a pair of each in every row. Each way goes first as often as the other."""
    rows = []
    for number in range(count):
        with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as two:
            job = Path(one) / "job.json"
            job.write_text(json.dumps(JOB))
            ways = [lambda: render(job, Path(one)), lambda: serve(job, Path(two))]
            times = [way() for way in ways[:: 1 if number % 2 else -1]]
            rows.append(times[:: 1 if number % 2 else -1])
            print("pair", *(f"{wall:.2f}" for wall, _ in rows[-1]), "s", file=sys.stderr)
    return rows


def main():
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    rows, camera = measure(int(sys.argv[1])), JOB["camera"]
    print(f"| {camera['width']} × {camera['height']}, {JOB['count']} frames, {len(rows)} pairs | folder | service | median of the pairs |")
    print("|---|---|---|---|")
    for which, name in enumerate(["wall time", "CPU time"]):
        folder, service = ([1000 * pair[way][which] / JOB["count"] for pair in rows] for way in (0, 1))
        more = statistics.median(100 * (after / before - 1) for before, after in zip(folder, service))
        print(f"| {name} of a frame | {statistics.median(folder):.2f} ms | {statistics.median(service):.2f} ms | {more:+.1f} % |")


main()
