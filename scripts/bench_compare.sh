#!/usr/bin/env bash
# Ratios of what two runs of the benchmarks wrote, worst first. Usage: scripts/bench_compare.sh OLD NEW [--above RATIO]
# [--kind time|memory|work|error] [--most N]     OLD, NEW: JSON files, or folders of them (--out of the benchmarks)
set -euo pipefail
exec /usr/bin/python3 "$(dirname "$0")/../bench/compare.py" "$@"
