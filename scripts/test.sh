#!/usr/bin/env bash
# Sets up what is needed and runs every test.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/get-onnxruntime.sh
cargo build --release --locked --workspace
exec cargo test --release --locked --workspace "$@"
