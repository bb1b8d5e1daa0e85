# Puts all that the evidence needs into a folder, and the folder into an archive that can be carried. Sourced by
# experiments/gpu_evidence.sh, which has set root, bundle and before.

most_bundle_bytes=$((64 * 1024 * 1024))

# put_program CHECKOUT FOLDER: the program of a checkout that is built, its configs, its commit, and `bench`, which starts it
# with the libraries of the bundle.
put_program() {
  local checkout="$1" folder="$2"
  mkdir -p "$folder/bin" "$folder/configs"
  strip -o "$folder/bin/barrierbench" "$checkout/build/release/experiments/barrierbench"
  cp -r "$checkout/configs/." "$folder/configs/"
  git -C "$checkout" rev-parse HEAD >"$folder/commit" 2>/dev/null || true
  printf '#!/bin/sh\nhere="$(dirname "$(readlink -f "$0")")"\nlib="$here/lib"\n[ -d "$lib" ] || lib="$here/../lib"\nexport LD_LIBRARY_PATH="$lib" BARRIERBENCH_CONFIGS="$here/configs"\nexec "$here/bin/barrierbench" "$@"\n' >"$folder/bench"
  chmod +x "$folder/bench"
}

# build_before: a checkout of the commit $before in build/before, its program built; the name of the folder goes to stdout.
build_before() {
  local checkout="$root/build/before"
  git -C "$root" worktree remove --force "$checkout" >&2 2>/dev/null || rm -rf "$checkout"
  git -C "$root" worktree prune
  git -C "$root" worktree add --detach "$checkout" "$before" >&2 || return 1
  "$checkout/bench" build release >&2 || return 1
  printf '%s\n' "$checkout"
}

# check_bundle: refuses before anything is built what no bundle can be made of; $bundle becomes an absolute name, $before one commit.
check_bundle() {
  local name found
  bundle="$(realpath --canonicalize-missing -- "$bundle")"
  if [ -e "$bundle" ] && { [ ! -d "$bundle" ] || [ -n "$(find "$bundle" -mindepth 1 -print -quit)" ]; }; then
    refuse "--bundle $bundle: it is there and is not an empty folder; allowed: a new folder or an empty one"
  fi
  for name in xz strip; do
    command -v "$name" >/dev/null || refuse "--bundle $bundle: the program $name was not found; allowed: a machine that has xz and strip (packages xz-utils and binutils)"
  done
  [ "$before" != none ] || return 0
  if ! found="$(git -C "$root" rev-parse --verify --quiet --end-of-options "$before^{commit}")"; then
    if [ "$(git -C "$root" rev-parse --is-shallow-repository 2>/dev/null)" = true ]; then
      refuse "--before $before: this clone is shallow and does not have that commit; allowed: a commit that it has, or --before none"
    fi
    refuse "--before $before: this is no commit of the checkout $root; allowed: a commit, or --before none"
  fi
  before="$found"
}

# make_bundle: $bundle and $bundle.tar.xz. Exit codes: 70 a program does not build, 2 the archive is too large to be carried.
make_bundle() {
  local checkout bytes
  "$bench" build release >&2 || exit 70
  trap 'rm -rf "$bundle" "$bundle.part"' EXIT  # what is not whole does not stay
  put_program "$root" "$bundle"
  find "$root/build/release/tests" -type f -perm -u+x \( -name 'test_card_*' -o -name test_device -o -name test_formula_log -o -name test_formula_functions \) |
    while read -r program; do strip -o "$bundle/bin/$(basename "$program")" "$program"; done
  if [ "$before" != none ]; then
    checkout="$(build_before)" || exit 70
    put_program "$checkout" "$bundle/before"
    git -C "$root" worktree remove --force "$checkout" >&2
  fi
  mkdir -p "$bundle/lib" "$bundle/results/gpu" "$bundle/card"
  find "$bundle" -path '*/bin/*' -type f -exec ldd {} + | awk '$2 == "=>" && $3 ~ /^\// { print $3 }' | sort -u |
    grep -Ev '/(libc|libm|libdl|librt|libpthread|ld-linux[^/]*)\.so' | xargs -I{} cp -L {} "$bundle/lib/"
  write_minis "$bundle/minis"
  cp "$root/experiments/gpu_evidence.sh" "$bundle/gpu_evidence.sh"
  cp "$root"/experiments/card/*.sh "$bundle/card/"
  cp "$root"/results/gpu/*.json "$bundle/results/gpu/"
  # The programs are made of the same libraries: one window over all of them leaves a twelfth.
  tar --create --directory "$(dirname "$bundle")" "$(basename "$bundle")" | xz --threads=1 --lzma2=preset=2,dict=256MiB >"$bundle.part"
  mv "$bundle.part" "$bundle.tar.xz"
  trap - EXIT
  bytes="$(stat --format=%s "$bundle.tar.xz")"
  say "$(du -sh "$bundle" | cut -f 1) in $bundle, $((bytes / 1024)) KiB in $bundle.tar.xz"
  if [ "$bytes" -gt "$most_bundle_bytes" ]; then
    say "$bundle.tar.xz has $bytes bytes; allowed: $most_bundle_bytes, the most that is carried to a machine with a card"
    exit 2
  fi
}
