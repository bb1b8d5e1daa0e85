#!/usr/bin/env bash
# A sweep by GNU parallel: parallel.sh SPEC DIR [JOBS]. Call it again to go on.
# A call that ends with 75, and no other, is made up to three times (again.sh); jobs.log in the folder has times and last exit codes.
set -euo pipefail
spec="$1" out="$2" jobs="${3:-$(nproc)}"
here="$(dirname "$0")"
bench="${BENCH:-$here/../../bench}"

"$bench" plan "$spec" --out "$out" --write
{ "$bench" status "$out" --missing || [ $? -eq 1 ]; } |
  parallel --jobs "$jobs" --joblog "$out/jobs.log" \
    "$here/again.sh" "$bench" sweep "$spec" --out "$out" --index {} --progress none || true
"$bench" sweep "$spec" --out "$out"  # what is missing, and which runs may be compared
