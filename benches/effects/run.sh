#!/usr/bin/env bash
# What it costs the scenes that call for nothing that the rest is compiled in: the standard scenes by
# this build and by one that leaves out all that they do not call for (kernels/src/bare.rs), whose runs
# take turns. RUNS rounds (default 9); intervals as docs/benchmarks.md says. What effects cost where they
# are called for is `cargo bench --bench effects`.
set -euo pipefail
cd "$(dirname "$0")/../.."
program=${CARGO_TARGET_DIR:-target}/release/huygens
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

cargo build --release --quiet --locked --features bare
cp "$program" "$folder/bare"
cargo build --release --quiet --locked
# A ratio above 1 is what the whole program takes longer.
"$program" bench --runs "${RUNS:-9}" --threads "${THREADS:-1}" --against "$folder/bare"
