#!/usr/bin/env bash
# The unit tests of the crates that compute with numbers from outside and are built without overflow checks, with them.
set -euo pipefail
cd "$(dirname "$0")/.."
checks=()
for crate in imaging optics; do
    checks+=(-p "$crate" --config "profile.release.package.$crate.overflow-checks=true")
done
exec cargo test --release --locked --lib "${checks[@]}" "$@"
