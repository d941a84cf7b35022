#!/usr/bin/env bash
# What it costs the scenes that call for nothing that the rest is compiled in: the standard scenes by
# this build and by one that leaves out all that they do not call for (kernels/src/bare.rs).
#
# First the instructions of every stage, by the same queues, which are the same on any machine; then
# times, in runs that take turns: RUNS rounds (default 9), intervals as docs/benchmarks.md says. Ratios
# above 1 are what the whole program takes more. What effects cost where they are called for is
# `cargo bench --bench effects`.
set -euo pipefail
cd "$(dirname "$0")/../.."
program=${CARGO_TARGET_DIR:-target}/release/huygens
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

cargo build --release --quiet --locked --features bare
cp "$program" "$folder/bare"
cargo build --release --quiet --locked

for build in "$folder/bare" "$program"; do
  benches/instructions/count.sh "$build"
done | awk -F'\t' '
  !($1 in bare) { bare[$1] = $2; next }
  {
    printf "%-24s %8.1f %8.1f  %.3f\n", $1, bare[$1], $2, $2 / bare[$1]
    split($1, name, "/")
    sum[name[1], 0] += bare[$1] * $3
    sum[name[1], 1] += $2 * $3
    scenes[name[1]]
  }
  END {
    for (scene in scenes)
      printf "%-24s a turn of the loop      %.3f\n", scene, sum[scene, 1] / sum[scene, 0]
  }'

"$program" bench --runs "${RUNS:-9}" --threads "${THREADS:-1}" --against "$folder/bare"
