"""Measures streams: the time of a call from arrays to arrays, and the part of it outside the rendering stages.

Run it with the interpreter of an environment with the wheel, on one core: `taskset -c 0 python scripts/measure_stream.py`.
An argument sets the number of measured frames of each job.
"""

import resource
import statistics
import sys
import time

import fathom

SIZE = (768, 492)
FRAMES = int(sys.argv[1]) if len(sys.argv) > 1 else 60
WARM = 8
LAMP = {"kind": "spot", "intensity": [20, 20, 20], "cone_deg": 60}
LAMPS = [
    LAMP | {"position_m": [0.7, -0.4, 0.1], "direction": [-0.2, 0.1, 1]},
    LAMP | {"position_m": [-0.7, -0.4, 0.1], "direction": [0.2, 0.1, 1]},
]
HAZE = {"kind": "haze", "x": 0.3, "y": 1, "size": 0.1, "intensity": 0.4}
WATER = {"optics": "jerlov-1C"}
LATE = "water, haze, two lamps, 50 ms"
JOBS = {
    "water": {"water": WATER},
    "water, haze": {"water": WATER, "lights": [HAZE]},
    "water, style, two hazes": {
        "water": WATER | {"style": "muddy"},
        "lights": [HAZE, HAZE | {"x": 0.7}],
    },
    "water, haze, two lamps": {"water": WATER, "lights": [*LAMPS, HAZE]},
    "water, haze, two lamps, HSCM": {
        "water": WATER,
        "lights": [*LAMPS, HAZE],
        "enhance": ["hscm"],
    },
    LATE: {"water": WATER, "lights": [*LAMPS, HAZE]},
    "no water": {},
    "HSCM alone": {"enhance": ["hscm"]},
}


def main() -> None:
    """Print one row for each job."""
    width, height = SIZE
    described = {
        "scene": {"kind": "procedural", "family": "structure", "lighting": "in_air"},
        "metrics": [],
    }
    air = fathom.render(
        described | {"camera": {"width": width, "height": height}},
        0,
        ["clean", "range"],
    )
    print(
        f"{'job':32} {'ms':>7} {'best':>7} {'CPU':>7} {'outside':>8} {'MB':>5}  largest stages, ms"
    )
    for name, job in JOBS.items():
        stream = fathom.Stream(job, deadline_ms=50 if name == LATE else None)
        meters = None if "water" not in job else air.range_m
        times, processor, outside, stages = [], [], [], {}
        for stamp in range(FRAMES + WARM):
            begun, worked = time.perf_counter(), time.process_time()
            out = stream(air.clean, range_m=meters, stamp_ns=stamp)
            elapsed, worked = (
                1e3 * (time.perf_counter() - begun),
                1e3 * (time.process_time() - worked),
            )
            if stamp < WARM:
                memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
                continue
            spent = out.record["timings_ms"]
            times.append(elapsed)
            processor.append(worked)
            # `scene` is the decoding of the arrays, which belongs to the stream.
            outside.append(elapsed - spent["total"] + spent["scene"])
            for stage, ms in spent.items():
                stages.setdefault(stage, []).append(ms)
        grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory) / 1024
        middle = {
            stage: statistics.median(ms)
            for stage, ms in stages.items()
            if stage != "total"
        }
        largest = sorted(middle.items(), key=lambda item: -item[1])[:6]
        listed = ", ".join(f"{stage} {ms:.1f}" for stage, ms in largest)
        figures = [statistics.median(times), statistics.median(processor), min(outside)]
        print(
            f"{name:32} {figures[0]:7.1f} {min(times):7.1f} {figures[1]:7.1f} {figures[2]:8.2f} {grown:5.1f}  {listed}"
        )


if __name__ == "__main__":
    main()
