#!/usr/bin/env bash
# The unit tests of the crates that compute with numbers from outside, with overflow checks and debug assertions.
set -euo pipefail
cd "$(dirname "$0")/.."
exec cargo test --profile checked --locked --lib -p imaging -p optics -p spec -p wire -p store -p catalogue "$@"
