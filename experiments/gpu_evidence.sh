#!/usr/bin/env bash
# Evidence from a card, in one run of under ten minutes behind the build: device tests, compute-sanitizer, rates of copies
# and kernels, the drape at 82 thousand and a million vertices, the memory run of 184 million contacts. One JSON.
# All talk goes to stderr, the name of the JSON to stdout. Exit codes: 0 a record was written (what failed is in it), 2 wrong
# usage, 3 no usable card, 70 the program does not build.
set -euo pipefail

usage() {
  cat <<'EOF'
usage: experiments/gpu_evidence.sh [--out FOLDER] [--records FOLDER]

  --out FOLDER       where the raw files go (default: results/runs/gpu_evidence/<UTC time>)
  --records FOLDER   where the record goes (default: results/gpu)

The record is kept as results/gpu/<card>-<day>.json; commit it, and ./bench gpu-report makes results/GPU.md of all of them.
Found by themselves and left out with a word where they are not: compute-sanitizer, ncu (Nsight Compute), nvidia-smi.
EOF
}

root="$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)"
out="$root/results/runs/gpu_evidence/$(date -u +%Y-%m-%dT%H%M%SZ)"
records="$root/results/gpu"
while [ "$#" -gt 0 ]; do
  case "$1" in
    --out)
      [ "$#" -ge 2 ] || { usage >&2; exit 2; }
      out="$2"
      shift 2
      ;;
    --records)
      [ "$#" -ge 2 ] || { usage >&2; exit 2; }
      records="$2"
      shift 2
      ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && exit 2 ;;
  esac
done

say() { printf 'gpu_evidence: %s\n' "$*" >&2; }
bench="${BARRIERBENCH_BENCH:-$root/bench}"
build="$root/build/release"
tests="${BARRIERBENCH_DEVICE_TESTS:-$build/tests/standin/test_device}"
mkdir -p "$out/logs"
: >"$out/parts.tsv"

# part NAME SECONDS COMMAND...: runs it with a time limit; its output is kept and its verdict written to parts.tsv.
part() {
  local name="$1" limit="$2" start="$SECONDS" code=0 status=passed
  shift 2
  say "$name"
  timeout --kill-after=10 "$limit" "$@" >"$out/logs/$name.out" 2>"$out/logs/$name.err" || code="$?"
  case "$code" in 0) ;; 124 | 137) status=timed_out ;; *) status=failed ;; esac
  [ "$status" = passed ] || say "  $status (exit code $code): $(tail -n 1 "$out/logs/$name.err")"
  printf '%s\t%s\t%s\t%s\n' "$name" "$status" "$code" "$((SECONDS - start))" >>"$out/parts.tsv"
}
# without NAME WHY: a part that cannot be run here.
without() {
  say "$1: left out, $2"
  printf '%s\tleft_out\t%s\t0\n' "$1" "$2" >>"$out/parts.tsv"
}
tool() { command -v "$1" 2>/dev/null || { [ -x "/usr/local/cuda/bin/$1" ] && printf '/usr/local/cuda/bin/%s\n' "$1"; }; }

# ---------------------------------------------------------------- the card

if [ -z "${BARRIERBENCH_BENCH:-}" ]; then
  "$bench" build release >&2 || exit 70
fi
verdict=0
"$bench" device --json --measure >"$out/device.json" 2>"$out/logs/device.err" || verdict="$?"
if [ "$verdict" -ne 0 ]; then
  say "$("$bench" device 2>&1 | tail -n 1)"
  exit 5
fi
if smi="$(tool nvidia-smi)"; then
  "$smi" --format=csv,nounits --query-gpu=name,driver_version,clocks.sm,clocks.max.sm,clocks.mem,clocks.max.mem,power.limit,ecc.mode.current,temperature.gpu \
    --id=0 >"$out/card.csv" 2>/dev/null || rm -f "$out/card.csv"
fi

# ---------------------------------------------------------------- correctness

part device_tests 30 "$tests"
if sanitizer="$(tool compute-sanitizer)"; then
  for check in memcheck racecheck initcheck; do
    part "$check" 40 "$sanitizer" --tool "$check" --error-exitcode 9 "$tests"
  done
else
  for check in memcheck racecheck initcheck; do without "$check" "compute-sanitizer was not found"; done
fi

# ---------------------------------------------------------------- scenes and kernels

# run_scene NAME SECONDS [ARGUMENTS]
run_scene() {
  local name="$1" limit="$2"
  shift 2
  part "$name" "$((limit + 10))" "$bench" run "$root/configs/gpu/${name%%.*}.json" --set '/device="cuda"' --out "$out/$name" \
    --time-limit "$limit" --progress none "$@"
}
run_scene drape_82k 40
run_scene drape_1m 60
run_scene dense_184m 120
export BARRIERBENCH_KERNEL_TIMES="$out/kernel_times.json"
run_scene drape_82k.timed 40 --set /time/steps=1
unset BARRIERBENCH_KERNEL_TIMES
if ncu="$(tool ncu)"; then
  part kernels 60 "$ncu" --csv --print-units base --metrics gpu__time_duration.sum,dram__bytes.sum --launch-count 500 \
    "$bench" run "$root/configs/gpu/drape_82k.json" --set '/device="cuda"' --set /time/steps=1 --out "$out/drape_82k.ncu" --progress none
else
  without kernels "ncu was not found"
fi

"$root/.venv/bin/python" -m barrierbench_analysis.gpu_evidence "$out" --commit "$(git -C "$root" rev-parse HEAD 2>/dev/null || true)" \
  --seconds "$SECONDS" --records "$records"
