#!/usr/bin/env bash
# Builds the library and its tests with sanitizers and runs them.
# Usage: scripts/sanitize.sh address [--scenes N] [--seed S]    memory and undefined behaviour:
#            random scenes, N (200) from number S (1); readers; unit tests
#        scripts/sanitize.sh thread [--scenes N] [--seed S]     data races: exchange of threads;
#            N random scenes (20) with every loop on two threads
# Builds in build/sanitize_MODE or $BUILD_DIR. `thread` needs clang and libomp, whose tool libarcher
# tells the sanitizer what threads wait for; gcc's libgomp does not.
set -euo pipefail
case "${1:-}" in -h | --help) sed -n 2,8p "$0"; exit 0 ;; esac
root="$(cd "$(dirname "$0")/.." && pwd)"
mode="${1:-}"
case "$mode" in
  address) scenes=200 ;;
  thread) scenes=20 ;;
  *) sed -n 3,8p "$0" >&2; exit 2 ;;
esac
shift
seed=1
while [ $# -gt 0 ]; do
  case "$1" in
    --scenes) scenes="$2" ;;
    --seed) seed="$2" ;;
    *) sed -n 3,8p "$0" >&2; exit 2 ;;
  esac
  shift 2
done
jobs="${JOBS:-$(nproc)}"
build="${BUILD_DIR:-$root/build/sanitize_$mode}"
# Tests that run other programs or read sources are not useful here.
unit='-Structure.*:Simulate*.*:KesTest*.*'

if [ "$mode" = address ]; then
  targets=(fuzz_tests unit_tests)
  configure=(-DHAPTIC_CLOTH_SANITIZE=address,undefined "-DCMAKE_CXX_FLAGS=-O1 -D_GLIBCXX_ASSERTIONS")
else
  compiler="$(command -v clang++ || command -v clang++-14)"
  # The tool must have the version of the compiler's libomp.
  archer="$("$compiler" -print-file-name=libarcher.so)"
  if [ ! -f "$archer" ]; then archer="$(dirname "$(readlink -f "$compiler")")/../lib/libarcher.so"; fi
  [ -f "$archer" ] || { echo "libarcher.so not found: install libomp-dev"; exit 1; }
  targets=(fuzz_tests exchange_tests)
  configure=(-DHAPTIC_CLOTH_SANITIZE=thread "-DCMAKE_CXX_COMPILER=$compiler" "-DCMAKE_CXX_FLAGS=-O1 -DHAPTIC_CLOTH_SHARE_ALL")
  export OMP_TOOL_LIBRARIES="$archer" TSAN_OPTIONS="ignore_noninstrumented_modules=1 halt_on_error=1 second_deadlock_stack=1 ${TSAN_OPTIONS:-}"
fi
cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=None -DHAPTIC_CLOTH_ROS=OFF "${configure[@]}"
cmake --build "$build" --target "${targets[@]}" -- -j"$jobs"

export OMP_WAIT_POLICY=passive
export ASAN_OPTIONS="detect_stack_use_after_return=1 ${ASAN_OPTIONS:-}" UBSAN_OPTIONS="print_stacktrace=1 ${UBSAN_OPTIONS:-}"
programs="$build/devel/lib/haptic_cloth"

# Random scenes, ten per process, one process per core: the sanitizer makes a scene 15 times slower.
random() {
  # shellcheck disable=SC2016  # the inner shell's variables
  seq "$seed" 10 "$((seed + scenes - 1))" | xargs -P "$jobs" -I{} bash -euo pipefail -c '
    end=$(($1 + 10 < $2 ? $1 + 10 : $2))
    export HAPTIC_CLOTH_RANDOM_SEED="$1" HAPTIC_CLOTH_RANDOM_SCENES="$((end - $1))"
    GTEST_BRIEF=1 "$0" --gtest_filter="RandomScenes.StayFinite*" || { echo "scenes $1 to $((end - 1)): FAILED"; exit 1; }
    echo "scenes $1 to $((end - 1)): clean"' "$programs/fuzz_tests" {} "$((seed + scenes))"
}

if [ "$mode" = address ]; then
  HAPTIC_CLOTH_RANDOM_SEED="$seed" HAPTIC_CLOTH_RANDOM_SCENES="$scenes" "$programs/fuzz_tests" --gtest_filter='-*.StayFinite*'
  "$programs/unit_tests" --gtest_filter="$unit"
else
  # Silence proves something only if the sanitizer reports a known race.
  "$compiler" -std=c++17 -O1 -g1 -fsanitize=thread -fopenmp -DHAPTIC_CLOTH_SHARE_ALL -I"$root/src" -I/usr/include/eigen3 \
    "$root/test/fuzz/race.cpp" -o "$build/race"
  if "$build/race" >"$build/race.log" 2>&1 || ! grep -q 'ThreadSanitizer: data race' "$build/race.log"; then
    echo "the sanitizer does not see the race of test/fuzz/race.cpp"
    exit 1
  fi
  "$programs/exchange_tests" --gtest_filter='Exchange.*:Mailbox.*'
fi
random
echo "sanitize $mode: clean"
