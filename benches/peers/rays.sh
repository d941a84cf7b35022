#!/usr/bin/env bash
# Huygens' rays beside Embree's. Prints tables and, last, `median robust-ratio b2 X.XX sh1 X.XX`.
# Installs nothing: says what is missing and stops (exit 2). Options: rays.sh --help
set -euo pipefail
cd "$(dirname "$0")/../.."

missing=0
lack() {
  printf 'missing: %s\n' "$*" >&2
  missing=1
}
command -v cargo >/dev/null || lack "cargo (Rust 1.95 or newer: https://rustup.rs)"
if command -v cc >/dev/null; then
  # What decides is whether the linker finds it, wherever it lies (LIBRARY_PATH counts).
  cc -shared -x c - -lembree3 -o /dev/null </dev/null 2>/dev/null ||
    lack "Embree 3 (Debian: libembree-dev, 3.13; elsewhere: libembree3.so on LIBRARY_PATH)"
else
  lack "cc, a C compiler's linker"
fi
((missing)) && exit 2

# From the root, so that the project's own flags (.cargo/config.toml) hold here too.
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-target}"
cargo build --release --quiet --manifest-path benches/peers/Cargo.toml
printf '%s: benches/peers/rays.sh%s\n' "$(date -u +%F)" "${*:+ $*}"
exec "$CARGO_TARGET_DIR/release/huygens-peers" "$@"
