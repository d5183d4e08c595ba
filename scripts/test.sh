#!/usr/bin/env bash
# Sets up what is needed and runs every test. Arguments are handed on to `cargo test`.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/get-onnxruntime.sh
cargo build --release --locked --workspace
cargo test --release --locked --workspace "$@"
scripts/test-cluster.sh --short
scripts/test-python.sh
FATHOM_WHEEL=$(realpath "${CARGO_TARGET_DIR:-target}"/wheels/*.whl) scripts/test-ros.sh --short
exec scripts/test-docs.sh
