#!/usr/bin/env bash
# A sweep by Snakemake 9: snakemake.sh SPEC DIR SHARDS [SNAKEMAKE OPTIONS...]. Call it again to go on.
# Snakemake and its Slurm plugin are installed into build/snakemake the first time, unless SNAKEMAKE names one.
set -euo pipefail
spec="$(realpath "$1")" out="$(realpath -m "$2")" shards="$3"
shift 3
here="$(cd "$(dirname "$0")" && pwd)" root="$(cd "$(dirname "$0")/../.." && pwd)"
bench="${BENCH:-$root/bench}" snakemake="${SNAKEMAKE:-}"

if [ -z "$snakemake" ]; then
  snakemake="$root/build/snakemake/bin/snakemake"
  if [ ! -x "$snakemake" ]; then
    python3 -m venv "$root/build/snakemake"
    "$root/build/snakemake/bin/pip" install --quiet "snakemake>=9,<10" "snakemake-executor-plugin-slurm>=2,<3"
  fi
fi
mkdir -p "$out"
# In the folder of the records, so that what Snakemake remembers of its jobs lies beside them.
exec "$snakemake" --snakefile "$here/Snakefile" --directory "$out" --rerun-triggers input mtime \
  --config "spec=$spec" "out=$out" "shards=$shards" "bench=$bench" "again=$here/again.sh" "$@"
