#!/usr/bin/env bash
# Makes the three shipped waters again: renders their style photos, trains, and writes models/NAME.{onnx,card.json} and
# models/sheets/NAME.sheet.png, byte for byte the same on every machine. With --check it compares instead of writing.
# Needs a built fathom: cargo build --release.
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
fathom=${FATHOM:-"${CARGO_TARGET_DIR:-"$root/target"}/release/fathom"}
photo_seeds="8 15 21"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for water in atlantic mediterranean muddy; do
    photos=()
    for seed in $photo_seeds; do
        "$fathom" style-photo "$water" --seed "$seed" --out "$work/$water-$seed.png"
        photos+=("$work/$water-$seed.png")
    done
    "$fathom" train "${photos[@]}" --name "$water" --seed 1 --steps 1000 --out "$work/out" \
        --licence "MIT OR Apache-2.0" \
        --source "trained on photos rendered by fathom style-photo $water --seed ${photo_seeds// /, }: no third-party data"
done

cd "$work/out"
mkdir sheets
mv ./*.sheet.png sheets/
if [ "${1:-}" = --check ]; then
    find . -type f | while read -r file; do cmp "$file" "$root/models/$file"; done
    echo "the shipped waters are what this makes"
else
    mkdir -p "$root/models/sheets"
    cp -r ./* "$root/models/"
fi
