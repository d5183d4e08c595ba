#!/bin/sh
# Prints the path of a Python with opencv-python-headless and numpy, fetched into target/opencv the first time.
# Needs Python 3 with venv.
set -eu
cd "$(dirname "$0")/.."
venv="${CARGO_TARGET_DIR:-target}/opencv"
if ! "$venv/bin/python" -c 'import cv2, numpy' 2>/dev/null; then
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet --disable-pip-version-check opencv-python-headless numpy
fi
echo "$venv/bin/python"
