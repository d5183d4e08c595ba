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

for experiment in chart campaign chain families ladder; do
    "$lab" experiment "$experiment" --out "$work/$experiment"
done

cp "$work"/chart/{forward_scatter,frame,ibla,lamps,style}-structure.svg "$work/campaign/campaign-bound.svg" "$charts"
cp "$work/chart/chart.csv" docs/science/data/
