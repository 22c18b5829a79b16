#!/usr/bin/env bash
# Fuzzes the readers of scene files, fabric files and --set with clang and libFuzzer, from seeds.
# Inputs that break a reader are kept in BUILD/findings, and the exit status is 1.
# Usage: scripts/fuzz.sh [--seconds N (per reader: 60)] [--seed N (0: by chance)] [--build DIR (build/fuzz)]
set -euo pipefail
case "${1:-}" in -h | --help) sed -n 2,4p "$0"; exit 0 ;; esac
root="$(cd "$(dirname "$0")/.." && pwd)"
seconds=60
seed=0
build="$root/build/fuzz"
while [ $# -gt 0 ]; do
  case "$1" in
    --seconds) seconds="$2" ;;
    --seed) seed="$2" ;;
    --build) build="$2" ;;
    *) sed -n 2,4p "$0" >&2; exit 2 ;;
  esac
  shift 2
done

for compiler in clang++ clang++-19 clang++-16 clang++-15 clang++-14 clang++-10; do
  if command -v "$compiler" >/dev/null; then break; fi
done
mkdir -p "$build"
cmake -S "$root" -B "$build" -DCMAKE_CXX_COMPILER="$compiler" -DHAPTIC_CLOTH_ROS=OFF -DHAPTIC_CLOTH_TESTS=OFF \
  -DHAPTIC_CLOTH_FUZZ=ON >"$build/cmake.log" 2>&1 || { cat "$build/cmake.log"; exit 1; }
cmake --build "$build" --target fuzzers -- -j"${JOBS:-$(nproc)}"

mkdir -p "$build/findings"
fuzz() {  # reader, folders with seeds
  local reader="$1"
  shift
  mkdir -p "$build/corpus/$reader"
  # Readers accept a file in milliseconds. A block of 256 MB is ten times what the largest input
  # here needs. The sanitizer itself uses up to 500 MB of the limit of 1 GB.
  "$build/fuzz_$reader" -seed="$seed" -max_total_time="$seconds" -timeout=5 -rss_limit_mb=1024 -malloc_limit_mb=256 -max_len=4096 \
    -dict="$root/test/fuzz/yaml.dict" -artifact_prefix="$build/findings/$reader-" -print_final_stats=1 \
    "$build/corpus/$reader" "$@" >"$build/$reader.log" 2>&1
}
seeds="$root/test/fuzz/seeds"
running=()
fuzz scene "$seeds/scene" "$root/config/scenes" & running+=("scene:$!")
fuzz fabric "$seeds/fabric" "$root/config/fabrics" & running+=("fabric:$!")
fuzz override "$seeds/override" & running+=("override:$!")

status=0
for one in "${running[@]}"; do
  reader="${one%%:*}"
  if wait "${one#*:}"; then
    runs="$(sed -n 's/^stat::number_of_executed_units: *//p' "$build/$reader.log")"
    echo "$reader: held on $runs inputs"
  else
    status=1
    tail -n 60 "$build/$reader.log"
    echo "$reader: FAILED, the input is in $build/findings"
  fi
done
exit "$status"
