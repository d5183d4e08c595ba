#!/usr/bin/env bash
# Measures again what docs/science/accuracy.md, stability.md and speed.md show, below target/docs, and copies the charts. About fifteen
# minutes on a quiet machine with four cores; times are of the machine it runs on.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --release --locked --bin fathom-lab
lab=${CARGO_TARGET_DIR:-target}/release/fathom-lab
work=target/docs
charts=docs/science/charts
mkdir -p "$work"

"$lab" bench render --out "$work"
"$lab" chart --runs 9 --out "$work/charts"
"$lab" campaign --out "$work/campaign"
"$lab" stability --chain --out "$work"
"$lab" ladder --water jerlov-1C --out "$work/ladder.png"
"$lab" waters --no-scenes --out "$work/waters"

cp "$work"/charts/{forward_scatter,frame,haze,homomorphic,ibla,lamps,style}-structure.svg "$work"/charts/cost-*.svg \
    "$work"/campaign/campaign-*.svg "$work"/waters/{transmittance,daylight,visibility-range,visibility-turbidity}.svg "$charts"
cp "$work"/charts/{chart.csv,machine.json} docs/science/data/
