#!/usr/bin/env bash
# Sets up what is needed and runs every test. Arguments are handed on to `cargo test`.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/get-onnxruntime.sh
cargo build --release --locked --workspace
cargo test --release --locked --workspace "$@"
scripts/test-cluster.sh --short
scripts/test-python.sh
exec scripts/test-docs.sh
