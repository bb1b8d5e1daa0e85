#!/usr/bin/env bash
# One task of slurm.sh: slurm_task.sh BENCH SPEC DIR SHARDS, its number in SLURM_ARRAY_TASK_ID.
set -uo pipefail
bench="$1" spec="$2" out="$3" shards="$4"

# as a step: signals of Slurm go to steps, not to this script
srun --ntasks=1 "$bench" sweep "$spec" --out "$out" --shard "$SLURM_ARRAY_TASK_ID/$shards" --progress plain
code=$?
if [ "$code" -eq 75 ] && [ "${SLURM_RESTART_COUNT:-0}" -lt 100 ]; then
  scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
fi
exit "$code"
