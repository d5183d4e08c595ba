"""A data folder of the service, and what the service answers over it."""

import gzip
import hashlib
import json
import tarfile
import urllib.parse

import cases
from service import serve

STYLE = "kept-muddy"
QUAY = {"name": "quay-7", "source": "our transmissometer, May", "licence": "CC-BY-4.0", "wavelength_nm": [650, 532, 450],
        "absorption_per_m": [0.42, 0.2, 0.5], "scattering_per_m": [1.0, 1.1, 1.3], "diffuse_attenuation_per_m": [0.6, 0.4, 0.8]}
BASIN = {"name": "basin", "source": "a guess", "wavelength_nm": [650, 532, 450], "beam_attenuation_per_m": [0.7, 0.5, 0.6],
         "veiling_light": [0.1, 0.2, 0.2], "backscatter_fraction": 0.03, "caveats": ["never measured"]}
# The service makes these again when it starts.
LEFT_OUT = ("space.", "lock")


def job(dataset, water, count=4, size=(24, 16), **fields):
    scene = {"kind": "procedural", "family": {"choice": cases.FAMILIES}, "seed": {"int": [0, 1000000]}}
    camera = {"width": size[0], "height": size[1], "hfov_deg": {"uniform": [60, 90]}}
    return {"dataset": dataset, "count": count, "seed": 5, "scene": scene, "camera": camera, "water": water} | fields


def fill(binary, data, work):
    """Makes the data folder; returns the job that is paused in its middle and what it is submitted as."""
    slow = {"size": (40, 26), "fidelity": {"variant": "reference"}, "count": 11}
    patient = job("later", {"optics": "jerlov-3C", "snow": cases.SNOW}, lights=[cases.SPOT], **slow)
    with serve(binary, data, work, 1, FATHOM_FAULTS="scene.nan=flag#11") as service:
        finished = jobs_that_end(service, work)
        paused = service.json("/v1/jobs", patient)["id"]
        service.wait(paused, lambda found: found["done"] >= 2)
        service.json(f"/v1/jobs/{paused}/pause", {})
        cancelled = service.json("/v1/jobs", patient | {"dataset": "bay", "labels": {"run": "cut short"}})["id"]
        service.wait(cancelled, lambda found: found["done"] >= 2)
        service.json(f"/v1/jobs/{cancelled}/cancel", {})
        service.ended(cancelled)
        service.json(f"/v1/jobs/{finished['deleted']}", method="DELETE")
        service.json("/v1/waters/basin", method="DELETE")
    with serve(binary, data, work, 0) as service:
        waiting = service.json("/v1/jobs", job("later", {"optics": "quay-7"}, count=3), Idempotency_Key="waiting")["id"]
    return {"paused": paused, "waiting": waiting, "patient": patient}


def jobs_that_end(service, work):
    for water in (QUAY, BASIN):
        service.json("/v1/waters", water)
    picture = lambda name: (work / "inputs" / name).read_bytes()
    coded = {"unit_m": 0.001, "invalid_code": 65535}
    uploaded = [service.form("/v1/scenes", rgb=picture("photo.jpg"), z_depth=picture("range.npy"), hfov_deg=70, instances=picture("instances8.png")),
                service.form("/v1/scenes", rgb=picture("rgb8.png"), range=picture("range16.png"), focal_px=60, cx=38.5, cy=27, **coded),
                service.form("/v1/scenes", rgb=picture("lossy.webp"))]
    brought = [{"kind": "uploaded", "id": scene["id"]} for scene in uploaded]
    many = {"optics": {"choice": ["jerlov-IB", "jerlov-3C", "quay-7"]}, "range_scale": {"log_uniform": [0.2, 2]}, "depth_m": {"uniform": [0, 20]},
            "style": {"choice": [STYLE, "kept-atlantic"]}, "snow": cases.SNOW, "turbidity": cases.PATCHES, "ambient": "exposed"}
    haze = {"kind": "haze", "x": {"uniform": [0, 1]}, "y": 0.5}
    jobs = {
        "full": job("bay", many, count=8, alpha={"uniform": [0, 1]}, lights=[cases.SPOT, haze], enhance=["hscm", "clahe"], metrics=cases.METRICS,
                    artifacts=["rgb", "range", "boxes", "transmittance", "enhanced.hscm"], labels={"run": "first", "number": {"int": [1, 5]}, "good": True}),
        "grid": job("bay", {"optics": {"grid": ["jerlov-IB", "jerlov-1C"]}, "holes": {"range_m": 9}}, count=2, fidelity={"terms": 3}, labels={"run": "grid"}),
        "seeds": job("bay", {"optics": "jerlov-II"}, seed=18446744073709551615, count=2, scene={"kind": "procedural", "family": "shaft", "seed": 9007199254740991}),
        "own": job("bay", {"optics": {"preset": "quay-7", "veil_gain": 0.5}}, count=2, fidelity={"variant": "display"}),
        "gone": job("bay", {"optics": "basin"}, count=2),
        "broken": job("faults", {"optics": "jerlov-3C"}, count=12, size=(16, 10)),
        "brought": job("own-photos", {"optics": "jerlov-1C"}, scene={"grid": brought[:2]}, count=1, artifacts=["rgb", "clean", "range", "instances"]),
        "flat": job("own-photos", {"style": STYLE}, scene=brought[2], count=1, enhance=["rd"], encode={"format": "jpeg", "quality": 80}),
        "path": job("path", {"optics": "jerlov-1C"}, count=3, scene={"kind": "procedural", "family": "pipeline", "seed": 3},
                    camera={"width": 24, "height": 16, "path": {"frames": 3, "sway_m": 0.02, "sway_frames": 9}}),
        "deleted": job("bay", {"optics": "jerlov-9C"}, count=3, labels={"run": "gone"}),
    }
    ids = {}
    for name, each in jobs.items():
        ids[name] = service.json("/v1/jobs", each, Idempotency_Key=f"proof-{name}")["id"]
        ended = service.ended(ids[name])
        assert ended["state"] == ("done_with_failures" if name == "broken" else "done"), ended
    service.json("/v1/renders", job("one", {"optics": "jerlov-II"}, count=1))
    return ids


def pack(data, target):
    """Stores a data folder compactly and without dates."""
    def plain(member):
        member.uid = member.gid = member.mtime = 0
        member.uname = member.gname = ""
        return None if any(part in member.name for part in LEFT_OUT) else member
    with target.open("wb") as file, gzip.GzipFile(fileobj=file, mode="wb", mtime=0) as packed, tarfile.open(fileobj=packed, mode="w") as archive:
        archive.add(data, arcname="data", filter=plain)


def unpack(source, folder):
    with tarfile.open(source) as archive:
        archive.extractall(folder, filter="data")
    return folder / "data"


def questions(service):
    """Paths to ask for: every list, every job, image and artifact, and questions over every column."""
    yield from ["/v1/jobs", "/v1/jobs?limit=3", "/v1/jobs?dataset=bay&state=done", "/v1/jobs?state=paused", "/v1/scenes", "/v1/waters", "/v1/waters/quay-7",
                "/v1/waters/basin", "/v1/styles", "/v1/datasets", "/v1/images", "/v1/images?limit=7", "/v1/jobs/job_absent", "/v1/datasets/absent"]
    for found in service.json("/v1/jobs?limit=1000")["items"]:
        yield from [f"/v1/jobs/{found['id']}{part}" for part in ("", "/errors", "/results")]
    rows = service.json("/v1/images?limit=1000")["items"]
    for row in rows:
        image = f"/v1/images/{row['job']}/{row['frame']}"
        yield image
        for artifact in service.json(image)["artifacts"]:
            yield f"{image}/artifacts/{artifact['kind']}"
        yield f"{image}/artifacts/normals"
    yield f"{image}/preview"
    for dataset in service.json("/v1/datasets")["items"]:
        yield from [f"/v1/datasets/{dataset['name']}{part}" for part in ("", "/metadata.csv", "/metadata.jsonl", "/metadata.jsonl?filter=frame%20%3D%200")]
    yield from over_columns(service, rows)


def over_columns(service, rows):
    def images(**query):
        return "/v1/images?" + urllib.parse.urlencode({"limit": 1000} | query)
    columns = {column["name"]: column["kind"] for dataset in service.json("/v1/datasets")["items"]
               for column in service.json(f"/v1/datasets/{dataset['name']}")["columns"]}
    for name, kind in sorted(columns.items()):
        values = sorted({row[name] for row in rows if row.get(name) is not None}, key=str)
        yield images(fields=f"job,frame,{name}")
        yield images(fields=f"job,frame,{name}", order_by=name, limit=9)
        yield images(fields=f"job,frame,{name}", order_by=f"-{name}", limit=9)
        yield images(fields="job,frame", filter=f"{name} is null" if kind != "bool" else name)
        for value in values[len(values) // 2:][:1]:
            text = json.dumps(value)
            yield images(fields="job,frame", filter=f"{name} = {text}" if kind != "bool" else f"not {name}")
            if kind == "number":
                yield images(fields="job,frame", filter=f"{name} >= {text}")
                yield f"/v1/datasets/bay/histogram?column={name}&bins=5"
            yield f"/v1/datasets/bay/stats?metrics=uiqm,hscm.uiqm&group_by={name}"
    for filter_text in ['uiqm > 0.2 and (water.optics in ("quay-7", "jerlov-3C/williamson2022") or not alpha between 0.2 and 0.6)', 'labels.run = "first"',
                        "labels.number >= 3 and labels.good", "lights.1.x > 0.5", "hscm.uiqm > 0.5 and clahe.entropy is not null", "artifacts.range is not null",
                        "timings.water > 0", 'water.style not in ("kept-muddy")', "failed", "warned", "uiqn > 1", "uiqm >", 'labels.ü = "é" and', "frame = 1.5",
                        "seed > 9007199254740993", "seed = 18446744073709551615", "scene.seed = 9007199254740991"]:
        yield images(fields="job,frame", filter=filter_text)
        yield f"/v1/datasets/bay/stats?{urllib.parse.urlencode({'metrics': 'uiqm', 'filter': filter_text})}"
    yield images(fields="job,frame,lights.0.kind,lights.1.intensity,labels.run,timings.water,artifacts.rgb,hscm.uiqm,rd.uiqm")
    yield images(order_by="-hscm.uiqm", fields="job,frame", dataset="bay")
    yield images(order_by="labels.run", fields="job,frame")
    yield from [f"/v1/datasets/bay/histogram?{query}" for query in ("column=uiqm&bins=3&min=0&max=1", "column=absent", "column=uiqm&bins=0")]


def answer(service, path):
    """What is compared of a response: its status, its media type and its content; of pictures and arrays the SHA-256."""
    status, kind, data = service.ask(path)
    if "ndjson" in kind:
        content = [json.loads(line) for line in data.splitlines()]
    elif "json" in kind:
        content = json.loads(data)
        content.pop("instance", None) if isinstance(content, dict) else None
    elif kind.startswith("text/"):
        content = data.decode().splitlines()
    else:
        content = hashlib.sha256(data).hexdigest()
    return {"status": status, "type": kind, "content": content}


def answers(service, paths):
    return {path: answer(service, path) for path in paths}


def goes_on(binary, data, work, open_jobs, images):
    """What becomes of the jobs that had not ended, and of images that are rendered again."""
    # The folder's jobs began on a CPU with AVX-512; bytes are those of any, which the digests prove.
    with serve(binary, data, work, 1, FATHOM_MIX_WORKERS="true") as service:
        service.json(f"/v1/jobs/{open_jobs['paused']}/resume", {})
        found = {name: service.ended(open_jobs[name]) for name in ("paused", "waiting")}
        told = {name: {key: job[key] for key in ("state", "done", "failed", "digest")} for name, job in found.items()}
        again = service.json("/v1/jobs", job("later", {"optics": "quay-7"}, count=3), Idempotency_Key="waiting")
        told["repeated key"] = again["id"] == open_jobs["waiting"]
        told["rendered again"] = {f"{key[0]}/{key[1]}": service.json(f"/v1/images/{key[0]}/{key[1]}/verify", {"rerender": True})["reproduced"] for key in images}
    return told
