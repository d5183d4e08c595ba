"""Renders a set as tasks of a Ray cluster.

Usage: JOB=job.json SET=s3://reef/tour python ray_parts.py [PARTS]
"""

import os
import subprocess
import sys
from pathlib import Path

import ray

SHARD = Path(__file__).with_name("shard.sh").read_text()
ENV = {name: value for name, value in os.environ.items() if name.startswith("AWS_") or name in ("FATHOM", "JOB", "SET")}


# A worker that dies is Ray's to repeat; an exit status is an answer, and 5 is repeated by the script itself.
@ray.remote(num_cpus=1, max_retries=10)
def render(part):
    return subprocess.run(["bash", "-c", SHARD, "shard.sh", part], env=os.environ | ENV).returncode


parts = int(sys.argv[1]) if len(sys.argv) > 1 else 4
ray.init()
sys.exit(max(ray.get([render.remote(f"{part}/{parts}") for part in range(parts)])))
