#!/bin/sh
# Counts correct matches of raw and enhanced pictures along a camera path, in air and in four waters, with OpenCV's ORB and
# SIFT as referees. Prints tables in Markdown; about 10 minutes on 2 cores.
# Needs Python 3 with venv; fetches opencv-python-headless and numpy into target/opencv the first time.
# Usage: scripts/compare-matches.sh [FRAMES]
set -eu
cd "$(dirname "$0")/.."
target="${CARGO_TARGET_DIR:-target}"
venv="$target/opencv"
if ! "$venv/bin/python" -c 'import cv2, numpy' 2>/dev/null; then
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet --disable-pip-version-check opencv-python-headless numpy
fi
cargo build --quiet --release -p cli
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
"$venv/bin/python" scripts/compare_matches.py "$target/release/fathom" "$folder" "${1:-12}"
