#!/usr/bin/env bash
# Makes the measured pages and pictures of docs/ again. Times in them are of the machine it runs on: keep it quiet.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --release --locked --bin fathom --bin fathom-lab
fathom=target/release/fathom
lab=target/release/fathom-lab
work=target/docs
rm -rf "$work" && mkdir -p "$work/frames" docs/table1 docs/stability

"$fathom" demo --out "$work/demo"
cp "$work/demo/contact-sheet.png" docs/pictures/tour.png

"$fathom" render examples/table1.json --out "$work/table1"
for frame in "$work"/table1/*/; do
    cp "$frame/rgb.png" "$work/frames/$(basename "$frame").png"
done
"$lab" table1 "$work/frames" --out docs/table1

"$lab" stability --enhance --scenes 8 --out "$work/stability"
cp "$work"/stability/*.png "$work"/stability/stability.{md,csv} docs/stability/
