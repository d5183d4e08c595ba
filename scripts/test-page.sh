#!/usr/bin/env bash
# Tests the page in Chromium: every view with the keyboard, a service that dies and returns, a token, hostile texts, accessibility.
# Usage: scripts/test-page.sh [--if-possible] [ARGUMENTS OF pytest]
# Chromium is installed with apt-get where it is missing. Where it cannot be, the script fails, or with --if-possible says so and ends.
# CHROMIUM names another binary of it, FATHOM the binary to test. `--pictures` draws the pictures of the documentation again.
set -euo pipefail
cd "$(dirname "$0")/.."
target=${CARGO_TARGET_DIR:-$PWD/target}
missing=1
if [ "${1:-}" = --if-possible ]; then
    shift
    missing=0
fi

export CHROMIUM=${CHROMIUM:-/usr/bin/chromium}
if [ ! -x "$CHROMIUM" ]; then
    { apt-get -qq update && DEBIAN_FRONTEND=noninteractive apt-get -qq install --no-install-recommends chromium fonts-dejavu-core; } >/dev/null 2>&1 || true
fi
if [ ! -x "$CHROMIUM" ]; then
    echo "test-page: SKIPPED: $CHROMIUM is not there and apt-get cannot install it" >&2
    exit "$missing"
fi

packages='playwright==1.49.0 pytest==9.2.0 axe-core-python==0.1.0'
place=$target/tools/page
if [ "$(cat "$place/packages" 2>/dev/null)" != "$packages" ]; then
    rm -rf "$place"
    python3 -m venv "$place"
    # shellcheck disable=SC2086 # a list of words
    "$place/bin/pip" install --quiet --disable-pip-version-check $packages
    echo "$packages" >"$place/packages"
fi

if [ -z "${FATHOM:-}" ]; then
    cargo build --release --locked
fi
export FATHOM=${FATHOM:-$target/release/fathom} PYTHONDONTWRITEBYTECODE=1
cd tests/page
exec "$place/bin/python" -m pytest "$@"
