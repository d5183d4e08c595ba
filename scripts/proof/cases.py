"""The frames of the proof: small jobs over everything that a description can say."""

FAMILIES = ["structure", "shaft", "pipeline"]
PRESETS = [f"jerlov-{kind}/williamson2022" for kind in ["IB", "II", "III", "1C", "3C", "5C"]]
PRESETS += [f"jerlov-{kind}/solonenko2015" for kind in ["I", "IA", "IB", "II", "III", "1C", "3C", "7C", "9C"]]
PRESETS += ["uuv-simulator"]
BARE = [f"jerlov-{kind}" for kind in ["I", "IA", "IB", "II", "III", "1C", "3C", "5C", "7C", "9C"]]
METHODS = ["hscm", "clahe", "grey_world", "ulap", "suir", "ibla", "rd", "rghs"]
PROFILED = ["uicm", "uism", "uiconm", "uiqm"]
METRICS = ["entropy", "entropy_rgb_r", "entropy_rgb_g", "entropy_rgb_b", "entropy_joint_rgb", "entropy_2d"]
METRICS += [name + profile for name in PROFILED for profile in ["", "@funie", "@table1"]]
METRICS += ["uciqe", "uciqe_sigma_c", "uciqe_con_l", "uciqe_mu_s", "light_uniformity"]
METRICS += ["psnr", "ssim", "ciede2000", "corner_repeatability"]
LAYERS = ["rgb", "clean", "direct", "forward_scatter", "backscatter", "scattered", "hazed", "transmittance"]
LABELS = ["instances", "semantics", "normals", "findings", "boxes"]
STYLES = ["kept-atlantic", "kept-mediterranean", "kept-muddy"]

SPOT = {"kind": "spot", "position_m": [0.3, -0.2, 0.0], "intensity": [9, 8, 7], "direction": [-0.1, 0.05, 1], "cone_deg": 35}
POINT = {"kind": "point", "position_m": [-0.4, 0.3, 0.2], "intensity": [2.5, 3, 3.5]}
BEHIND = {"kind": "spot", "position_m": [0.0, 0.0, -0.5], "intensity": [20, 20, 20], "cone_deg": 12.5}
SNOW = {"density_per_m3": 900, "radius_m": 0.003}
PATCHES = {"contrast": 0.6, "scale_m": 1.5}
EXPLICIT = {"absorption_per_m": [0.42, 0.2, 0.5], "scattering_per_m": [1.0, 1.1, 1.3],
            "diffuse_attenuation_per_m": [0.6, 0.4, 0.8]}
BEAM = {"beam_attenuation_per_m": [0.6, 0.3, 0.25], "veiling_light": [0.05, 0.2, 0.25]}


class Cases(dict):
    """Jobs by name, in the order in which they were added."""

    def add(self, name, water=None, family=None, scene=None, size=(96, 64), hfov=80, path=None, **fields):
        assert name not in self, name
        family = family or FAMILIES[len(self) % 3]
        camera = {"width": size[0], "height": size[1], "hfov_deg": hfov}
        if path:
            camera["path"] = path
        job = {"scene": scene or {"kind": "procedural", "family": family, "seed": len(self) % 41}, "camera": camera,
               "seed": len(self), "metrics": ["entropy", "uiqm"]}
        if water is not None:
            # The reference data know no other scattering of the light of lamps.
            lamps = "position_m" in repr(fields.get("lights"))
            job["water"] = water | {"multiple": "none"} if lamps else water
        self[name] = job | fields


def cases():
    """Every case; those whose name begins with `onnx-` need ONNX Runtime."""
    all_cases = Cases()
    for group in [scenes, waters, coefficients, modes, lamps, suspended, paths, styles, files, enhancements, fidelity,
                  laws, haze, formats, together]:
        group(all_cases.add)
    return dict(all_cases)


def scenes(add):
    for family in FAMILIES:
        scene = {"kind": "procedural", "family": family, "seed": {"int": [0, 1000000]}}
        add(f"scene-{family}", scene=scene, count=6, artifacts=["rgb", "clean", "range", "preview"] + LABELS)
        add(f"scene-{family}-water", {"optics": "jerlov-II"}, scene=scene, count=2, artifacts=["rgb"] + LABELS)
    for index, size in enumerate([(1, 1), (2, 1), (1, 3), (7, 5), (97, 61), (160, 120), (64, 160)]):
        add(f"size-{size[0]}x{size[1]}", {"optics": "jerlov-1C"}, FAMILIES[index % 3], size=size,
            artifacts=["rgb", "range", "transmittance"])
    for hfov in [1, 35.5, 120, 170]:
        add(f"hfov-{hfov}", {"optics": "jerlov-IB"}, hfov=hfov, artifacts=["rgb", "range"])
    for seed in [0, 9007199254740992]:
        scene = {"kind": "procedural", "family": "structure", "seed": seed}
        add(f"scene-seed-{seed}", scene=scene, artifacts=["rgb", "range"])


def waters(add):
    for preset in PRESETS:
        add(f"water-{preset.replace('/', '-')}", {"optics": preset}, artifacts=LAYERS)
    for preset in BARE:
        add(f"water-bare-{preset}", {"optics": {"preset": preset}, "range_scale": 0.4})
    for preset in PRESETS[3:5]:
        for scale in [0.05, 2.5, 40]:
            add(f"water-scale-{preset.replace('/', '-')}-{scale}", {"optics": preset, "range_scale": scale})


def coefficients(add):
    replaced = {
        "veil-gain": {"veil_gain": 0.25}, "veil": {"veiling_light": [0.1, 0.5, 0.4]}, "bbb": {"backscatter_fraction": 0.05},
        "a": {"absorption_per_m": [0.3, 0.1, 0.2]}, "b": {"scattering_per_m": [0.1, 0.2, 0.3]},
        "kd": {"diffuse_attenuation_per_m": [0.3, 0.1, 0.2]}, "backscatter": {"backscatter_attenuation_per_m": [0.7, 0.5, 0.6]},
        "g": {"forward_scatter": {"g_per_m": [0.3, 0.2, 0.1]}},
        "spread": {"forward_scatter": {"spread_px_per_m": [2, 0.5, 0.05]}},
        "offset": {"forward_scatter": {"spread_px_per_m": [1, 1, 1], "spread_offset_px": [0, 0.5, 3]}},
        "direct": {"forward_scatter": {"source": "direct"}},
        "none": {"forward_scatter": {"model": "none"}},
        "simplified": {"forward_scatter": {"model": "simplified", "spread_px_per_m": [1.5, 1, 0.5]}},
        "simplified-offset": {"forward_scatter": {"model": "simplified", "spread_px_per_m": [0, 1, 8], "spread_offset_px": [1, 0, 2]}},
        "jaffe": {"forward_scatter": {"model": "jaffe"}},
    }
    for name, fields in replaced.items():
        add(f"optics-3C-{name}", {"optics": {"preset": "jerlov-3C"} | fields}, artifacts=LAYERS)
    add("optics-ab", {"optics": EXPLICIT}, artifacts=LAYERS)
    add("optics-named", {"optics": EXPLICIT | {"name": "quay-7"}}, artifacts=LAYERS)
    add("optics-beam", {"optics": BEAM}, artifacts=LAYERS)
    add("optics-beam-simplified", {"optics": BEAM | {"forward_scatter": {"model": "simplified", "spread_px_per_m": [1, 2, 3]}}})
    add("optics-revised", {"optics": BEAM | {"backscatter_attenuation_per_m": [0.9, 0.5, 0.4]}}, artifacts=LAYERS)
    add("optics-zero", {"optics": {"beam_attenuation_per_m": [0, 0, 0], "veiling_light": [0, 0, 0]}})
    add("optics-strong", {"optics": {"absorption_per_m": [90, 200, 400], "scattering_per_m": [100, 300, 600],
                                     "veiling_light": [1, 10, 1000]}})
    add("optics-disguised-kd", {"optics": {"beam_attenuation_per_m": [0.36, 0.063, 0.019],
                                           "diffuse_attenuation_per_m": [0.36, 0.063, 0.019], "veiling_light": [0, 0.1, 0.2]}})


def modes(add):
    for ambient in ["none", "absolute", "exposed"]:
        for depth in [0, 4.5, 30]:
            water = {"optics": "jerlov-1C", "depth_m": depth, "ambient": ambient}
            add(f"ambient-{ambient}-{depth}", water, artifacts=["rgb", "direct", "backscatter"])
    for holes in ["background", "reject", {"range_m": 6.5}, {"range_m": 0.001}]:
        name = holes if isinstance(holes, str) else f"range-{holes['range_m']}"
        for family in FAMILIES[:2]:
            add(f"holes-{name}-{family}", {"optics": "jerlov-II", "holes": holes}, family, artifacts=["rgb", "transmittance"])
    add("dry", {}, artifacts=["rgb", "range"])
    add("dry-unused", {"range_scale": 2, "depth_m": 3}, alpha=0.5)


def lamps(add):
    sets = {"point": [POINT], "spot": [SPOT], "behind": [BEHIND], "both": [POINT, SPOT],
            "four": [POINT, SPOT, BEHIND, POINT | {"position_m": [0.8, 0.1, 0.4]}],
            "wide": [SPOT | {"cone_deg": 90}], "narrow": [SPOT | {"cone_deg": 0.5}],
            "bright": [POINT | {"intensity": [1000, 1000, 1000]}], "dark": [POINT | {"intensity": [0, 0, 0]}],
            "ahead": [POINT | {"position_m": [0.05, 0, 1.2]}]}
    for name, lights in sets.items():
        for family in FAMILIES:
            if family == "structure" or name in ("point", "both", "four"):
                add(f"lamps-{name}-{family}", {"optics": {"preset": "jerlov-3C", "veil_gain": 0.05}}, family, lights=lights,
                    artifacts=["rgb", "direct", "backscatter"])
    add("lamps-dry", lights=[POINT, SPOT])
    add("lamps-many", {"optics": "jerlov-1C"}, size=(48, 32),
        lights=[POINT | {"position_m": [index / 8 - 1, 0.1, 0.0]} for index in range(16)])
    add("lamps-fraction", {"optics": {"preset": "jerlov-3C", "backscatter_fraction": 0.1}}, lights=[SPOT])
    add("lamps-revised", {"optics": {"preset": "jerlov-3C", "backscatter_attenuation_per_m": [0.7, 0.5, 0.6]}}, lights=[SPOT])
    add("lamps-scale", {"optics": "jerlov-II", "range_scale": 3}, lights=[POINT, SPOT])
    add("lamps-tight", {"optics": "jerlov-3C"}, lights=[POINT, SPOT], fidelity={"tolerance": 1e-6})
    add("lamps-loose", {"optics": "jerlov-3C"}, lights=[POINT, SPOT], fidelity={"tolerance": 0.01})
    add("lamps-reference", {"optics": "jerlov-3C"}, lights=[POINT, SPOT], fidelity={"variant": "reference"}, size=(24, 16))
    add("lamps-night", {"optics": {"preset": "jerlov-II", "veil_gain": 0}, "depth_m": 200, "ambient": "absolute"}, lights=[BEHIND, SPOT])


def suspended(add):
    masks = ["rgb", "snow_mask", "scattered"]
    for density in [0, 5, 300, 20000]:
        for family in FAMILIES[:2]:
            add(f"snow-{density}-{family}", {"optics": "jerlov-1C", "snow": {"density_per_m3": density}}, family, artifacts=masks)
    add("snow-large", {"optics": "jerlov-IB", "snow": {"density_per_m3": 100, "radius_m": 0.02, "radius_spread": 0}}, artifacts=masks)
    add("snow-fine", {"optics": "jerlov-IB", "snow": {"density_per_m3": 4000, "radius_m": 1e-5, "radius_spread": 1}}, artifacts=masks)
    add("snow-shell", {"optics": "jerlov-3C", "snow": SNOW | {"near_m": 0.05, "far_m": 0.8, "albedo": [0.9, 0.6, 0.1]}}, artifacts=masks)
    add("snow-dry", {"snow": SNOW}, artifacts=masks)
    add("snow-lamps", {"optics": "jerlov-3C", "snow": SNOW}, lights=[POINT, SPOT], artifacts=masks)
    add("snow-reference", {"optics": "jerlov-3C", "snow": SNOW}, fidelity={"variant": "reference"}, size=(24, 16), artifacts=masks)
    add("snow-frames", {"optics": "jerlov-II", "snow": SNOW}, count=3, artifacts=masks)
    for contrast in [0, 0.3, 0.95]:
        for scale in [0.05, 2, 50]:
            add(f"turbidity-{contrast}-{scale}", {"optics": "jerlov-3C", "turbidity": {"contrast": contrast, "scale_m": scale}},
                artifacts=["rgb", "transmittance"])
    for family in FAMILIES:
        add(f"turbidity-lamps-{family}", {"optics": "jerlov-3C", "turbidity": PATCHES}, family, lights=[POINT, SPOT])
    add("turbidity-reference", {"optics": "jerlov-3C", "turbidity": PATCHES}, fidelity={"variant": "reference"}, size=(24, 16))
    add("turbidity-snow-lamps", {"optics": "jerlov-II", "turbidity": PATCHES, "snow": SNOW}, lights=[POINT, SPOT], artifacts=LAYERS + ["snow_mask"])
    add("turbidity-explicit", {"optics": BEAM, "turbidity": PATCHES})


def paths(add):
    for family in FAMILIES:
        add(f"path-{family}", {"optics": "jerlov-1C"}, family, path={"frames": 4, "sway_m": 0.05, "sway_deg": 2, "sway_frames": 7.5},
            count=5, artifacts=["rgb", "range", "boxes"])
    add("path-own", {"optics": "jerlov-IB", "snow": SNOW, "turbidity": PATCHES}, "structure", count=3, artifacts=["rgb", "snow_mask"],
        path={"frames": 3, "start": {"position_m": [-1, -4, 2.5], "target_m": [0, 0, 2]}, "end": {"position_m": [1, -3, 2], "target_m": [0.2, 0, 1.5]}})
    add("path-frame", {"optics": "jerlov-IB"}, "pipeline", path={"frames": 10, "frame": 7})
    add("path-lamps", {"optics": "jerlov-3C"}, "shaft", path={"frames": 2}, count=2, lights=[SPOT])


def styles(add):
    for style in STYLES + ["atlantic", "mediterranean", "muddy"]:
        for tier in ["net", "lut", "auto"]:
            for alpha in [1, 0.35]:
                if style.startswith("kept") or (tier, alpha) == ("net", 1):
                    add(f"style-{style}-{tier}-{alpha}", {"optics": "jerlov-II", "style": style, "style_tier": tier}, alpha=alpha,
                        artifacts=["rgb", "styled", "scattered"])
    add("style-absent", {"optics": "jerlov-II"}, alpha=0.5)
    add("style-zero", {"style": STYLES[0]}, alpha=0, artifacts=["rgb", "styled"])
    add("style-dry", {"style": STYLES[1]}, alpha=0.7)
    add("style-odd", {"style": STYLES[2]}, size=(61, 37))
    add("style-loose", {"optics": "jerlov-II", "style": STYLES[2], "style_tier": "auto"}, fidelity={"tolerance": 0.2})
    add("style-reference", {"optics": "jerlov-II", "style": STYLES[2]}, fidelity={"variant": "reference"}, size=(24, 16))
    add("style-lamps-snow", {"optics": "jerlov-II", "style": STYLES[0], "snow": SNOW}, alpha=0.6, lights=[SPOT, POINT])
    for style in ["foreign", "foreign-noise"]:
        add(f"onnx-{style}", {"optics": "jerlov-II", "style": style}, alpha=0.5, count=2, artifacts=["rgb", "styled"])


def files(add):
    def scene(rgb, **more):
        more = {key: f"inputs/{value}" if key in ("range", "z_depth") else value for key, value in more.items()}
        return {"kind": "files", "rgb": f"inputs/{rgb}"} | more
    coded = {"unit_m": 0.001, "invalid_code": 65535}
    water = {"optics": "jerlov-1C", "range_scale": 0.5}
    made = ["rgb", "clean", "range", "transmittance"]
    for rgb in ["rgb8.png", "rgba8.png", "gray8.png", "rgb16.png", "rgb.npy", "rgb64.npy", "rgb_negative.npy", "photo.jpg",
                "progressive.jpg", "gray.jpg", "lossless.webp", "lossy.webp", "alpha.webp", "palette.png", "bits.png", "profile.png"]:
        add(f"files-alone-{rgb}", scene=scene(rgb), artifacts=["rgb", "clean"])
        add(f"files-water-{rgb}", water, scene=scene(rgb, range="range16.png", **coded), artifacts=made)
    for kind in ["range", "z_depth"]:
        for name, more in [("range16.png", coded), ("range8.png", {"unit_m": 0.05, "invalid_code": 0}), ("range.npy", {}), ("range64.npy", {"unit_m": 0.5}),
                           ("range16.npy", coded), ("far.npy", {})]:
            add(f"files-{kind}-{name}", water, scene=scene("rgb8.png", **{kind: name}, **more), artifacts=made)
    depth = scene("photo.jpg", z_depth="range.npy")
    add("files-lamps", water, scene=depth, lights=[POINT, SPOT], artifacts=made, hfov=60)
    add("files-snow", water | {"snow": SNOW, "turbidity": PATCHES}, scene=depth, artifacts=made + ["snow_mask"])
    add("files-reject", water | {"holes": "reject"}, scene=depth)
    add("files-style", {"style": STYLES[1]}, scene=scene("lossy.webp"), alpha=0.5, enhance=["hscm"])
    add("files-choice", water, scene={"choice": [depth, scene("rgb.npy", range="range.npy")]}, count=4)
    add("files-missing", water, scene=scene("missing.png"))
    add("files-other-size", water, scene=scene("small.png", range="range.npy"))


def enhancements(add):
    every = [f"enhanced.{method}" for method in METHODS] + ["hscm_mask"]
    for name, water in [("air", None), ("1C", {"optics": "jerlov-1C"}), ("9C", {"optics": "jerlov-9C"}), ("muddy", {"style": STYLES[2]})]:
        add(f"enhance-{name}", water, enhance=METHODS, artifacts=["rgb"] + every, metrics=METRICS, size=(160, 120))
    for method in METHODS:
        add(f"enhance-small-{method}", {"optics": "jerlov-3C"}, enhance=[method], artifacts=["rgb", f"enhanced.{method}"], size=(9, 7))
    add("enhance-pixel", {"optics": "jerlov-3C"}, enhance=METHODS, artifacts=every, size=(1, 1), metrics=METRICS)
    add("enhance-odd", {"optics": "jerlov-II"}, enhance=METHODS, artifacts=every, size=(63, 41))
    for family in FAMILIES:
        add(f"metrics-{family}", {"optics": "jerlov-IB"}, family, metrics=METRICS, count=2)
    add("metrics-none", {"optics": "jerlov-IB"}, metrics=[], artifacts=[])


def fidelity(add):
    for tolerance in [1e-7, 1e-5, 1e-4, 3e-4, 1e-3, 1e-2, 0.1, 1]:
        add(f"fidelity-{tolerance}", {"optics": "jerlov-3C"}, "structure", fidelity={"tolerance": tolerance}, artifacts=["rgb", "forward_scatter"])
    for terms in [1, 2, 5, 16, 64]:
        add(f"fidelity-terms-{terms}", {"optics": "jerlov-3C"}, "pipeline", fidelity={"terms": terms}, artifacts=["rgb", "forward_scatter"])
    for variant in ["reference", "display"]:
        for model in ["jaffe", "simplified", "none"]:
            spread = {} if model == "none" else {"spread_px_per_m": [2, 1, 0.5]}
            optics = {"preset": "jerlov-3C", "forward_scatter": {"model": model} | spread}
            add(f"fidelity-{variant}-{model}", {"optics": optics}, fidelity={"variant": variant}, size=(40, 26), artifacts=LAYERS)
    add("fidelity-display-all", {"optics": "jerlov-II", "snow": SNOW, "turbidity": PATCHES, "style": STYLES[0]}, alpha=0.5,
        fidelity={"variant": "display"}, lights=[POINT], count=2)
    wide = {"model": "jaffe", "g_per_m": [0, 0, 0], "spread_px_per_m": [0.02, 1, 20], "spread_offset_px": [0, 0, 0]}
    add("fidelity-wide", {"optics": {"preset": "jerlov-3C", "forward_scatter": wide}}, "structure", fidelity={"tolerance": 5e-3})


def laws(add):
    scene = {"kind": "procedural", "family": {"choice": FAMILIES, "weights": [1, 2, 0.5]}, "seed": {"int": [0, 1000000]}}
    add("law-choice", {"optics": {"choice": ["jerlov-IB", {"preset": "jerlov-3C", "veil_gain": {"uniform": [0, 1]}}]}}, scene=scene, count=5)
    add("law-numbers", {"optics": "jerlov-1C", "range_scale": {"log_uniform": [0.1, 4]}, "depth_m": {"uniform": [0, 20]}, "ambient": {"choice": ["none", "exposed"]}},
        scene=scene, count=5, alpha={"uniform": [0, 1]}, lights=[{"kind": "haze", "x": {"normal": [0.5, 0.3], "clip": [0, 1]}, "y": 0.5}])
    add("law-int", {"optics": "jerlov-1C"}, size=(48, 32), fidelity={"terms": {"int": [1, 12]}}, count=4)
    add("law-grid", {"optics": {"grid": ["jerlov-IB", "jerlov-1C"]}, "range_scale": {"grid": [0.5, 1, 2]}}, size=(48, 32), count=2)
    add("law-grid-objects", {"grid": [{"optics": "jerlov-IB", "snow": SNOW}, {"style": STYLES[0], "depth_m": 3}, {}]}, size=(48, 32), count=2)
    add("law-rgb", {"optics": {"beam_attenuation_per_m": [{"uniform": [0.1, 1]}, 0.3, {"choice": [0.2, 0.4]}], "veiling_light": [0.1, {"uniform": [0, 1]}, 0.2]}}, count=3)
    add("law-lamps", {"optics": "jerlov-3C"}, count=3, lights=[{"choice": [POINT, SPOT | {"cone_deg": {"uniform": [5, 60]}}, {"kind": "haze", "x": 0.5, "y": 0.4}]}])
    add("law-lists", {"optics": "jerlov-3C"}, count=3, enhance={"choice": [["hscm"], ["clahe", "rd"], []]}, metrics={"choice": [["uiqm"], ["entropy"]]})
    add("law-camera", {"optics": "jerlov-3C"}, count=3, labels={"run": "a", "number": {"uniform": [0, 1]}, "good": True})
    for seed in [1, 9007199254740993, 18446744073709551615]:
        add(f"law-seed-{seed}", {"optics": "jerlov-3C", "range_scale": {"uniform": [0.1, 1]}}, scene=scene, seed=seed, count=2)


def haze(add):
    base = {"kind": "haze", "x": 0.4, "y": 0.6, "size": 0.25, "intensity": 0.7}
    for blend in ["over", "add"]:
        for space in ["linear", "display"]:
            add(f"haze-{blend}-{space}", {"optics": "jerlov-IB"}, artifacts=["rgb", "hazed"],
                lights=[base | {"blend": blend, "space": space, "color": [1, 0.8, 0.5]}, base | {"blend": blend, "space": space, "x": 0.8, "size": 0.05, "color": [0.2, 0.4, 3]}])
    add("haze-mixed", lights=[base, base | {"blend": "add", "x": -0.5}, base | {"size": 0}, base | {"size": 40, "intensity": 0.1}])
    add("haze-bright", {"optics": "jerlov-IB"}, lights=[base | {"color": [1000, 1000, 1000], "intensity": 1}])
    add("haze-lamps", {"optics": "jerlov-3C"}, lights=[POINT, base, SPOT, base | {"x": 0.9}])


def formats(add):
    for encode in [{"format": "png"}, {"format": "webp"}, {"format": "jpeg"}, {"format": "jpeg", "quality": 1}, {"format": "jpeg", "quality": 100}]:
        name = "-".join(str(value) for value in encode.values())
        add(f"encode-{name}", {"optics": "jerlov-II", "style": STYLES[0]}, alpha=0.5, encode=encode, enhance=["hscm"],
            artifacts=["rgb", "clean", "scattered", "styled", "hazed", "range", "preview", "enhanced.hscm", "hscm_mask"])
    add("encode-law", encode={"format": "jpeg", "quality": {"int": [1, 100]}}, count=2)
    add("artifacts-all", {"optics": "jerlov-II", "snow": SNOW}, enhance=METHODS, count=2,
        artifacts=LAYERS + LABELS + ["styled", "range", "snow_mask", "hscm_mask", "preview"] + [f"enhanced.{method}" for method in METHODS])
    add("dataset-name", dataset="a.b_c-9", labels={"x.y": "text", "n": -1.5, "flag": False, "big": 12345678901234567})


def together(add):
    haze_law = {"kind": "haze", "x": {"uniform": [0, 1]}, "y": 1.0, "size": {"uniform": [0.06, 0.2]}, "intensity": {"normal": [0.6, 0.2], "clip": [0, 1]}, "color": [1, 1, 1]}
    scene = {"kind": "procedural", "family": "structure", "seed": {"int": [0, 1000000]}}
    water = {"optics": {"choice": ["jerlov-IB", "jerlov-II", "jerlov-1C", "jerlov-3C"]}, "range_scale": {"log_uniform": [0.15, 0.8]}, "style": {"choice": STYLES}}
    metrics = ["entropy", "uicm", "uism", "uiconm", "uiqm", "uciqe", "psnr", "ssim"]
    add("tour", water, scene=scene, count=12, seed=7, alpha={"uniform": [0.2, 0.9]}, lights=[haze_law], enhance=["hscm"], metrics=metrics,
        artifacts=["rgb", "range", "instances", "enhanced.hscm"], labels={"run": "tour"})
    add("all-at-once", water | {"snow": SNOW, "turbidity": PATCHES, "depth_m": 6, "ambient": "exposed", "style_tier": "auto"}, scene=scene, count=12,
        alpha={"uniform": [0.2, 0.9]}, lights=[POINT, SPOT, haze_law], enhance=METHODS, metrics=METRICS, artifacts=LAYERS + LABELS + ["snow_mask"])
