#!/usr/bin/env bash
# again.sh COMMAND...: calls it, and again, three times in all, while it ends with 75 (call it again). Every other exit code is final.
for try in 1 2 3; do
  code=0
  "$@" || code="$?"
  [ "$code" -eq 75 ] || break
  [ "$try" -eq 3 ] || printf 'again.sh: exit code 75, call %s of 3: %s\n' "$((try + 1))" "$*" >&2
done
exit "$code"
