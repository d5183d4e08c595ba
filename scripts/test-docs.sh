#!/usr/bin/env bash
# Runs every shell, Python and SQL block of README.md and docs as typed and plans every job in JSON, each page in a fresh copy of the last
# commit, and prints a table. Blocks below `<!-- needs: … -->` are counted and not run. Lines that build are left out: the binary and the
# wheel come from target.
# Usage: scripts/test-docs.sh [ARGUMENTS OF pytest], such as -k exports
# FATHOM names the binary to test, with the wheel that is there; FATHOM_DOCS_TREE another commit or tree than HEAD.
set -euo pipefail
cd "$(dirname "$0")/.."
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
scripts/get-onnxruntime.sh
if [ -z "${FATHOM:-}" ]; then
    cargo build --release --locked --workspace
fi
if [ -z "${FATHOM:-}" ] || ! ls "$target"/wheels/fathom_datasets-*.whl >/dev/null 2>&1; then
    scripts/build-wheel.sh >/dev/null
fi

# The newest Python of this machine; JAX needs 3.12.
find_python() {
    for version in 14 13 12; do
        for python in "$HOME"/.pyenv/versions/3."$version".*/bin/python "python3.$version"; do
            if "$python" -c '' 2>/dev/null; then
                echo "$python"
                return
            fi
        done
    done
    echo 'test-docs: no Python from 3.12 on is there' >&2
    return 1
}

packages='pytest==9.2.0 httpx==0.28.1 numpy pandas pyarrow jax==0.12.0.1 onnx==1.23.2 openapi-python-client==0.29.1
    webdataset==1.0.2 datasets==5.2.0 pillow pycocotools==2.0.11 pyyaml==6.0.3 rosbags==0.11.9 av==19.0.2 duckdb==2.0.0'
place=$target/tools/docs
if [ "$(cat "$place/packages" 2>/dev/null)" != "$packages" ]; then
    rm -rf "$place"
    "$(find_python)" -m venv "$place"
    # shellcheck disable=SC2086 # a list of words
    "$place/bin/pip" install --quiet --disable-pip-version-check $packages
    echo "$packages" >"$place/packages"
fi
"$place/bin/pip" install --quiet --disable-pip-version-check --no-deps --force-reinstall "$target"/wheels/fathom_datasets-*.whl

FATHOM=$(realpath "${FATHOM:-$target/release/fathom}")
export FATHOM CARGO_TARGET_DIR=$target PYTHONDONTWRITEBYTECODE=1
cd tests/docs
exec "$place/bin/python" -m pytest "$@"
