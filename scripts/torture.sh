#!/usr/bin/env bash
# Runs the torture suite and writes its margins into the table of docs/stability.md.
# Usage: scripts/torture.sh [ci|short|long] [BUILD]    default: short, build
#   ci     the form of every build: a minute
#   short  a soak of 10 simulated minutes, 100,000 cycles, crumpling 10 times as long: about ten minutes
#   long   a soak of an hour, 1,000,000 cycles, crumpling 100 times as long: about an hour
# A failure leaves a scene in BUILD/torture, which `simulate` can replay.
# --no-table as first argument: does not change the document.
set -euo pipefail
case "${1:-}" in -h | --help) sed -n 2,8p "$0"; exit 0 ;; esac
root="$(cd "$(dirname "$0")/.." && pwd)"
table=yes
if [ "${1:-}" = --no-table ]; then table=no; shift; fi
form="${1:-short}"
build="$(realpath "${2:-$root/build}")"
case "$form" in
  ci) ;;
  short)
    export HAPTIC_CLOTH_TORTURE_SOAK=600 HAPTIC_CLOTH_TORTURE_CYCLES=100000 HAPTIC_CLOTH_TORTURE_LAYERS=10
    ;;
  long)
    export HAPTIC_CLOTH_TORTURE_SOAK=3600 HAPTIC_CLOTH_TORTURE_CYCLES=1000000
    export HAPTIC_CLOTH_TORTURE_LAYERS=100
    ;;
  *) sed -n 2,8p "$0" >&2; exit 2 ;;
esac
program="$build/devel/lib/haptic_cloth/stability_tests"
[ -x "$program" ] || { echo "$program is missing: build it first" >&2; exit 2; }

export HAPTIC_CLOTH_TORTURE_OUT="$build/torture" OMP_WAIT_POLICY="${OMP_WAIT_POLICY:-passive}"
mkdir -p "$HAPTIC_CLOTH_TORTURE_OUT"
rm -f "$HAPTIC_CLOTH_TORTURE_OUT/margins.csv"
status=0
GTEST_BRIEF=1 "$program" --gtest_filter='*Torture*' || status=$?
if [ "$table" = yes ]; then
  "$root/scripts/stability.py" "$HAPTIC_CLOTH_TORTURE_OUT/margins.csv" "$root/docs/stability.md"
fi
exit "$status"
