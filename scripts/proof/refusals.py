"""Descriptions that must be refused, and the command line's options: what a user is told."""

import json
import re
import subprocess

GOOD = {"scene": {"kind": "procedural", "family": "structure", "seed": 1}, "camera": {"width": 16, "height": 12}}
WRONG = {
    "empty": {}, "no-scene": {"count": 2}, "unknown-field": GOOD | {"cuont": 3, "alpha": 1.2},
    "kinds": GOOD | {"count": "3", "seed": -1, "dataset": "A b", "alpha": None, "labels": [], "lights": {}},
    "limits": GOOD | {"count": 0, "alpha": -0.1, "fidelity": {"tolerance": 2}, "camera": {"width": 0, "height": 16385, "hfov_deg": 0.5}},
    "too-many-pixels": GOOD | {"camera": {"width": 16384, "height": 16384}},
    "family": GOOD | {"scene": {"kind": "procedural", "family": "structur"}}, "scene-kind": GOOD | {"scene": {"kind": "procedura"}},
    "scene-seed": GOOD | {"scene": {"kind": "procedural", "family": "shaft", "seed": 9007199254740993}},
    "range-twice": GOOD | {"scene": {"kind": "files", "rgb": "a.png", "range": "b.png", "z_depth": "c.png"}},
    "unit-alone": GOOD | {"scene": {"kind": "files", "rgb": "a.png", "unit_m": 0}},
    "uploaded": GOOD | {"scene": {"kind": "uploaded", "id": "x"}},
    "preset": GOOD | {"water": {"optics": "jerlov-3X"}}, "unrenderable": GOOD | {"water": {"optics": "kd-I/jerlov1976"}},
    "water-limits": GOOD | {"water": {"optics": {"beam_attenuation_per_m": [-1, 1001, 0], "veiling_light": [1e9, -1, 0]}, "range_scale": 0, "depth_m": 12001}},
    "veil-gain": GOOD | {"water": {"optics": {"preset": "jerlov-3C", "veil_gain": 1001, "backscatter_fraction": 0.6}}},
    "inconsistent": GOOD | {"water": {"optics": {"absorption_per_m": [0.1, 0.1, 0.1], "scattering_per_m": [0.1, 0.1, 0.1], "beam_attenuation_per_m": [1, 1, 1], "veiling_light": [0, 0, 0]}}},
    "g-above-c": GOOD | {"water": {"optics": {"preset": "jerlov-IB", "forward_scatter": {"g_per_m": [1, 0.1, 0.1]}}}},
    "missing-veil": GOOD | {"water": {"optics": {"beam_attenuation_per_m": [1, 1, 1]}}}, "missing-c": GOOD | {"water": {"optics": {"absorption_per_m": [1, 1, 1]}}},
    "spread": GOOD | {"water": {"optics": {"preset": "jerlov-IB", "forward_scatter": {"spread_px_per_m": [100001, -1, 0], "model": "jafe"}}}},
    "holes": GOOD | {"water": {"optics": "jerlov-IB", "holes": {"range_m": 0}}}, "holes-far": GOOD | {"water": {"optics": "jerlov-IB", "holes": {"range_m": 100001}}},
    "words": GOOD | {"daylight": "dawn", "water": {"ambient": "x", "holes": "y", "style": "z"}, "scene": GOOD["scene"] | {"lighting": "baked"}},
    "sky": GOOD | {"daylight": {"sun_elevation_deg": 0, "cloud_cover": 2, "wind_m_per_s": -1}},
    "sky-and-veil": GOOD | {"daylight": {"cloud_cover": 1}, "water": {"optics": {"preset": "jerlov-3C", "veil_gain": 1}}},
    "black": GOOD | {"daylight": "none", "water": {"optics": "jerlov-3C"}},
    "snow": GOOD | {"water": {"snow": {"density_per_m3": -1, "radius_m": 1, "spectrum": 9, "near_m": 0, "far_m": 101, "albedo": [2, 0]}}},
    "snow-order": GOOD | {"water": {"snow": {"density_per_m3": 1, "near_m": 3, "far_m": 2}}}, "snow-cover": GOOD | {"water": {"snow": {"density_per_m3": 1000000}}},
    "snow-mask": GOOD | {"artifacts": ["snow_mask"]}, "turbidity": GOOD | {"water": {"turbidity": {"contrast": 1, "scale_m": 0}}},
    "haze": GOOD | {"lights": [{"kind": "haze", "x": 101, "y": "a", "intensity": 2, "color": [1001, 0, 0], "blend": "x", "space": "y"}]},
    "haze-spaces": GOOD | {"lights": [{"kind": "haze", "x": 0, "y": 0, "space": "linear"}, {"kind": "haze", "x": 0, "y": 0, "space": "display"}]},
    "lamp": GOOD | {"lights": [{"kind": "point", "position_m": [0, 0], "intensity": [1e7, 0, 0]}, {"kind": "spot", "position_m": [0, 0, 1001], "intensity": [1, 1, 1], "direction": [0, 0, 0], "cone_deg": 91}]},
    "lamp-kind": GOOD | {"lights": [{"kind": "lamp"}]}, "lamp-no-scatter": GOOD | {"water": {"optics": "uuv-simulator"}, "lights": [{"kind": "point", "position_m": [0, 0, 0], "intensity": [1, 1, 1]}]},
    "names": GOOD | {"enhance": ["hscn", "hscm", "hscm"], "metrics": ["uiqn", "uiqm@tabel1"], "artifacts": ["rbg", "enhanced.hscm", "hscm_mask", "enhanced.hscm.mask"]},
    "fidelity": GOOD | {"fidelity": {"tolerance": 1e-4, "terms": 3}}, "fidelity-terms": GOOD | {"fidelity": {"terms": 65}}, "fidelity-word": GOOD | {"fidelity": "referenz"},
    "encode": GOOD | {"encode": {"format": "gif"}}, "quality": GOOD | {"encode": {"format": "png", "quality": 3}}, "jpeg": GOOD | {"encode": {"format": "jpeg", "quality": 101}},
    "labels": GOOD | {"labels": {"a b": 1, "list": [1], "long": "x" * 257}},
    "path": GOOD | {"camera": {"path": {"frames": 0, "sway_m": 2, "sway_deg": 29, "sway_frames": 1, "start": {"position_m": [0, 0, 0]}}}},
    "path-frame": GOOD | {"camera": {"path": {"frames": 3, "frame": 3}}},
    "laws": GOOD | {"alpha": {"uniform": [1, 0]}, "seed": {"int": [0, 1]}, "count": {"grid": [1]}, "labels": {"x": {"normal": [0, 1]}}, "camera": {"hfov_deg": {"choice": [], "weights": []}}},
    "law-limits": GOOD | {"alpha": {"uniform": [0, 2]}, "camera": {"width": {"uniform": [1, 2]}, "hfov_deg": {"log_uniform": [0, 20]}}},
    "too-many-frames": GOOD | {"count": 100000000, "alpha": {"grid": [0, 1]}},
}


def refusals(binary, work):
    """What is said of every wrong description, a line for each error."""
    told = {}
    for name, job in WRONG.items():
        (work / "wrong.json").write_text(json.dumps(job))
        done = subprocess.run([binary, "render", "wrong.json", "--out", "wrong"], cwd=work, capture_output=True, text=True)
        assert not (work / "wrong").exists(), f"{name} is rendered"
        told[name] = [f"exit status {done.returncode}"] + done.stderr.strip().splitlines()[1:]
    return told


def options(binary, command=()):
    """Every command with its options, as its help lists them."""
    text = subprocess.run([binary, *command, "--help"], capture_output=True, text=True, check=True).stdout
    section = lambda name: "".join(re.findall(rf"^{name}:\n((?:(?: .*)?\n)*)", text, re.M))
    found = {" ".join(command): sorted(set(re.findall(r"^ +(?:-\w, )?(--[\w-]+)", section("Options"), re.M)))}
    for name in re.findall(r"^  ([\w-]+)", section("(?:[\\w ]+ c|C)ommands"), re.M):
        if name != "help":
            found |= options(binary, (*command, name))
    return found


def outputs(binary, work):
    """What commands without a service print and write."""
    run = lambda *words: subprocess.run([binary, *words], cwd=work, capture_output=True, text=True, check=True).stdout
    told = {"waters": json.loads(run("waters", "--json"))}
    told["measure"] = [json.loads(line) for profile in ("panetta", "funie", "table1")
                       for line in run("measure", "inputs/rgb8.png", "--profile", profile, "--clean", "inputs/rgb8.png", "--json").splitlines()]
    return told
