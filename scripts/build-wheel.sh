#!/usr/bin/env bash
# Builds the wheel of the Python package, one file for every Python from 3.10 on, and prints its path. maturin is installed
# below target/tools the first time.
set -euo pipefail
cd "$(dirname "$0")/.."
target=${CARGO_TARGET_DIR:-$PWD/target}
version=1.16.0
maturin=$target/tools/maturin-$version
if [ ! -x "$maturin/bin/maturin" ]; then
    python3 -m venv "$maturin"
    "$maturin/bin/pip" install --quiet --disable-pip-version-check "maturin==$version"
fi
rm -rf "$target/wheels"
"$maturin/bin/maturin" build --quiet --release --locked --manifest-path bindings/python/Cargo.toml --out "$target/wheels" >&2
ls "$target"/wheels/*.whl
