#!/bin/sh
# Counts correct matches of raw and enhanced pictures along a camera path, in air and in four waters, with OpenCV's ORB and
# SIFT as referees. Prints tables in Markdown; about 10 minutes on 2 cores.
# Needs Python 3 with venv.
# Usage: scripts/compare-matches.sh [FRAMES]
set -eu
cd "$(dirname "$0")/.."
target="${CARGO_TARGET_DIR:-target}"
python="$(scripts/get-opencv.sh)"
cargo build --quiet --release -p cli
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
"$python" scripts/compare_matches.py "$target/release/fathom" "$folder" "${1:-12}"
