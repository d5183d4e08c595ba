#!/usr/bin/env bash
# Measures again what docs/charts.md, docs/campaign, docs/stability-chain.md, docs/ladder and docs/speed.md show. About fifteen
# minutes on a quiet machine with four cores; times are of the machine it runs on.
set -euo pipefail
cd "$(dirname "$0")/.."
target=${CARGO_TARGET_DIR:-target}
cargo build --release --locked --bin fathom-lab
lab=$target/release/fathom-lab
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$lab" bench render --out docs
"$lab" chart --runs 9 --out "$work/charts"
"$lab" campaign --out docs/campaign
"$lab" stability --chain --out docs
for water in jerlov-IB jerlov-1C jerlov-3C; do
    "$lab" ladder --water "$water" --out "docs/ladder/$water.png"
done

# Every drawing of the structure, and of the other scenes those of forward scatter and of the frame.
rm -rf docs/charts && mkdir -p docs/charts
for kind in svg png; do
    cp "$work"/charts/*-structure*."$kind" "$work"/charts/cost-*."$kind" docs/charts/
    for scene in wall slope pole holes; do
        cp "$work/charts/forward_scatter-$scene.$kind" "$work/charts/frame-$scene.$kind" docs/charts/
    done
done
cp "$work"/charts/{chart.json,chart.csv,machine.json,figures.md} docs/charts/
