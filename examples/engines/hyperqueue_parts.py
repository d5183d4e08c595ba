"""Renders a set as tasks of a HyperQueue server that runs already (`hq server start`, `hq worker start`).

Usage: JOB=job.json SET=/mnt/reef/tour python hyperqueue_parts.py [PARTS] [SERVER_DIR]
"""

import os
import sys
from pathlib import Path

from hyperqueue import Client, Job

parts = int(sys.argv[1]) if len(sys.argv) > 1 else 4
client = Client(sys.argv[2] if len(sys.argv) > 2 else None)
shard = str(Path(__file__).with_name("shard.sh").resolve())
# A part that fails leaves the others alone.
job = Job(max_fails=None, default_env=dict(os.environ))
for part in range(parts):
    job.program(["bash", shard, f"{part}/{parts}"], crash_limit=100)
sys.exit(not client.wait_for_jobs([client.submit(job)], raise_on_error=False))
