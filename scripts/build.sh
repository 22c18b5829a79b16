#!/usr/bin/env bash
# Builds everything or $TARGETS in build/ (or $BUILD_DIR). Usage: scripts/build.sh [cmake options]
set -euo pipefail
case "${1:-}" in -h | --help) sed -n 2,2p "$0"; exit 0 ;; esac
root="$(cd "$(dirname "$0")/.." && pwd)"
build="${BUILD_DIR:-$root/build}"
if [ -f /opt/ros/noetic/setup.bash ]; then
  set +u
  source /opt/ros/noetic/setup.bash
  set -u
fi
cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release "$@"
read -r -a targets <<<"${TARGETS:-all}"
cmake --build "$build" --target "${targets[@]}" -- -j"${JOBS:-$(nproc)}"
