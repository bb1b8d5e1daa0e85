# A card that is lent for ten minutes: eight stages, each with its own time limit, and after each of them an archive of the files that
# it left. Sourced by experiments/gpu_evidence.sh, which has set root, bench, tests, out, archives, seconds and dry.
# Times are those of runs whose phases are not synchronised; the file `synchronized` names the runs whose phases are.
# A stage that fails or is cut leaves what it has, and the next one starts. stages.tsv says of each: name, exit code, seconds, limit.

most_archive_bytes=$((16 * 1024 * 1024))
# The kernels whose hardware counters are read, those that took the longest at 0.5 and 2 million contacts.
counted_kernels='WalkTrees|KeepCandidates|RankRows|FillRows|KeepPairs|SlidingHessians|EvaluateShape|GatherBlocks|GatherStreamed|MirrorBlock|FindFrame|MortonKeys|MultiplyDot|UpdateBlockJacobi|StepDirection'
counters='gpu__time_duration.sum,dram__bytes.sum,lts__t_sectors.sum,l1tex__t_requests_pipe_lsu_mem_global_op_ld.sum,l1tex__t_sectors_pipe_lsu_mem_global_op_ld.sum,l1tex__t_bytes_pipe_lsu_mem_local_op_ld.sum,l1tex__t_bytes_pipe_lsu_mem_local_op_st.sum,sm__warps_active.avg.pct_of_peak_sustained_active,launch__registers_per_thread'

# tiny NAME: what makes a scene small enough for a lease without a card.
tiny() {
  [ -n "$dry" ] || return 0
  printf '%s\n' --set /scene/layers=2 --set /scene/n=6 --set /scene/width_m=0.05 --set /time/steps=2 --set '/device="host"'
}
# lease_run NAME CONFIG SECONDS [ARGUMENTS]: configs/gpu/CONFIG.json on the card, ended by its own time limit before the part's.
lease_run() {
  local name="$1" config="$2" limit="$3"
  shift 3
  part "$name" "$limit" "$program" run "$root/configs/gpu/$config.json" --set '/device="cuda"' --out "$out/$name" --replace \
    --time-limit "$((limit > 6 ? limit - 4 : limit))" --progress none "$@" $(tiny)
}

stage_tests() {
  device_is_there device
  device_tests
}
stage_dense_500k() {  # the first step apart, which warms up
  lease_run dense_500k dense_500k 25 --set /time/steps=6
  if [ -x "$root/before/bench" ]; then
    program="$root/before/bench" lease_run dense_500k.before dense_500k 25 --set /time/steps=6
  else
    without dense_500k.before "the program of the commit before is not here"
  fi
}
stage_contact_82k() {  # the lowest cloth touches the sphere in the second step, and all of them one another in the eighth
  local solver saddle  # the proof of the end is made under the first two rules
  for solver in line_search accumulated_toi; do
    for saddle in "$([ "$solver" = line_search ] && echo escape || echo report)" ignore; do
      lease_run "drape_82k.$solver.$saddle" drape_82k 15 --set /time/steps=16 --set "/step_solver/name=\"$solver\"" --set "/step_solver/saddle=\"$saddle\""
    done
  done
}
stage_dense_1m() { lease_run dense_1m dense_1m 50 --set /time/steps=2; }
stage_kernels() {  # runs for their phases and launches, each of which is waited for: their sum is more than a timed run takes
  BARRIERBENCH_SYNCHRONIZE_PHASES=1 lease_run dense_500k.phases dense_500k 20 --set /time/steps=3
  printf 'dense_500k.phases\n' >"$out/synchronized"
  export BARRIERBENCH_KERNEL_TIMES="$out/kernel_times.json"
  lease_run dense_500k.timed dense_500k 20 --set /time/steps=1
  unset BARRIERBENCH_KERNEL_TIMES
}
stage_counters() {  # the second launch of a kernel is one of the second iteration; caches are as the run leaves them
  local ncu
  ncu="$(tool ncu)" || { without counters "ncu was not found"; return 0; }
  part counters 80 "$ncu" --csv --print-units base --clock-control none --cache-control none --kernel-name-base demangled \
    --kernel-id "::regex:($counted_kernels):2" --metrics "$counters" --launch-count 15 \
    "$program" run "$root/configs/gpu/dense_500k.json" --set '/device="cuda"' --set /time/steps=1 --out "$out/dense_500k.counted" --replace --progress none $(tiny)
}
stage_growth() {  # 2, 4 and 8.2 million vertices, up to 184 million contacts; a size without memory ends it
  local layers
  for layers in 8 16 32; do
    lease_run "packed_8m.$layers" packed_8m 160 --set "/scene/layers=$layers"
    [ -z "$(grep -s '"outcome": "oom"' "$out/packed_8m.$layers/run.json")" ] || break
  done
}
stage_sanitizer() {
  local sanitizer check module part_of program_of
  device_is_there device_again
  module="$(next_module)"
  [ -n "$module" ] || { without sanitizer "no test for a card was found"; return 0; }
  printf '%s\n' "$module" >"$out/sanitized_module"
  program_of="$(test_of "test_card_$module")"
  for check in memcheck racecheck initcheck synccheck; do
    if sanitizer="$(tool compute-sanitizer)"; then
      for part_of in 0 1 2 3; do  # a part that ends has a verdict and counts its kernels, whatever the others do
        part "${check}_$module.$part_of" 90 env GTEST_TOTAL_SHARDS=4 GTEST_SHARD_INDEX="$part_of" "$sanitizer" --tool "$check" --error-exitcode 9 "$program_of" &
      done
    else
      without "${check}_$module" "compute-sanitizer was not found"
    fi
  done
  wait
}

# device_is_there NAME: the card, its state and the rates of copies, after a second of them; NAME.json and NAME.csv.
device_is_there() {
  part "$1" 20 "$bench" device --json --measure
  cp "$out/logs/$1.out" "$out/$1.json"
  card_state "$out/$([ "$1" = device ] && echo card || echo "$1").csv"
}
# next_module: the folder of kernels on which memcheck ended in the fewest records, of these the first by name.
next_module() {
  local module record n
  for module in $(modules); do
    n=0
    for record in "$root"/results/gpu/*.json; do
      [ -e "$record" ] || continue
      ! grep -qE "\"memcheck_$module(\.[0-9]+)?\":\{\"status\":\"(passed|failed)\"" <<<"$(tr -d ' \n' <"$record")" || n="$((n + 1))"
    done
    printf '%s %s\n' "$n" "$module"
  done | sort -k 1n -k 2 | head -n 1 | cut -d ' ' -f 2
}

# archive NUMBER NAME: what the stage wrote, without the states of runs; where that is too large, the largest files stay out and
# left_out.txt names them. One rename puts it in place, so an archive that is there is whole.
archive() {
  local list="$out/.files" file="$archives/$1-$2.tar.gz" largest
  (cd "$out" && find . -type f -newer .stage_begin ! -name 'checkpoint*' ! -name '.*' -printf '%s %p\n' | sort -rn | cut -d ' ' -f 2-) >"$list"
  while :; do
    tar --create --gzip --directory "$out" --files-from "$list" --file "$archives/.next" 2>>"$out/logs/archive.err" || say "archive of $2: some files are missing"
    [ "$(stat --format=%s "$archives/.next")" -gt "$most_archive_bytes" ] || break
    largest="$(head -n 1 "$list")"
    say "archive of $2: $largest is left out"
    printf '%s\n' "$largest" >>"$out/left_out.txt"
    { tail -n +2 "$list" | grep -vxF ./left_out.txt; printf './left_out.txt\n'; } >"$list.next"
    mv "$list.next" "$list"
  done
  mv "$archives/.next" "$file"
}

# stage NUMBER NAME SECONDS: runs stage_NAME until its limit, and makes its archive. Its exit code is that of its first part that failed.
stage() {
  local number="$1" name="$2" limit="$3" start="$SECONDS" parts code new
  parts="$(wc -l <"$out/parts.tsv")"
  [ "$limit" -le "$((lease_end - SECONDS))" ] || limit="$((lease_end - SECONDS))"
  stage_end="$((SECONDS + limit))"
  say "stage $name, at most $limit s"
  touch "$out/.stage_begin"
  (set +e; "stage_$name") || true
  new="$(tail -n "+$((parts + 1))" "$out/parts.tsv")"
  code="$(awk -F '\t' '$2 == "failed" || $2 == "timed_out" { print $3; exit }' <<<"$new")"
  if [ -z "$code" ] && grep -q "$(printf '\tpassed\t')" <<<"$new"; then n_passed="$((n_passed + 1))"; fi
  printf '%s\t%s\t%s\t%s\n' "$name" "${code:-0}" "$((SECONDS - start))" "$limit" >>"$out/stages.tsv"
  printf '%s\n' "$((SECONDS - began))" >"$out/seconds"
  touch "$out/commit"
  [ -z "$dry" ] || touch "$out/dry"
  cp "$out/parts.tsv" "$out/parts.copy" && mv "$out/parts.copy" "$out/parts.tsv"
  archive "$number" "$name"
}

# lease: all stages, 1 where none of them passed; their seconds add up to 540, of another --seconds to the same parts of it.
lease() {
  local number=0 name limit
  program="$bench" n_passed=0 began="$SECONDS" lease_end="$((SECONDS + seconds - 8))"  # 8 s: of the last archive
  mkdir -p "$archives"
  : >"$out/stages.tsv"
  while read -r name limit; do
    number="$((number + 1))"
    stage "$number" "$name" "$((limit * seconds / 540))" </dev/null
  done <<'STAGES'
tests 35
dense_500k 50
contact_82k 60
dense_1m 50
kernels 40
counters 80
growth 165
sanitizer 60
STAGES
  printf '%s\n' "$archives"
  [ "$n_passed" -gt 0 ] || { say "no stage passed"; return 1; }
}
