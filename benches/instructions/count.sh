#!/usr/bin/env bash
# Instructions an item of every stage of a build of the program, counted by valgrind: lines of
# scene/stage, instructions and items.
#   benches/instructions/count.sh PROGRAM
set -euo pipefail
program=$1
command -v valgrind >/dev/null || {
  echo 'missing: valgrind (Debian: apt-get install valgrind)' >&2
  exit 2
}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

"$program" bench --stage | while read -r name items; do
  ((items > 0)) || continue
  valgrind --tool=callgrind --callgrind-out-file="$folder/out" --collect-atstart=no \
    --toggle-collect='*stage*counted*' "$program" bench --stage "$name" \
    >/dev/null 2>"$folder/log" </dev/null
  count=$(sed -n 's/.*Collected : \([0-9]*\).*/\1/p' "$folder/log")
  awk -v name="$name" -v count="$count" -v items="$items" \
    'BEGIN { printf "%s\t%.1f\t%d\n", name, count / items, items }'
done
