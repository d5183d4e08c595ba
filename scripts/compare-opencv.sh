#!/bin/sh
# Times HSCM beside the same method written for NumPy and OpenCV, paired in one run, one thread each, on one core.
# Needs Python 3 with venv.
# Usage: scripts/compare-opencv.sh [ROUNDS]
set -eu
cd "$(dirname "$0")/.."
target="${CARGO_TARGET_DIR:-target}"
python="$(scripts/get-opencv.sh)"
cargo build --quiet --release -p enhance --example hscm_times
# Both take turns on the same core, so they need not share it with each other.
pin=""
if command -v taskset >/dev/null; then
    core="$(taskset -cp $$ | sed 's/.*[ ,-]//')"
    pin="taskset -c $core"
fi
exec env OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $pin \
    "$python" scripts/compare_opencv.py "$target/release/examples/hscm_times" "${1:-20}"
