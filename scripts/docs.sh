#!/usr/bin/env bash
# Measures again the figures of docs/science/table1.md and docs/science/enhancement-stability.md and draws the pictures of the
# guide, below target/docs. Times are of the machine it runs on: keep it quiet. scripts/write_webp.py converts them.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --release --locked --bin fathom --bin fathom-lab
fathom=target/release/fathom
lab=target/release/fathom-lab
work=target/docs
rm -rf "$work" && mkdir -p "$work"

"$fathom" demo --out "$work/demo"

"$fathom" reproduce --out "$work/reproduce"

"$lab" experiment stability --set scenes=8 --out "$work/stability"
cp "$work/stability/stability-cells.csv" docs/science/data/stability.csv
for pictures in camera suspended sequence wall families ladder sites; do
    "$lab" experiment "$pictures" --out "$work/pictures"
done
