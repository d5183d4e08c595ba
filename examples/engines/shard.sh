#!/usr/bin/env bash
# Renders one part of a set. Exit status 5 (the store is away) is tried again after a pause, every other is handed on.
# Usage: JOB=job.json SET=s3://reef/tour shard.sh I/N [OPTIONS OF fathom render]
set -u
part=$1
shift
for _ in $(seq "${TRIES:-60}"); do
    "${FATHOM:-fathom}" render "$JOB" --out "$SET" --shard "$part" --slots "${SLOTS:-1}" "$@"
    status=$?
    if [ $status -ne 5 ]; then
        exit $status
    fi
    sleep "${PAUSE_S:-30}"
done
exit 5
