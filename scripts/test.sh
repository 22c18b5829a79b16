#!/usr/bin/env bash
# Installs, builds, tests and reads every result, because catkin and rostest can pass untested code.
# The last line is ctest's, unless results contradict it. Usage: scripts/test.sh [--no-install]
set -euo pipefail
case "${1:-}" in -h | --help) sed -n 2,3p "$0"; exit 0 ;; esac
root="$(cd "$(dirname "$0")/.." && pwd)"
build="${BUILD_DIR:-$root/build}"

if [ "${1:-}" != --no-install ]; then "$root/scripts/install_deps.sh"; fi
"$root/scripts/build.sh"

rm -rf "$build/test_results"
status=0
(cd "$build" && ctest --output-on-failure --parallel "$(nproc)") 2>&1 | tee "$build/ctest.log" || status=$?
summary="$(grep 'tests passed,' "$build/ctest.log" | tail -n 1)"
if ! /usr/bin/python3 "$root/scripts/check_results.py" "$build" "$root/test/ros"; then
  echo "FAILED: the test results do not bear out what ctest says: $summary"
  exit 1
fi
echo "$summary"
exit "$status"
