#!/usr/bin/env bash
# A sweep by GNU parallel: parallel.sh SPEC DIR [JOBS]. Call it again to go on.
# A call that ends with 75 is tried three times; jobs.log in the folder has all calls with times and exit codes.
set -euo pipefail
spec="$1" out="$2" jobs="${3:-$(nproc)}"
bench="${BENCH:-$(dirname "$0")/../../bench}"

"$bench" plan "$spec" --out "$out" --write
{ "$bench" status "$out" --missing || [ $? -eq 1 ]; } |
  parallel --jobs "$jobs" --joblog "$out/jobs.log" --retries 3 \
    "$bench" sweep "$spec" --out "$out" --index {} --progress none || true
"$bench" sweep "$spec" --out "$out"  # what is missing, and which runs may be compared
