#!/usr/bin/env bash
# Fuzzes everything that reads bytes from outside: `scripts/fuzz.sh [RUNS] [TARGET…]` runs each target (all, unless some
# are named) RUNS times (20000, unless said otherwise) with coverage feedback, from the seeds in fuzz/seeds and what
# earlier runs found in fuzz/corpus. A crash stops it and leaves the input in fuzz/artifacts.
set -euo pipefail
cd "$(dirname "$0")/.."
runs=${1:-20000}
shift || true
tools=$PWD/target/tools
if [ ! -x "$tools/bin/cargo-fuzz" ]; then
    cargo install cargo-fuzz --version 0.13.2 --locked --quiet --root "$tools"
fi
# Coverage and the address sanitizer are behind unstable compiler flags; this admits them with the toolchain at hand.
export RUSTC_BOOTSTRAP=1 PATH="$tools/bin:$PATH"
targets=("$@")
if [ ${#targets[@]} -eq 0 ]; then
    mapfile -t targets < <(cargo fuzz list)
fi
for target in "${targets[@]}"; do
    mkdir -p "fuzz/corpus/$target" "fuzz/seeds/$target"
    cargo fuzz run --release --debug-assertions "$target" "fuzz/corpus/$target" "fuzz/seeds/$target" -- \
        -runs="$runs" -max_len=65536 -timeout=20 -rss_limit_mb=3000 -print_final_stats=1 -verbosity=0 2>&1 |
        grep -E "^(stat::(number_of_executed_units|average_exec)|==|SUMMARY|thread|panicked|artifact_prefix|Test unit)|panicked at|ERROR" |
        sed "s/^/$target: /"
done
