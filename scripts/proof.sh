#!/usr/bin/env bash
# Compares a binary with the reference data in tests/proof: the frames of some 50 small jobs, the OpenAPI document, and the words of
# errors, options and listings.
#
#   scripts/proof.sh --check [PART…]   print the differences; exit status 1 on any
#   scripts/proof.sh --make [PART…]    write the reference data again
#
# Parts: frames, openapi, words. FATHOM names the binary (target/release/fathom unless given).
set -euo pipefail
cd "$(dirname "$0")/.."
export PYTHONDONTWRITEBYTECODE=1
exec python3 scripts/proof "$@"
