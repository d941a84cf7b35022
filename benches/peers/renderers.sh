#!/usr/bin/env bash
# Huygens beside whole renderers on the same scenes. Prints tables and, last,
#   ratio mitsuba-llvm cornell X.XX mesh X.XX glossy X.XX
# how many times as many camera paths a CPU second Huygens walks (n/a: a scene it cannot do yet).
#   renderers.sh [FOLDER] [options]     options: renderers.sh --help
# FOLDER holds the peers' run.py and install.sh (default: ../shared/peers beside the repository);
# PEERS_ROOT says where they were installed (default: $HOME/peers). Installs nothing: says what is
# missing and stops (exit 2).
set -euo pipefail
cd "$(dirname "$0")/../.."

folder=../shared/peers
if [[ $# -gt 0 && $1 != -* ]]; then
  folder=$1
  shift
fi
export PEERS_ROOT="${PEERS_ROOT:-$HOME/peers}"
python="$PEERS_ROOT/venv/bin/python"

missing=0
lack() {
  printf 'missing: %s\n' "$*" >&2
  missing=1
}
command -v cargo >/dev/null || lack "cargo (Rust 1.95 or newer: https://rustup.rs)"
[[ -f $folder/run.py ]] || lack "$folder/run.py (renderers.sh FOLDER: the peers' folder)"
[[ -x $python ]] || lack "$python (bash $folder/install.sh installs it, with Mitsuba 3)"
[[ -f $PEERS_ROOT/scenes/cornell/scene.json ]] ||
  lack "$PEERS_ROOT/scenes (python $folder/scenes/make_scenes.py makes them)"
((missing)) && exit 2

cargo build --release --quiet
printf '%s: benches/peers/renderers.sh%s\n' "$(date -u +%F)" "${*:+ $*}"
exec "$python" benches/peers/renderers.py --huygens "${CARGO_TARGET_DIR:-target}/release/huygens" \
  --peers "$folder" --root "$PEERS_ROOT" "$@"
