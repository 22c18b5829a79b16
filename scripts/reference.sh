#!/usr/bin/env bash
# Writes the tables of options into docs/reference and config/node.yaml. Usage: scripts/reference.sh [BUILD]
# Needs unit_tests and ros_unit_tests in BUILD (build/), which compare these files otherwise.
set -euo pipefail
case "${1:-}" in -h | --help) sed -n 2,3p "$0"; exit 0 ;; esac
programs="$(cd "${1:-$(dirname "$0")/../build}" && pwd)/devel/lib/haptic_cloth"
export HAPTIC_CLOTH_WRITE_REFERENCE=1
"$programs/unit_tests" --gtest_brief=1 --gtest_filter='*TheReferenceHasTheTables'
"$programs/ros_unit_tests" --gtest_brief=1 --gtest_filter='*TheReferenceHasTheTables:*TheShippedFile*'
