#!/usr/bin/python3
"""Compares the results of two runs of the benchmarks: scripts/bench_compare.sh OLD NEW.

OLD and NEW are JSON files of one benchmark, or folders of them. A ratio is new over old, or old over
new if more is better, so a ratio above 1 is always worse. Rows are matched by what they measured, not
by their place. Exit status: 0; 1 if a ratio is above --above; 2 if there is nothing to compare.
"""
import argparse
import json
import math
import pathlib
import sys

import experiments
import tables

# Keys that identify a row: these, all with a dot (scene keys) and `overrides`.
LABELS = ("scene", "series", "strategy", "mesh", "cloth", "fabric", "part", "pass", "setting", "group", "case", "what", "program",
          "line", "system", "remark", "name", "task", "method", "shared", "threads", "side", "levels", "path", "compiler", "controller", "delay")
LESS, MORE = 1, -1
KINDS = {
    "time": {"wall_per_s": LESS, "wall_s": LESS, "time": LESS, "ms_per_step": LESS, "us_per_iteration": LESS,
             "ns_per_particle_iteration": LESS, "ns_per_particle": LESS, "p50_ms": LESS, "p99_ms": LESS,
             "max_ms": LESS, "whole_wall_s": LESS, "wall": LESS, "fork_us": LESS, "loop_us": LESS, "barrier_us": LESS,
             "gradient_us": LESS, "energy_us": LESS, "total_us": LESS, "adapt_percent": LESS, "real_time_factor": MORE,
             "particle_iterations_per_s": MORE, "speedup": MORE},
    "memory": {"peak_memory": LESS, "bytes_per_particle": LESS},
    "work": {"instructions": LESS, "iterations": LESS, "evaluations": LESS, "iterations_per_step": LESS,
             "iterations_mean": LESS, "imbalance_percent": LESS},
    "error": {"rms_mm": LESS, "max_mm": LESS, "force_percent": LESS, "energy_percent": LESS},
}
# Published numbers, and values derived from the rows themselves.
SKIPPED = ("paper", "published", "reference", "equal_time", "peers_ahead", "default", "times", "wall_times", "exponents", "limits")
COLUMNS = ("ratio", "kind", "measure", "old", "new", "of")


class InputError(Exception):
    """A message for the user."""


def kind_of(key, row):
    """Kind and sense of a number; None if benchmarks are not judged by it."""
    if key == "value" and "what" in row:  # bench/savings: all of its values are costs
        return "time", LESS
    for kind, keys in KINDS.items():
        if key in keys:
            return kind, keys[key]
    return None


def label_of(row):
    named = ["%s=%s" % (key, row[key]) for key in row
             if (key in LABELS or "." in key) and not isinstance(row[key], (dict, list)) and row[key] not in ("default", "")]
    if row.get("overrides"):
        named.append(json.dumps(row["overrides"], sort_keys=True))
    return " ".join(named)


def numbers(data, place, found):
    """Fills `found` with (place, key) -> (value, kind, sense)."""
    if isinstance(data, list):
        for row in data:
            if isinstance(row, dict):
                numbers(row, place, found)
        return
    here = (place + " " + label_of(data)).strip()
    for key, value in data.items():
        if key in SKIPPED:
            continue
        if isinstance(value, (dict, list)):
            numbers(value, here + " " + key if isinstance(value, dict) else here, found)
        elif isinstance(value, (int, float)) and not isinstance(value, bool) and kind_of(key, data):
            again = 1
            while (here if again == 1 else "%s #%d" % (here, again), key) in found:
                again += 1
            found[here if again == 1 else "%s #%d" % (here, again), key] = (value, *kind_of(key, data))


def read(path):
    path = pathlib.Path(path)
    if not path.exists():
        raise InputError("%s: no such file" % path)
    found = {}
    for file in sorted(path.glob("*.json")) if path.is_dir() else [path]:
        try:
            data = experiments.load(file)
        except ValueError as error:
            raise InputError("%s: not JSON: %s" % (file, error)) from error
        numbers(data, file.stem if path.is_dir() else "", found)
    return found


def ratio(old, new, sense):
    """Above 1: worse."""
    worse, better = (new, old) if sense == LESS else (old, new)
    if worse == better:
        return 1.0
    return worse / better if better else math.inf


def compare(old, new, kinds):
    """Rows (ratio, kind, key, old value, new value, place), worst first."""
    rows = []
    for (place, key), (before, kind, sense) in old.items():
        if kind in kinds and (place, key) in new:
            after = new[place, key][0]
            if min(before, after) < 0.0:  # a difference that is negative because of noise
                continue
            rows.append((ratio(before, after, sense), kind, key, before, after, place))
    return sorted(rows, key=lambda row: -row[0])


def main():
    parser = argparse.ArgumentParser(prog="bench_compare.sh", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", metavar="OLD")
    parser.add_argument("new", metavar="NEW")
    parser.add_argument("--above", type=float, metavar="RATIO", help="exit status 1 where a ratio is above it")
    parser.add_argument("--kind", action="append", choices=sorted(KINDS), help="only these; may be repeated (default: all)")
    parser.add_argument("--most", type=int, metavar="N", default=40, help="lines to print (default: %(default)s; 0: all)")
    arguments = parser.parse_args()
    old, new = read(arguments.old), read(arguments.new)
    rows = compare(old, new, arguments.kind or tuple(KINDS))
    if not rows:
        raise InputError("nothing to compare: no row of %s is in %s" % (arguments.old, arguments.new))
    shown = rows[:arguments.most] if arguments.most else rows
    lines = [("%.3f" % row[0], row[1], row[2], "%.6g" % row[3], "%.6g" % row[4], row[5]) for row in shown]
    print("\n".join(tables.plain(COLUMNS, lines)))
    alone = [len(set(a) - set(b)) for a, b in ((old, new), (new, old))]
    print("%d compared, %d shown; %d only in OLD, %d only in NEW" % (len(rows), len(shown), *alone))
    above = [row for row in rows if arguments.above is not None and row[0] > arguments.above]
    if above:
        print("ALARM: %d above %g" % (len(above), arguments.above))
    return 1 if above else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except InputError as error:
        print("bench_compare.sh: %s" % error, file=sys.stderr)
        sys.exit(2)
