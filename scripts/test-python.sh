#!/usr/bin/env bash
# Tests the Python package: builds the wheel, installs it into virtual environments of the oldest and the newest Python
# there are, and runs its tests there, in the oldest those that depend on the version; mypy runs once. Arguments are handed on to pytest.
set -euo pipefail
cd "$(dirname "$0")/.."
target=${CARGO_TARGET_DIR:-$PWD/target}
wheel=$(scripts/build-wheel.sh)

# Interpreters of this machine from 3.10 on, oldest first.
pythons() {
    for version in 3.10 3.11 3.12 3.13 3.14; do
        for python in "$HOME"/.pyenv/versions/"$version".*/bin/python "python$version"; do
            if "$python" -c "import sys; assert sys.version_info[:2] == (${version/./, })" 2>/dev/null; then
                echo "$python"
                break
            fi
        done
    done
}
mapfile -t found < <(pythons)
if [ ${#found[@]} -eq 0 ]; then
    echo 'test-python: no Python from 3.10 on is there' >&2
    exit 1
fi

# A virtual environment with what the tests need, made once, and the wheel, installed anew.
environment() {
    local place=$1 python=$2
    shift 2
    if ! "$place/bin/python" -c '' 2>/dev/null || [ "$(cat "$place/packages" 2>/dev/null)" != "$*" ]; then
        rm -rf "$place"
        "$python" -m venv "$place"
        "$place/bin/pip" install --quiet --disable-pip-version-check "$@"
        echo "$*" >"$place/packages"
    fi
    "$place/bin/pip" uninstall --quiet --disable-pip-version-check --yes fathom-datasets
    "$place/bin/pip" install --quiet --disable-pip-version-check "$wheel"
}

oldest=$target/python/oldest
newest=$target/python/newest
environment "$oldest" "${found[0]}" 'numpy<2' httpx==0.28.1 pytest==9.2.0
environment "$newest" "${found[-1]}" numpy httpx==0.28.1 pytest==9.2.0 mypy==2.4.1 jax==0.12.0.1 onnx==1.23.2 pandas pyarrow nbformat \
    jsonschema==4.26.0 openapi-spec-validator==0.9.0 openapi-python-client==0.29.1 \
    webdataset==1.0.2 datasets==5.2.0 pillow albumentations==2.0.8 pycocotools==2.0.11 mlcroissant==1.1.1 pyyaml==6.0.3 \
    rosbags==0.11.9 av==19.0.2 mcap==1.6.0 mcap-ros2-support==0.6.0 s3fs==2026.9.0 matplotlib==3.11.2

cd bindings/python
export FATHOM=${FATHOM:-$target/release/fathom} PYTHONDONTWRITEBYTECODE=1
"$newest/bin/mypy" --cache-dir "$target/python/mypy"
"$newest/bin/python" --version
"$newest/bin/python" -m pytest -p no:cacheprovider "$@"
# What depends on the version: the native half and the arrays of the oldest NumPy.
cd tests
"$oldest/bin/python" --version
"$oldest/bin/python" -m pytest -p no:cacheprovider test_connection.py test_job.py test_messages.py test_pictures.py test_ros_*.py test_stream.py "$@"
