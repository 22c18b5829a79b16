#!/usr/bin/python3
"""Tests scripts/bench_compare.sh on two small files. Expected values are quotients by hand."""
import json
import math
import pathlib
import subprocess
import tempfile
import unittest

import compare

SCRIPT = pathlib.Path(__file__).resolve().parent.parent / "scripts/bench_compare.sh"
OLD = {"size": "full", "rows": [
    {"strategy": "finest", "threads": 1, "wall_s": 2.0, "speedup": 1.0, "peak_memory": 100, "state": "a"},
    {"strategy": "finest", "threads": 2, "wall_s": 1.0, "speedup": 2.0, "peak_memory": None, "state": "a"}]}
# The rows are in reverse order, because rows are matched by what they measured.
NEW = {"size": "full", "rows": [
    {"strategy": "finest", "threads": 2, "wall_s": 1.5, "speedup": 1.6, "peak_memory": None, "state": "b"},
    {"strategy": "finest", "threads": 1, "wall_s": 1.0, "speedup": 1.0, "peak_memory": 100, "state": "b"}]}


class Compare(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        for name, data in (("old.json", OLD), ("new.json", NEW), ("other.json", {"rows": [{"wall_s": 1.0, "scene": "x"}]})):
            (pathlib.Path(self.folder.name) / name).write_text(json.dumps(data))

    def run_script(self, *arguments):
        return subprocess.run([str(SCRIPT), *arguments], cwd=self.folder.name, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, universal_newlines=True)

    def test_rows_are_matched_and_sorted_worst_first(self):
        found = [{}, {}]
        compare.numbers(OLD, "", found[0])
        compare.numbers(NEW, "", found[1])
        rows = compare.compare(*found, tuple(compare.KINDS))
        self.assertEqual([(row[2], round(row[0], 12)) for row in rows],
                         [("wall_s", 1.5), ("speedup", 1.25), ("speedup", 1.0), ("peak_memory", 1.0), ("wall_s", 0.5)])

    def test_nothing_became_something(self):
        self.assertEqual(compare.ratio(0.0, 3.0, compare.LESS), math.inf)
        self.assertEqual(compare.ratio(3.0, 0.0, compare.MORE), math.inf)
        self.assertEqual(compare.ratio(0.0, 0.0, compare.LESS), 1.0)

    def test_exit_status(self):
        self.assertEqual(self.run_script("old.json", "new.json").returncode, 0)
        self.assertEqual(self.run_script("old.json", "new.json", "--above", "1.5").returncode, 0)
        alarm = self.run_script("old.json", "new.json", "--above", "1.3")
        self.assertEqual(alarm.returncode, 1)
        self.assertIn("ALARM: 1 above 1.3", alarm.stdout)
        self.assertEqual(self.run_script("old.json", "new.json", "--above", "1.3", "--kind", "memory").returncode, 0)
        self.assertEqual(self.run_script("old.json", "other.json").returncode, 2)
        self.assertEqual(self.run_script("old.json", "missing.json").returncode, 2)


if __name__ == "__main__":
    unittest.main()
