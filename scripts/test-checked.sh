#!/usr/bin/env bash
# The tests of the crates that compute and keep state, with overflow checks and debug assertions.
set -euo pipefail
cd "$(dirname "$0")/.."
exec cargo test --profile checked --locked -p imaging -p optics -p scenes -p enhance -p quality -p spec -p proto -p store -p catalogue "$@"
