#!/usr/bin/env bash
# Instructions an item of every stage, counted by valgrind: the same on any machine, so that they can
# gate where time cannot. Compares with baseline.tsv; exit 1 if a stage needs more than THRESHOLD per
# cent more.
#   benches/instructions/run.sh            compare
#   benches/instructions/run.sh --save     write baseline.tsv anew
# Valgrind knows no AVX-512: the build is that of .cargo/config.toml (x86-64-v3). Counts depend on the
# compiler; after changing it, save them anew.
set -euo pipefail
cd "$(dirname "$0")/../.."
threshold=${THRESHOLD:-3}
baseline=benches/instructions/baseline.tsv

cargo build --release --quiet --locked
program=${CARGO_TARGET_DIR:-target}/release/huygens
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

benches/instructions/count.sh "$program" | cut -f 1,2 >"$folder/now.tsv"

if [[ ${1:-} == --save ]]; then
  { printf '# instructions an item, by scene/stage; %s\n' "$(rustc --version)"; cat "$folder/now.tsv"; } \
    >"$baseline"
  cat "$baseline"
  exit
fi
awk -F'\t' -v threshold="$threshold" '
  /^#/ { next }
  NR == FNR { old[$1] = $2; next }
  {
    seen[$1] = 1
    if (!($1 in old)) { printf "%-24s %8.1f  new: save the baseline\n", $1, $2; bad = 1; next }
    change = 100 * ($2 / old[$1] - 1)
    verdict = change > threshold ? "more than " threshold "% more" : ""
    printf "%-24s %8.1f %8.1f %+7.2f%%  %s\n", $1, old[$1], $2, change, verdict
    if (change > threshold) bad = 1
  }
  END {
    for (name in old) if (!(name in seen)) { printf "%-24s is gone: save the baseline\n", name; bad = 1 }
    exit bad
  }' "$baseline" "$folder/now.tsv"
