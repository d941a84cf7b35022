#!/usr/bin/env bash
# Whether the verdicts of `huygens bench` can be trusted:
#   - the program compared with itself, ten sessions of --compare and one of --against, differs nowhere;
#   - with one kernel that does a tenth of its work twice (the feature `slowed`, for each of SLOWED) it is
#     slower, the kernel is named, nothing else is, and the exit code is 3.
# Prints each verdict; exit 1 if one is wrong.
#   benches/verdicts.sh [options of huygens bench; without any, --quick --threads 1 --runs 18: a quarter of an hour]
#   TURNS=10 SLOWED='intersect occlude' benches/verdicts.sh
set -euo pipefail
cd "$(dirname "$0")/.."
turns=${TURNS:-10}
if (($# == 0)); then
  # A tenth is told from nothing by some 15 runs, on a machine that nobody else uses much.
  set -- --quick --threads 1 --runs 18
fi
slowed=${SLOWED:-intersect occlude}
built=${CARGO_TARGET_DIR:-target}/release/huygens
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# The slowed one first: what is left in the target folder is the program as it is.
cargo build --release --quiet --locked --features slowed
cp "$built" "$folder/slowed"
cargo build --release --quiet --locked
cp "$built" "$folder/plain"
printf '%s: benches/verdicts.sh%s\n' "$(date -u +%F)" "${*:+ $*}"

wrong=0
# check WHAT EXPECTED-CODE PROGRAM OPTION...: runs it and prints the lines that differ.
check() {
  local what=$1 expected=$2 code=0
  shift 2
  "$@" >"$folder/out" 2>"$folder/err" || code=$?
  printf '%s: exit code %d, %s\n' "$what" "$code" "$(tail -n 1 "$folder/out")"
  sed -n '/^time against/,$p' "$folder/out" | grep -E '  (faster|slower)$' || true
  if ((code != expected)); then
    printf 'WRONG: expected exit code %d\n' "$expected"
    cat "$folder/err"
    wrong=1
  fi
}
same() {
  check "$@"
  [[ $(tail -n 1 "$folder/out") == "no difference" ]] || {
    echo 'WRONG: expected no difference'
    wrong=1
  }
}

"$folder/plain" bench "$@" --save "$folder/saved.json" >/dev/null
for turn in $(seq "$turns"); do
  same "itself, $turn of $turns" 0 "$folder/plain" bench "$@" --compare "$folder/saved.json"
done
same "itself, taking turns" 0 "$folder/plain" bench "$@" --against "$folder/plain"
# named STAGE: what the last check printed names it, and no other stage (scenes as a whole may be slower too).
named() {
  grep -qE "^[a-z ]+: $1 .* slower\$" "$folder/out" || {
    echo "WRONG: $1 is not named"
    sed -n '/^time against/,$p' "$folder/out"
    wrong=1
  }
  if grep -E '^[a-z ]+: .* slower$' "$folder/out" | grep -vE "^[a-z ]+: $1 "; then
    echo "WRONG: another stage is named"
    wrong=1
  fi
}
for stage in $slowed; do
  export HUYGENS_SLOWED=$stage
  check "$stage slowed by a tenth" 3 "$folder/slowed" bench "$@" --compare "$folder/saved.json"
  named "$stage"
  check "$stage slowed by a tenth, taking turns" 3 \
    "$folder/slowed" bench "$@" --against "$folder/plain"
  named "$stage"
  unset HUYGENS_SLOWED
done
exit "$wrong"
