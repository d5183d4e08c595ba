#!/usr/bin/env bash
# Compares a binary with what the binary before the last rebuild did: some 300 small jobs frame by frame, the OpenAPI
# document, a data folder with the responses to 1466 queries, the options of the command line.
#
#   scripts/proof.sh --check [PART…]   print the differences; exit status 1 on one that tests/proof/expected.txt does not name
#   scripts/proof.sh --make [PART…]    write the reference data in tests/proof anew
#
# Parts: frames, openapi, catalogue, words. FATHOM names the binary (target/release/fathom unless said otherwise).
set -euo pipefail
cd "$(dirname "$0")/.."
export PYTHONDONTWRITEBYTECODE=1
exec python3 scripts/proof "$@"
