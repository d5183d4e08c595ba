#!/usr/bin/env bash
# Sets up what is needed and runs the main job: a service on this machine alone, a dataset of 18 frames, its metrics
# and a contact sheet. Arguments are handed on to `fathom demo`.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/get-onnxruntime.sh
cargo build --release --locked --bin fathom
exec target/release/fathom demo "$@"
