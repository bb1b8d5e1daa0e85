#!/usr/bin/env bash
# A sweep as a job array of Slurm: slurm.sh SPEC DIR SHARDS [SBATCH OPTIONS...]. Call it again to go on.
# Each task of the array makes a share of the runs one after the other. A minute before its time is over Slurm sends SIGTERM: the
# run that is going on keeps a checkpoint, the task ends with 75 and puts itself into the queue again.
set -euo pipefail
spec="$1" out="$2" shards="$3"
shift 3
bench="${BENCH:-$(cd "$(dirname "$0")/../.." && pwd)/bench}"

"$bench" plan "$spec" --out "$out" --write
mkdir -p "$out/log"
task="$(dirname "$(readlink -f "$0")")/slurm_task.sh"
array=$(sbatch --parsable --array="1-$shards" --cpus-per-task=1 --signal=TERM@60 --requeue --open-mode=append \
  --output="$out/log/%a.txt" "$@" "$task" "$bench" "$spec" "$out" "$shards")
sbatch --dependency="afterok:${array%%;*}" --cpus-per-task=1 --output="$out/log/end.txt" "$@" \
  --wrap="'$bench' sweep '$spec' --out '$out' --progress none"
