#!/bin/sh
# Counts correct matches of raw and enhanced pictures along camera paths by day and by lamps, in air and in four waters, of
# three scenes each, with OpenCV's ORB and SIFT as referees. Prints tables in Markdown; about 15 minutes of processor time.
# With a FOLDER it keeps the values there, and continues after an interruption.
# Needs Python 3 with venv.
# Usage: scripts/compare-matches.sh [FRAMES [FOLDER]]
set -eu
cd "$(dirname "$0")/.."
target="${CARGO_TARGET_DIR:-target}"
python="$(scripts/get-opencv.sh)"
cargo build --quiet --release -p cli
folder="${2:-}"
if [ -z "$folder" ]; then
    folder="$(mktemp -d)"
    trap 'rm -rf "$folder"' EXIT
fi
"$python" scripts/compare_matches.py "$target/release/fathom" "$folder" "${1:-6}"
