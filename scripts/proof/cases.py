"""The frames of the proof: small jobs over the features of a description."""

FAMILIES = ["structure", "shaft", "pipeline"]
WIDE = {"method": "hscm", "name": "wide", "cutoff": {"uniform": [16, 64]}, "tiles": [4, 3], "mask": "paper", "metrics_over": "mask"}
CHAIN = {"name": "mine", "steps": [{"gray_world": {}}, {"clahe": {"clip": 3}}]}
METHODS = ["hscm", "clahe", "gray_world", "dcp", "udcp", "fusion", "mlle", "ulap", "suir", "ibla", "rd", "rghs"]
METRICS = ["entropy", "entropy_joint_rgb", "uicm", "uism", "uiconm", "uiqm", "uiqm@funie", "uiqm@table1", "uciqe", "light_uniformity", "psnr",
           "ssim", "ciede2000"]
LAYERS = ["rgb", "clean", "direct", "forward_scatter", "backscatter", "scattered", "hazed", "transmittance"]
LABELS = ["range", "instances", "semantics", "normals", "findings", "boxes"]
STYLE = "kept-muddy"

SPOT = {"kind": "spot", "position_m": [0.3, -0.2, 0.0], "intensity": [9, 8, 7], "direction": [-0.1, 0.05, 1], "cone_deg": 35}
POINT = {"kind": "point", "position_m": [-0.4, 0.3, 0.2], "intensity": [2.5, 3, 3.5], "radius_m": 0}
HAZE = {"kind": "haze", "x": {"uniform": [0, 1]}, "y": 0.6, "intensity": 0.5}
SNOW = {"density_per_m3": 900, "radius_m": 0.0005}
PATCHES = {"contrast": 0.6, "scale_m": 1.5}
EXPLICIT = {"absorption_per_m": [0.42, 0.2, 0.5], "scattering_per_m": [1.0, 1.1, 1.3], "diffuse_attenuation_per_m": [0.6, 0.4, 0.8]}
BEAM = {"beam_attenuation_per_m": [0.6, 0.3, 0.25], "veiling_light": [0.05, 0.2, 0.25]}
SUNNY = {"sun_elevation_deg": 50, "sun_azimuth_deg": 30, "cloud_cover": 0.1, "wind_m_per_s": 6}
OVERCAST = {"cloud_cover": 1, "wind_m_per_s": 0}


class Cases(dict):
    """Jobs by name, in the order in which they were added."""

    def add(self, name, water=None, family=None, scene=None, size=(96, 64), **fields):
        assert name not in self, name
        family = family or FAMILIES[len(self) % 3]
        scene = scene or {"kind": "procedural", "family": family, "seed": len(self)}
        # A picture has its own size.
        camera = {"width": size[0], "height": size[1]} if scene["kind"] == "procedural" else {}
        job = {"scene": scene, "camera": camera | fields.pop("camera", {}), "seed": len(self), "metrics": ["entropy"]}
        self[name] = job | ({} if water is None else {"water": water}) | fields


def cases():
    """Every case."""
    all_cases = Cases()
    for group in [scenes, waters, daylight, lamps, suspended, cameras, files, results, laws, motion]:
        group(all_cases.add)
    return dict(all_cases)


def scenes(add):
    for family in FAMILIES:
        scene = {"kind": "procedural", "family": family, "seed": {"int": [0, 1000000]}}
        add(f"scene-{family}", {"optics": "jerlov-II"}, scene=scene, count=2, artifacts=["rgb", "clean", *LABELS])
    life = {"mussels": 6, "weed": 3, "worms": 2, "fish": 0.1, "ropes": 1, "bubbles": 1}
    add("scene-life", {"optics": "jerlov-1C"},
        scene={"kind": "procedural", "family": "structure", "seed": 3, "life": life, "ground": {"grain": 0.3, "scour": 0.5}}, artifacts=["rgb", *LABELS])
    add("scene-dry", artifacts=["rgb", "range"])
    add("size-1x1", {"optics": "jerlov-1C"}, size=(1, 1), enhance=METHODS, metrics=METRICS)
    add("size-97x61", {"optics": "jerlov-3C"}, size=(97, 61))


def waters(add):
    for preset in ["jerlov-IB/williamson2022", "jerlov-5C/williamson2022", "jerlov-9C/solonenko2015", "uuv-simulator"]:
        add(f"water-{preset.replace('/', '-')}", {"optics": preset}, artifacts=LAYERS)
    optics = {
        "explicit": EXPLICIT | {"name": "quay-7"}, "beam": BEAM, "revised": BEAM | {"backscatter_attenuation_per_m": [0.9, 0.5, 0.4]},
        "veil-gain": {"preset": "jerlov-3C", "veil_gain": 0.25},
        "hg": {"preset": "jerlov-3C", "phase": "hg", "backscatter_fraction": 0.03},
        "jaffe": {"preset": "jerlov-3C", "forward_scatter": {"model": "jaffe", "g_per_m": [0.3, 0.2, 0.1], "source": "direct"}},
        "simplified": {"preset": "jerlov-3C", "forward_scatter": {"model": "simplified", "spread_px_per_m": [1.5, 1, 0.5]}},
        "sharp": {"preset": "jerlov-3C", "forward_scatter": {"model": "none"}},
    }
    for name, each in optics.items():
        scene = {"kind": "procedural", "family": "structure", "seed": 5, "lighting": "in_air"}
        add(f"optics-{name}", {"optics": each, "range_scale": 0.7}, scene=scene, artifacts=LAYERS)
    add("holes", {"optics": {"preset": "jerlov-II", "veil_gain": 1}, "holes": {"range_m": 6.5}}, artifacts=["rgb", "transmittance"])
    add("holes-reject", {"optics": {"preset": "jerlov-II", "veil_gain": 1}, "holes": "reject"}, "structure")


def daylight(add):
    for name, sky in [("sunny", SUNNY), ("overcast", OVERCAST)]:
        add(f"daylight-{name}", {"optics": "jerlov-1C", "depth_m": 4}, "structure", daylight=sky, artifacts=LAYERS)
    scene = {"kind": "procedural", "family": "pipeline", "seed": 5, "lighting": "in_air"}
    add("daylight-in-air", {"optics": "jerlov-1C", "depth_m": 9}, scene=scene, daylight=SUNNY, artifacts=LAYERS)
    add("daylight-lamps", {"optics": "jerlov-3C", "depth_m": 6}, daylight=OVERCAST, lights=[SPOT])


def lamps(add):
    for family in FAMILIES:
        add(f"night-{family}", {"optics": "jerlov-3C"}, family, lights=[POINT, SPOT], artifacts=["rgb", "direct", "backscatter"])
    add("night-soft", {"optics": "jerlov-II"}, "structure", lights=[SPOT | {"radius_m": 0.1}], daylight="none")
    add("night-dry", lights=[POINT, SPOT])
    add("night-reference", {"optics": "jerlov-3C", "snow": SNOW, "turbidity": PATCHES}, lights=[SPOT], fidelity="reference", size=(24, 16))
    add("haze", {"optics": "jerlov-II"}, lights=[HAZE, HAZE | {"blend": "add", "color": [0.3, 0.2, 0.1]}], artifacts=["rgb", "hazed"], count=2)


def suspended(add):
    masks = ["rgb", "snow_mask", "scattered"]
    add("snow", {"optics": "jerlov-1C", "snow": SNOW | {"aggregates": 0.3, "spectrum": 3}}, artifacts=masks)
    add("snow-lamps", {"optics": "jerlov-3C", "snow": SNOW | {"drift_m_per_s": [0.5, 0, 0]}}, lights=[POINT, SPOT], artifacts=masks)
    add("turbidity", {"optics": "jerlov-3C", "turbidity": PATCHES}, artifacts=["rgb", "transmittance"])
    add("sediment", {"optics": "jerlov-1C", "sediment": {"cover": 0.6, "thrusters": 1}}, "pipeline", artifacts=masks)


def cameras(add):
    lens = {"distortion": {"k1": -0.1}, "port": {"kind": "flat"}, "vignette": {}, "defocus": {"aperture_m": 0.01, "focus_m": 2.0}}
    sensor = {"sensor": {"preset": "machine-vision-1/1.8", "light_level": 0.1}, "exposure": {"auto": {}}, "white_balance": "gray_world"}
    add("camera-lens", {"optics": "jerlov-IB"}, camera=lens, artifacts=["rgb", *LABELS])
    add("camera-sensor", {"optics": "jerlov-1C"}, camera=sensor | {"jpeg": {"quality": 80}}, artifacts=["rgb", "raw"], count=2)
    add("camera-deep", {"optics": "jerlov-1C"}, camera={"bits": 16, "tone": "linear", "exposure": {"fixed": 3}})
    add("path", {"optics": "jerlov-1C", "snow": SNOW}, "pipeline", count=3, artifacts=["rgb", "snow_mask", "boxes"],
        camera={"path": {"frames": 3, "sway_m": 0.05, "sway_deg": 2, "sway_frames": 7.5}, "exposure_s": 0.04})


def files(add):
    def scene(rgb, **more):
        return {"kind": "files", "rgb": f"inputs/{rgb}"} | more

    coded = {"range": "inputs/range16.png", "unit_m": 0.001, "invalid_code": 65535}
    add("files-air", scene=scene("lossy.webp"), artifacts=["rgb", "clean"])
    add("files-water", {"optics": "jerlov-1C", "range_scale": 0.5}, scene=scene("rgb8.png", **coded), artifacts=LAYERS)
    add("files-lit", {"optics": "jerlov-1C"}, scene=scene("photo.jpg", z_depth="inputs/range.npy", lighting="water"), lights=[SPOT], artifacts=LAYERS)
    add("files-missing", {"optics": "jerlov-1C"}, scene=scene("missing.png", **coded))


def results(add):
    every = [f"enhanced.{method}" for method in METHODS] + ["enhanced.hscm.mask"]
    add("enhance", {"optics": "jerlov-1C"}, enhance=METHODS, artifacts=["rgb", *every], metrics=METRICS, size=(160, 120))
    add("style", {"optics": "jerlov-II", "style": STYLE}, alpha=0.35, artifacts=["rgb", "styled"])
    add("style-loose", {"style": STYLE}, fidelity={"tolerance": 1})
    add("jpeg", {"optics": "jerlov-II"}, encode={"format": "jpeg", "quality": 80})
    for name, fidelity in [("tight", {"tolerance": 1e-6}), ("loose", {"tolerance": 0.01}), ("terms", {"terms": 3}), ("reference", "reference")]:
        add(f"fidelity-{name}", {"optics": "jerlov-3C"}, size=(40, 26), fidelity=fidelity, artifacts=LAYERS)
    add("truth", {"optics": "jerlov-1C"}, lights=[SPOT], size=(12, 8), truth={"paths_max": 32}, artifacts=["truth", "truth_report"])


def laws(add):
    scene = {"kind": "procedural", "family": {"choice": FAMILIES, "weights": [1, 2, 0.5]}, "seed": {"int": [0, 1000000]}}
    water = {"optics": {"choice": ["jerlov-IB", EXPLICIT]}, "range_scale": {"log_uniform": [0.2, 2]}, "depth_m": {"uniform": [2, 9]}}
    sky = {"choice": ["none", {"sun_elevation_deg": {"uniform": [20, 80]}, "cloud_cover": {"normal": [0.5, 0.3], "clip": [0, 1]}}]}
    add("laws", water, scene=scene, daylight=sky, lights=[SPOT], count=6, labels={"run": "a", "number": {"uniform": [0, 1]}})
    add("grid", {"optics": {"grid": ["jerlov-IB", "jerlov-1C"]}, "range_scale": {"grid": [0.5, 1]}}, size=(48, 32))


def motion(add):
    add("enhance-chain", {"optics": "jerlov-1C"}, enhance=[CHAIN, WIDE], metrics=METRICS, size=(160, 120),
        artifacts=["enhanced.mine", "enhanced.mine.1", "enhanced.wide", "enhanced.wide.median", "enhanced.wide.mask"])
    add("path-metrics", {"optics": "jerlov-1C"}, "pipeline", count=3, artifacts=["rgb", "flow"], size=(160, 120),
        metrics=["features", "matches_correct", "track_length", "pose_error_deg", "illumination_residual"],
        enhance=["clahe", WIDE], camera={"path": {"frames": 9, "sway_m": 0.02}})
    add("stereo", {"optics": "jerlov-1C"}, camera={"stereo": {"baseline_m": 0.1}}, artifacts=["rgb", "rgb_right", "disparity"])
