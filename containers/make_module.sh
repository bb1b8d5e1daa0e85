#!/usr/bin/env bash
# A folder that runs barrierbench on nodes without its packages, and a module file for it: make_module.sh DIR.
# DIR must be on a file system that the nodes share. Run it where ./bench build has been run; nodes need the same C library
# or a newer one. Afterwards: module use DIR/modulefiles && module load barrierbench, then barrierbench sweep ...
# Presets and methods are copied too (BARRIERBENCH_CONFIGS); sweeps and base configs are found by the paths that are
# given. Verbs in Python (status, collect) need the Python environment of ./bench.
set -euo pipefail
dir="$(realpath -m "$1")" root="$(cd "$(dirname "$0")/.." && pwd)"
program="${BARRIERBENCH_PROGRAM:-$root/build/release/experiments/barrierbench}"
[ -x "$program" ] || { echo "make_module: $program is not built: ./bench build" >&2; exit 2; }

mkdir -p "$dir"/{bin,lib,modulefiles/barrierbench}
cp "$program" "$dir/bin/barrierbench"
cp -r "$root/configs" "$dir/"
# All libraries but those of the C library, which belong to the node.
ldd "$program" | sed -n 's/.* => \(\/[^ ]*\) .*/\1/p' | grep -vE '/(libc|libm|libdl|librt|libpthread|ld-linux[^/]*)\.so' |
  while read -r library; do cp -L "$library" "$dir/lib/"; done
cat > "$dir/modulefiles/barrierbench/1" << MODULE
#%Module1.0
module-whatis "barrierbench: contact barriers compared on the same scenes"
prepend-path PATH $dir/bin
prepend-path LD_LIBRARY_PATH $dir/lib
setenv OPENBLAS_NUM_THREADS 1
setenv BARRIERBENCH_CONFIGS $dir/configs
MODULE
BARRIERBENCH_CONFIGS="$dir/configs" LD_LIBRARY_PATH="$dir/lib" "$dir/bin/barrierbench" list shapes > /dev/null
echo "$dir: $(ls "$dir/lib" | wc -l) libraries; module use $dir/modulefiles && module load barrierbench"
