#!/usr/bin/env bash
# Compares a fresh service with its own OpenAPI document: schemathesis makes requests from the document, right and wrong
# ones, and looks for responses that it does not describe. Takes at most three minutes after the build.
#
#   scripts/check-openapi.sh [requests per operation, default 10] [further options of `schemathesis run`]
set -euo pipefail
cd "$(dirname "$0")/.."
examples=${1:-10}
[ $# -gt 0 ] && shift

target=${CARGO_TARGET_DIR:-$PWD/target}
tool=$target/schemathesis/bin
if [ ! -x "$tool/schemathesis" ]; then
    python3 -m venv "$target/schemathesis"
    "$tool/pip" install --quiet 'schemathesis==4.32.5'
fi
cargo build --release --locked --bin fathom

folder=$(mktemp -d)
service=
stop() {
    if [ -n "$service" ]; then
        kill "$service" 2>/dev/null || true
        wait "$service" 2>/dev/null || true
        service=
    fi
}
trap 'stop; rm -rf "$folder"' EXIT

# Starts the service with this many workers and puts its address into `url`.
start() {
    : >"$folder/listens"
    FATHOM_TOKEN=check FATHOM_LOG=warn "$target/release/fathom" serve --listen 127.0.0.1:0 \
        --data "$folder/data" --workers "$1" 2> >(tee -a "$folder/log" >>"$folder/listens") &
    service=$!
    url=
    for _ in $(seq 100); do
        url=$(sed -n 's/^fathom listens on //p' "$folder/listens")
        [ -n "$url" ] && return
        sleep 0.1
    done
    cat "$folder/log"
    exit 1
}

# Something to look at: finished jobs, whose names the requests below use half of the time.
start 1
jobs=
for number in 1 2 3 4 5 6 7 8; do
    response=$(curl -sS "$url/v1/jobs" -H 'Authorization: Bearer check' -H 'Content-Type: application/json' -d "{
        \"dataset\": \"set-$number\", \"count\": 2, \"camera\": {\"width\": 32, \"height\": 24, \"hfov_deg\": 80},
        \"scene\": {\"kind\": \"procedural\", \"family\": \"structure\", \"seed\": $number}}")
    job=$(printf %s "$response" | python3 -c 'import json, sys; print(json.load(sys.stdin)["id"])')
    curl -sS -o /dev/null "$url/v1/jobs/$job?wait=30" -H 'Authorization: Bearer check'
    jobs="$jobs\"$job\", "
done
stop

cat >"$folder/schemathesis.toml" <<END
[dictionaries]
jobs = { values = [$jobs] }
sets = { values = ["set-1", "set-2", "set-3", "set-4", "set-5", "set-6", "set-7", "set-8"] }
kinds = { values = ["rgb"] }
frames = { values = [0, 1] }
[parameters]
"path.id" = { dictionary = "jobs", probability = 0.5 }
"path.job" = { dictionary = "jobs", probability = 0.5 }
"path.frame" = { dictionary = "frames", probability = 0.5 }
"path.kind" = { dictionary = "kinds", probability = 0.5 }
"path.name" = { dictionary = "sets", probability = 0.5 }
END

# No workers: what random jobs would render is not the matter here, and nothing waits for them.
# Left out: event streams, which go on for as long as a job does, and `positive_data_acceptance`, since a schema cannot say all that a description must fulfill.
start 0
status=0
(cd "$folder" && "$tool/schemathesis" run "$url/openapi.json" \
    --header 'Authorization: Bearer check' --header 'Prefer: wait=0' \
    --exclude-path-regex 'events$' \
    --exclude-checks positive_data_acceptance --suppress-health-check all --warnings off \
    --max-examples "$examples" --max-time 150 --workers 2 --request-timeout 70 --continue-on-failure "$@") || status=$?
if grep -E 'ERROR|panicked' "$folder/log"; then
    echo 'the service logged faults'
    status=1
fi
exit $status
