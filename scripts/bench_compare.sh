#!/usr/bin/env bash
# Compares the results of two runs of the benchmarks, worst ratio first. Usage:
# scripts/bench_compare.sh OLD NEW [--above RATIO] [--kind time|memory|work|error] [--most N]
# OLD, NEW: JSON files, or folders of them (--out of the benchmarks)
set -euo pipefail
exec /usr/bin/python3 "$(dirname "$0")/../bench/compare.py" "$@"
