"""Submits a job, waits for it, asks for its best images, downloads them and plots a metric.

    pip install httpx matplotlib
    python examples/dataset.py http://127.0.0.1:7311
"""

import pathlib
import sys

import httpx
import matplotlib.pyplot as plt

server = httpx.Client(base_url=sys.argv[1] if len(sys.argv) > 1 else "http://127.0.0.1:7311", timeout=90)
job = {
    "dataset": "example", "count": 20, "seed": 1,
    "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 1_000_000]}},
    "water": {"optics": {"grid": ["jerlov-IB", "jerlov-3C"]}, "range_scale": {"uniform": [0.2, 0.6]}},
    "artifacts": ["rgb", "range", "instances"],
}
# The key makes a repeat of this request harmless: it answers the job that is there.
answer = server.post("/v1/jobs", json=job, headers={"Idempotency-Key": "example-1"}).raise_for_status().json()
while answer["state"] in ("queued", "running", "paused"):
    answer = server.get(f"/v1/jobs/{answer['id']}", params={"wait": 30, "since": answer["version"]}).json()
    print(f"{answer['done']} of {answer['frames']} frames")

question = {"dataset": "example", "filter": "uiqm > 0.3", "order_by": "-uiqm", "limit": 100}
images, cursor = [], None
while True:
    page = server.get("/v1/images", params=question | ({"cursor": cursor} if cursor else {})).raise_for_status().json()
    images += page["items"]
    if not (cursor := page["next_cursor"]):
        break

out = pathlib.Path("example")
out.mkdir(exist_ok=True)
for image in images[:8]:
    path = f"/v1/images/{image['job']}/{image['frame']}/artifacts/rgb"
    (out / f"{image['frame']:04}.png").write_bytes(server.get(path).raise_for_status().content)

for water in sorted({image["water.optics"] for image in images}):
    plt.hist([image["uiqm"] for image in images if image["water.optics"] == water], alpha=0.6, label=water)
plt.xlabel("UIQM")
plt.legend()
plt.savefig(out / "uiqm.png")
print(f"{len(images)} images; the best 8 and uiqm.png are in {out}/")
