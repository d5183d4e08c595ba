#!/usr/bin/env bash
# Trains the waters, byte for byte the same on every machine.
#
#   scripts/train-waters.sh OUT       renders the photos of models/photos, trains, and writes NAME.{onnx,card.json,sheet.png} to OUT
#   scripts/train-waters.sh --shipped trains the shipped networks again, with the version that made them, and compares
#
# The first needs a built fathom: cargo build --release.
set -euo pipefail

# The last version with the photos that the shipped networks were trained on; docs/science/style-training.md says why they are kept.
made_by=242d1e64937b0d965948ce33a28679149af2cd77
root=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)

if [ "${1:?a folder, or --shipped}" = --shipped ]; then
    trap 'git -C "$root" worktree remove --force "$work/made"; rm -rf "$work"' EXIT
    git -C "$root" worktree add --detach "$work/made" "$made_by"
    cd "$work/made"
    CARGO_TARGET_DIR=$work/target cargo build --release --bin fathom
    FATHOM=$work/target/release/fathom scripts/train-waters.sh --check
    diff -r --exclude photos --exclude sheets --exclude "atlantic-range.*" models "$root/models"
    exit
fi

trap 'rm -rf "$work"' EXIT
fathom=${FATHOM:-"${CARGO_TARGET_DIR:-"$root/target"}/release/fathom"}
for water in atlantic mediterranean muddy atlantic-range; do
    range=()
    if [ "$water" = atlantic-range ]; then range=(--range); fi
    "$fathom" render "$root/models/photos/$water.json" --out "$work/$water"
    "$fathom" train "$work/$water"/*/rgb.png --name "$water" "${range[@]}" --seed 1 --steps 1000 --out "$1" \
        --licence "MIT OR Apache-2.0" \
        --source "trained on photos rendered by fathom render models/photos/$water.json: no third-party data"
done
