#!/usr/bin/env bash
# Evidence from a card: tests of every kernel beside the host, compute-sanitizer, runs beside the host executor's, rates of
# copies and kernels, timed scenes, the memory run of 8.2 million vertices. One JSON.
# All talk goes to stderr, the name of the JSON to stdout.
set -euo pipefail

usage() {
  cat <<'HELP'
usage: experiments/gpu_evidence.sh [--out FOLDER] [--records FOLDER] [--only GROUPS]
       experiments/gpu_evidence.sh --lease [--out FOLDER] [--archives FOLDER] [--seconds N] [--dry]
       experiments/gpu_evidence.sh --bundle FOLDER [--before COMMIT]

  --out FOLDER       where the raw files go (default: results/runs/gpu_evidence/<UTC time>); calls with the same folder and
                     other --only add to it, if they are of the same commit
  --records FOLDER   where the record goes (default: results/gpu)
  --only GROUPS      of: tests, sanitizer, same, catalogue, scenes, memory, kernels; separated by commas (default: all)
  --lease            the stages of a card that is lent for ten minutes (docs/device.md, Ten minutes of a card), each with its own
                     time limit; after each of them its files are an archive
  --archives FOLDER  where the archives go, at most 8 of 16 MiB each (default: archives in the folder of --out)
  --seconds N        time of the lease, from 60 to 3600 (default: 540)
  --dry              a lease without a card: the host executor, tiny scenes; no record is made of its files
  --bundle FOLDER    builds, and puts all that the evidence needs into FOLDER, which is new or empty: this script, programs, their libraries,
                     configs. FOLDER/gpu_evidence.sh then runs on a machine that has a card and a driver and nothing else
                     of ours; it leaves the raw files, and `python -m barrierbench_analysis.studies.device.gpu_evidence RAW` makes the record here.
                     FOLDER.tar.xz is the same as one archive, below 64 MiB
  --before COMMIT    the program of that commit goes along, for runs before and after a change (default: the commit before this
                     one; none: without)

The record is kept as results/gpu/<card>-<day>.json; commit it, and ./bench study gpu-report makes results/GPU.md of all records.
Exit codes: 0 a record was written or a lease ended (what failed is in it), 1 no stage of a lease passed, 2 wrong usage, 5 no card
can be used here (a lease with --dry needs none), 70 the program does not build.
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
bundle="" before=HEAD~1 lease="" dry="" archives="" seconds=540 given=" "
refuse() { printf 'gpu_evidence: %s\n' "$*" >&2; exit 2; }
while [ "$#" -gt 0 ]; do
  case "$1" in
    --lease | --dry)
      declare "${1#--}=yes"
      given+="$1 "
      shift
      ;;
    --out | --records | --only | --bundle | --before | --archives | --seconds)
      [ "$#" -ge 2 ] || { usage >&2; exit 2; }
      [ -n "$2" ] || [ "$1" = --only ] || refuse "$1 \"\": the value is empty; allowed: what --help says of $1"
      declare "${1#--}=$2"
      given+="$1 "
      shift 2
      ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && exit 2 ;;
  esac
done
groups="tests, sanitizer, same, catalogue, scenes, memory, kernels"
for group in ${only//,/ } ""; do
  case "$group" in
    tests | sanitizer | same | catalogue | scenes | memory | kernels) ;;
    "") [ -n "${only//,/}" ] || refuse "--only \"$only\": of $groups" ;;
    *)
      refuse "--only $group: of $groups"
      ;;
  esac
done
if [[ ! "$seconds" =~ ^[0-9]{1,9}$ ]] || [ "$((10#$seconds))" -lt 60 ] || [ "$((10#$seconds))" -gt 3600 ]; then
  refuse "--seconds $seconds: an integer from 60 to 3600"
fi
seconds="$((10#$seconds))"
# needs MODE OPTION..., excludes MODE OPTION...: options that mean nothing without a mode, and with it.
is_given() { [[ "$given" == *" $1 "* ]]; }
needs() {
  local option
  for option in "${@:2}"; do
    if is_given "$option" && ! is_given "$1"; then refuse "$option means nothing without $1; allowed: $1 and $option together"; fi
  done
}
excludes() {
  local option
  for option in "${@:2}"; do
    if is_given "$option" && is_given "$1"; then refuse "$option means nothing with $1; allowed: one of the two"; fi
  done
}
needs --lease --seconds --archives --dry
needs --bundle --before
excludes --lease --bundle --only --records
excludes --bundle --only --records --out
if [ "$here" = "$root" ] && [ -n "$bundle" ]; then refuse "--bundle $bundle: this is a bundle; one is made in a checkout"; fi
bench="${BARRIERBENCH_BENCH:-$bench}"
tests="${BARRIERBENCH_DEVICE_TESTS:-$tests}"

. "$here/card/parts.sh"

if [ -n "$bundle" ]; then
  . "$here/card/bundle.sh"
  check_bundle
  make_bundle
  exit 0
fi
if [ -d "$root/lib" ]; then export LD_LIBRARY_PATH="$root/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"; fi
wanted() { [[ ",$only," == *",$1,"* ]]; }
if [ -z "${BARRIERBENCH_BENCH:-}" ] && [ "$bench" = "$root/bench" ] && [ ! -e "$root/bin" ]; then
  "$bench" build release >&2 || exit 70
fi
no_card() {
  say "$("$bench" device 2>&1 | tail -n 1)"
  exit 5
}
if [ -n "$lease" ] && [ -z "$dry" ]; then "$bench" device >/dev/null 2>&1 || no_card; fi
mkdir -p "$out/logs"
commit="$(cat "$root/commit" 2>/dev/null || git -C "$root" rev-parse HEAD 2>/dev/null || true)"
if [ -e "$out/commit" ] && [ "$(cat "$out/commit")" != "$commit" ]; then
  say "$out has raw files of commit $(cat "$out/commit"): another folder for $commit"
  exit 2
fi
printf '%s\n' "$commit" >"$out/commit"
touch "$out/parts.tsv"

# ---------------------------------------------------------------- the card

if [ -n "$lease" ]; then
  . "$here/card/lease.sh"
  archives="${archives:-$out/archives}"
  lease
  exit "$?"
fi
"$bench" device --json --measure >"$out/device.json" 2>"$out/logs/device.err" || no_card
card_state "$out/card.csv"

# ---------------------------------------------------------------- correctness

if wanted tests; then device_tests; fi
if wanted sanitizer; then
  if sanitizer="$(tool compute-sanitizer)"; then
    for check in memcheck racecheck initcheck synccheck; do
      runs='*HaveTheBitsOfTheHost/0'
      [ "$check" != racecheck ] || runs='CardRuns.FewStepsHaveTheBitsOfTheHost'  # it slows a run down the most
      part "$check" 150 "$sanitizer" --tool "$check" --error-exitcode 9 "$(test_of test_card_runs)" --gtest_filter="$runs" &
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
"$root/.venv/bin/python" -m barrierbench_analysis.studies.device.gpu_evidence "$out" --records "$records"
