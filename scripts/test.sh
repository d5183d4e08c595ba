#!/usr/bin/env bash
# Sets up what is needed and runs every test. With arguments, which are handed on to `cargo test`, one test binary runs at a time.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/get-onnxruntime.sh
cargo build --release --locked --workspace
if [ $# -eq 0 ]; then
    python3 scripts/run_tests.py
else
    cargo test --release --locked --workspace "$@"
fi

# Beside the tests of Python: they wait for processes and leases most of the time. Their output is printed when they have ended.
target=${CARGO_TARGET_DIR:-$PWD/target}
scripts/test-cluster.sh --short >"$target/test-cluster.log" 2>&1 &
cluster=$!
trap 'kill "$cluster" 2>/dev/null || true' EXIT
scripts/test-python.sh
FATHOM_WHEEL=$(realpath "$target"/wheels/*.whl) scripts/test-ros.sh --short
wait "$cluster" || { cat "$target/test-cluster.log"; exit 1; }
cat "$target/test-cluster.log"
scripts/test-docs.sh
