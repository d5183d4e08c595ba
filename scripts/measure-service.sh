#!/usr/bin/env bash
# What a service costs beside `fathom render`, in pairs that take turns: wall time and CPU time of a frame, one slot each.
# Usage: scripts/measure-service.sh [PAIRS]
set -euo pipefail
cd "$(dirname "$0")/.."
target=${CARGO_TARGET_DIR:-$PWD/target}
export FATHOM=${FATHOM:-$target/release/fathom}
exec python3 scripts/measure_service.py "${1:-7}"
