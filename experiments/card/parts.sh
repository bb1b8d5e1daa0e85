# What every way of asking a card has in common: parts with a time limit of their own, and the tools and tests that are found.
# Sourced by experiments/gpu_evidence.sh, which has set root, out, tests and bench.

say() { printf 'gpu_evidence: %s\n' "$*" >&2; }

# part NAME SECONDS COMMAND...: runs it with a time limit; its output is kept and its verdict written to parts.tsv. Within a stage
# of a lease the limit is at most what the stage has left.
part() {
  local name="$1" limit="$2" start="$SECONDS" code=0 status=passed
  shift 2
  if [ -n "${stage_end:-}" ] && [ "$limit" -gt "$((stage_end - SECONDS))" ]; then limit="$((stage_end - SECONDS))"; fi
  if [ "$limit" -le 0 ]; then
    without "$name" "no time was left"
    return 0
  fi
  say "$name"
  timeout --kill-after=3 "$limit" "$@" >"$out/logs/$name.out" 2>"$out/logs/$name.err" || code="$?"
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

# test_of NAME: the program of its tests; nothing where there is none (test_formula_* with a CUDA before 12.8).
test_of() { find "$tests" -name "$1" -type f 2>/dev/null | head -n 1; }
# modules: the folders of kernels that have a test for a card here, and "runs".
modules() { find "$tests" -name 'test_card_*' -type f -perm -u+x 2>/dev/null | sed 's/.*test_card_//' | sort; }

# device_tests: every test for a card at once, the programs of the modules side by side.
device_tests() {
  local sample module
  part device_tests 60 "$(test_of test_device)" &
  for sample in log functions; do
    if [ -n "$(test_of "test_formula_$sample")" ]; then part "formula_$sample" 60 "$(test_of "test_formula_$sample")" & fi
  done
  for module in $(modules); do part "card_$module" 240 "$(test_of "test_card_$module")" & done
  wait
}

# card_state FILE: driver, clocks, power and temperature, where nvidia-smi is there.
card_state() {
  local smi
  smi="$(tool nvidia-smi)" || return 0
  "$smi" --format=csv,nounits --query-gpu=name,driver_version,clocks.sm,clocks.max.sm,clocks.mem,clocks.max.mem,power.limit,ecc.mode.current,temperature.gpu \
    --id=0 >"$1" 2>/dev/null || rm -f "$1"
}

# write_minis FOLDER: the configs of the catalogue at their small size, without those that are refused.
write_minis() {
  local file name
  mkdir -p "$1"
  for file in "$root"/configs/catalogue/*.json; do
    name="$(basename "$file" .json)"
    case "$name" in intersect-*) continue ;; esac
    "$bench" scenes "$name" --write "$1/$name.json" >&2
  done
}
