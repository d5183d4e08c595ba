#!/usr/bin/env bash
# Measures the first hour of a user in a fresh clone of HEAD: minutes from the clone to the first picture, and lines and minutes from there to
# the first training batch and to the first query over metrics. The crates are downloaded before, since that depends on the network alone;
# docs/science/speed.md has the other rows. Needs an idle machine, a network and 4 GB of disk.
# Usage: scripts/measure-first-hour.sh
set -euo pipefail
cd "$(dirname "$0")/.."
unset CARGO_TARGET_DIR
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
git clone --quiet --no-hardlinks . "$folder/fathom"
cd "$folder/fathom"

# Lines that a reader types from the beginning of a page to the first line with a word.
count_lines() {
    PYTHONPATH=tests/docs python3 - "$1" "$2" <<'PY'
import pathlib
import sys

from blocks import extract_blocks

lines = [line for block in extract_blocks(pathlib.Path(sys.argv[1]).read_text()) for line in block.code.splitlines() if line.strip()]
print(1 + next(index for index, line in enumerate(lines) if sys.argv[2] in line))
PY
}

# Runs a command quietly and prints its name, the lines to type and its minutes.
measure() {
    local name=$1 lines=$2 begun
    begun=$(date +%s)
    "${@:3}" >"$folder/log" 2>&1 || { tail -20 "$folder/log" >&2; exit 1; }
    awk -v name="$name" -v lines="$lines" -v begun="$begun" -v ended="$(date +%s)" \
        'BEGIN { printf "%-36s %5s %8.1f\n", name, lines, (ended - begun) / 60 }'
}

train() {
    bash scripts/build-wheel.sh
    python3 -m venv venv
    venv/bin/pip install --quiet target/wheels/fathom_datasets-*.whl jax
    venv/bin/python examples/train_segmentation.py 1
}

query() {
    export FATHOM_SERVER=http://127.0.0.1:7391 PATH=$PWD/target/release:$PATH
    fathom serve --listen 127.0.0.1:7391 --data "$folder/data" &
    sleep 3
    fathom submit examples/tour.json --wait && fathom query 'uiqm > 0.5' --dataset tour
    kill $! && wait $!
}

uptime
printf '%-36s %5s %8s\n' figure lines minutes
measure 'before: download of the crates' - cargo fetch --locked
measure 'clone to the first picture' 1 bash scripts/run.sh
measure 'then to the first training batch' "$(count_lines docs/tutorials/train-a-segmenter.md train_segmentation.py)" train
measure 'then to the first query over metrics' "$(count_lines docs/guide/datasets-and-queries.md 'fathom query')" query
