#!/usr/bin/env bash
# What a set costs beside `fathom render` into a folder: CPU time in pairs, memory for long and short shards, bytes.
# Usage: scripts/measure-sets.sh [PAIRS]
set -euo pipefail
cd "$(dirname "$0")/.."
target=${CARGO_TARGET_DIR:-$PWD/target}
export FATHOM=${FATHOM:-$target/release/fathom}
exec python3 scripts/measure_sets.py "${1:-7}"
