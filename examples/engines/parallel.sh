#!/usr/bin/env bash
# Renders a set with several processes on this machine, by GNU parallel if it is there, else by xargs.
# For several machines: parallel --sshlogin host1,host2 --env JOB --env SET …
# Usage: JOB=job.json SET=/mnt/reef/tour parallel.sh [PARTS]
set -eu
parts=${1:-$(nproc)}
shard=$(cd "$(dirname "$0")" && pwd)/shard.sh
parts() { seq 0 $((parts - 1)) | sed "s|$|/$parts|"; }
if parallel --version 2>/dev/null | grep -q '^GNU parallel'; then
    parts | parallel --jobs "$parts" bash "$shard" {}
else
    parts | xargs -P "$parts" -I{} bash "$shard" {}
fi
