#!/usr/bin/env bash
# Evidence from a card: tests of every kernel beside the host, compute-sanitizer, runs beside the host executor's, rates of
# copies and kernels, timed scenes, the memory run of 8.2 million vertices. One JSON.
# All talk goes to stderr, the name of the JSON to stdout. Exit codes: 0 a record was written (what failed is in it), 2 wrong
# usage, 5 no usable card, 70 the program does not build.
set -euo pipefail

usage() {
  cat <<'HELP'
usage: experiments/gpu_evidence.sh [--out FOLDER] [--records FOLDER] [--only GROUPS]
       experiments/gpu_evidence.sh --bundle FOLDER

  --out FOLDER       where the raw files go (default: results/runs/gpu_evidence/<UTC time>); calls with the same folder and
                     other --only add to it, if they are of the same commit
  --records FOLDER   where the record goes (default: results/gpu)
  --only GROUPS      of: tests, sanitizer, same, catalogue, scenes, memory, kernels; separated by commas (default: all)
  --bundle FOLDER    builds, and puts all that the evidence needs into FOLDER: this script, programs, their libraries,
                     configs. FOLDER/gpu_evidence.sh then runs on a machine that has a card and a driver and nothing else
                     of ours; it leaves the raw files, and `python -m analysis.gpu_evidence RAW` makes the record here.

The record is kept as results/gpu/<card>-<day>.json; commit it, and ./bench gpu-report makes results/GPU.md of all records.
Found by themselves and left out with a word where they are not: compute-sanitizer, ncu (Nsight Compute), nvidia-smi.
HELP
}

here="$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")" && pwd)"
if [ -e "$here/bin/barrierbench" ]; then  # a bundle
  root="$here" bench="$here/bench" tests="$here/bin"
else
  root="$(dirname "$here")" bench="$root/bench" tests="$root/build/release/tests"
fi
out="$root/results/runs/gpu_evidence/$(date -u +%Y-%m-%dT%H%M%SZ)"
records="$root/results/gpu"
only=tests,sanitizer,same,catalogue,scenes,memory,kernels
bundle=""
while [ "$#" -gt 0 ]; do
  case "$1" in
    --out | --records | --only | --bundle)
      [ "$#" -ge 2 ] || { usage >&2; exit 2; }
      declare "${1#--}=$2"
      shift 2
      ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && exit 2 ;;
  esac
done
for group in ${only//,/ } ""; do
  case "$group" in
    tests | sanitizer | same | catalogue | scenes | memory | kernels) ;;
    "") [ -n "${only//,/}" ] || { usage >&2; exit 2; } ;;
    *)
      printf 'gpu_evidence: --only %s: of tests, sanitizer, same, catalogue, scenes, memory, kernels\n' "$group" >&2
      exit 2
      ;;
  esac
done
if [ "$here" = "$root" ] && [ -n "$bundle" ]; then
  printf 'gpu_evidence: --bundle: this is a bundle; one is made in a checkout\n' >&2
  exit 2
fi
bench="${BARRIERBENCH_BENCH:-$bench}"
tests="${BARRIERBENCH_DEVICE_TESTS:-$tests}"

say() { printf 'gpu_evidence: %s\n' "$*" >&2; }
rooms="sums linear elements contact system runs"

# write_minis FOLDER: the configs of the catalogue at their small size, without those that are refused.
write_minis() {
  mkdir -p "$1"
  for file in "$root"/configs/catalogue/*.json; do
    local name
    name="$(basename "$file" .json)"
    case "$name" in intersect-*) continue ;; esac
    "$bench" scenes "$name" --write "$1/$name.json" >&2
  done
}

if [ -n "$bundle" ]; then
  "$bench" build release >&2 || exit 70
  build="$root/build/release"
  mkdir -p "$bundle/bin" "$bundle/lib" "$bundle/configs"
  for program in experiments/barrierbench tests/standin/test_device $(cd "$build" && ls tests/standin/test_formula_log tests/standin/test_formula_functions 2>/dev/null) $(printf 'tests/card/test_card_%s ' $rooms); do
    strip -o "$bundle/bin/$(basename "$program")" "$build/$program"
  done
  ldd "$bundle"/bin/* | awk '$2 == "=>" && $3 ~ /^\// { print $3 }' | sort -u |
    grep -Ev '/(libc|libm|libdl|librt|libpthread|ld-linux[^/]*)\.so' | xargs -I{} cp -L {} "$bundle/lib/"
  cp -r "$root/configs/." "$bundle/configs/"
  write_minis "$bundle/minis"
  cp "${BASH_SOURCE[0]}" "$bundle/gpu_evidence.sh"
  git -C "$root" rev-parse HEAD >"$bundle/commit" 2>/dev/null || true
  printf '#!/bin/sh\nhere="$(dirname "$(readlink -f "$0")")"\nexport LD_LIBRARY_PATH="$here/lib" BARRIERBENCH_CONFIGS="$here/configs"\nexec "$here/bin/barrierbench" "$@"\n' >"$bundle/bench"
  chmod +x "$bundle/bench"
  say "$(du -sh "$bundle" | cut -f 1) in $bundle"
  exit 0
fi
if [ -d "$root/lib" ]; then export LD_LIBRARY_PATH="$root/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"; fi
wanted() { [[ ",$only," == *",$1,"* ]]; }
mkdir -p "$out/logs"
commit="$(cat "$root/commit" 2>/dev/null || git -C "$root" rev-parse HEAD 2>/dev/null || true)"
if [ -e "$out/commit" ] && [ "$(cat "$out/commit")" != "$commit" ]; then
  say "$out has raw files of commit $(cat "$out/commit"): another folder for $commit"
  exit 2
fi
printf '%s\n' "$commit" >"$out/commit"
touch "$out/parts.tsv"

# part NAME SECONDS COMMAND...: runs it with a time limit; its output is kept and its verdict written to parts.tsv.
part() {
  local name="$1" limit="$2" start="$SECONDS" code=0 status=passed
  shift 2
  say "$name"
  timeout --kill-after=10 "$limit" "$@" >"$out/logs/$name.out" 2>"$out/logs/$name.err" || code="$?"
  case "$code" in 0) ;; 124 | 137) status=timed_out ;; *) status=failed ;; esac
  [ "$status" = passed ] || say "  $name: $status (exit code $code): $(tail -n 1 "$out/logs/$name.err")"
  printf '%s\t%s\t%s\t%s\n' "$name" "$status" "$code" "$((SECONDS - start))" >>"$out/parts.tsv"
}
# without NAME WHY: a part that cannot be run here.
without() {
  say "$1: left out, $2"
  printf '%s\tleft_out\t%s\t0\n' "$1" "$2" >>"$out/parts.tsv"
}
tool() { command -v "$1" 2>/dev/null || { [ -x "/usr/local/cuda/bin/$1" ] && printf '/usr/local/cuda/bin/%s\n' "$1"; }; }
# test_of ROOM: the program of its tests.
test_of() { find "$tests" -name "test_card_$1" -type f | head -n 1; }

# ---------------------------------------------------------------- the card

if [ -z "${BARRIERBENCH_BENCH:-}" ] && [ "$bench" = "$root/bench" ] && [ ! -e "$root/bin" ]; then
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

if wanted tests; then
  part device_tests 60 "$(find "$tests" -name test_device -type f | head -n 1)" &
  for sample in log functions; do
    found="$(find "$tests" -name "test_formula_$sample" -type f | head -n 1)"  # none with a CUDA before 12.8
    if [ -n "$found" ]; then part "formula_$sample" 60 "$found" & fi
  done
  for room in $rooms; do part "card_$room" 240 "$(test_of "$room")" & done
  wait
fi
if wanted sanitizer; then
  if sanitizer="$(tool compute-sanitizer)"; then
    for check in memcheck racecheck initcheck synccheck; do
      runs='*HaveTheBitsOfTheHost/0'
      [ "$check" != racecheck ] || runs='CardRuns.FewStepsHaveTheBitsOfTheHost'  # it slows a run down the most
      part "$check" 150 "$sanitizer" --tool "$check" --error-exitcode 9 "$(test_of runs)" --gtest_filter="$runs" &
    done
    wait
  else
    for check in memcheck racecheck initcheck synccheck; do without "$check" "compute-sanitizer was not found"; done
  fi
fi

# ---------------------------------------------------------------- the same run on card and host

# same_run NAME FILE [ARGUMENTS]: on the card and by the kernels of the host executor; both have to end with the same bits.
same_run() {
  local name="$1" config="$2" device
  shift 2
  for device in cuda host; do
    part "same_$name.$device" 100 "$bench" run "$config" --set "/device=\"$device\"" --set '/linear_solver={"name": "pcg_resident"}' \
      --set '/passes={"time": true, "audit": true}' --set /threads=2 --out "$out/same/$name.$device" --replace --progress none "$@"
  done
}
if wanted same; then
  for formulation in log cubic quadratic cubic_dynamic_lagged ipc2020; do
    same_run "drape_$formulation" "$root/configs/scenes/drape.json" --set /scene/n=16 --set /time/steps=15 --set "/formulation=\"$formulation\"" &
  done
  for scene in strip_on_disk sphere_on_sheet sheets_on_ball noodle solid_ball solid_stack solid_limit twist_cloth hang balloon bounce curtain_wind friction_slope; do
    same_run "$scene" "$root/configs/scenes/$scene.json" --set /time/steps=20 &
  done
  same_run dense_patch "$root/configs/gpu/dense_patch.json" &
  wait
fi

if wanted catalogue; then
  minis="$root/minis"
  if [ ! -d "$minis" ]; then
    minis="$out/minis"
    write_minis "$minis"
  fi
  for file in "$minis"/*.json; do same_run "catalogue_$(basename "$file" .json)" "$file" --set /time/steps=8 & done
  wait
fi

# ---------------------------------------------------------------- scenes and kernels

# run_scene NAME SECONDS [ARGUMENTS]: configs/gpu/NAME.json, NAME up to a point.
run_scene() {
  local name="$1" limit="$2"
  shift 2
  part "$name" "$((limit + 10))" "$bench" run "$root/configs/gpu/${name%%.*}.json" --set '/device="cuda"' --out "$out/$name" --replace \
    --time-limit "$limit" --progress none "$@"
}
on_cpu() { run_scene "$1.cpu" "$2" --set '/device="cpu"' --set "/linear_solver={\"name\": \"$3\"}"; }
if wanted scenes; then
  run_scene drape_82k 40
  on_cpu drape_82k 60 pcg
  run_scene drape_1m 60
  run_scene dense_500k 60
  run_scene drape_20k 60
  on_cpu drape_20k 120 cholmod
fi
if wanted memory; then run_scene dense_8m 150; fi
if wanted kernels; then
  export BARRIERBENCH_KERNEL_TIMES="$out/kernel_times.json"
  run_scene drape_82k.timed 40 --set /time/steps=1
  unset BARRIERBENCH_KERNEL_TIMES
  if ncu="$(tool ncu)"; then
    part kernels 60 "$ncu" --csv --print-units base --clock-control none --metrics gpu__time_duration.sum,dram__bytes.sum --launch-count 500 \
      "$bench" run "$root/configs/gpu/drape_82k.json" --set '/device="cuda"' --set /time/steps=1 --out "$out/drape_82k.ncu" --replace --progress none
  else
    without kernels "ncu was not found"
  fi
fi

printf '%s\n' "$((SECONDS + $(cat "$out/seconds" 2>/dev/null || echo 0)))" >"$out/seconds"
if [ "$root" = "$here" ]; then
  printf '%s\n' "$out"
  exit 0
fi
"$root/.venv/bin/python" -m barrierbench_analysis.gpu_evidence "$out" --records "$records"
