"""Runs the `simulate` program on the scenes of bench/scenes and reads what it wrote."""
import csv
import hashlib
import json
import pathlib
import shutil
import statistics
import subprocess
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
SIMULATE = ROOT / "build/devel/lib/haptic_cloth/simulate"
SCENES = ROOT / "bench/scenes"
CACHE = ROOT / "build/bench_cache"
STRATEGIES = ("finest", "coarsest", "refine", "coarsen", "amrc")
SIZES = ("full", "quick", "smoke")
HEADER = "# bench "
HEADER_KEYS = ("chart", "quick", "smoke", "reference", "note")


class BenchError(Exception):
    """A message for the user."""


class Scene:
    """A scene file and its `# bench KEY: JSON` lines.

    quick, smoke   scene keys that make it smaller
    reference      solver.time_step and solver.tolerance of its reference
    chart          false: not drawn by bench/chart
    note           one sentence on what the scene tests
    """

    def __init__(self, path, size="full"):
        self.path = pathlib.Path(path).resolve()
        self.name = self.path.stem
        header = self._header()
        self.note = header.get("note", "")
        self.chart = header.get("chart", True)
        self.overrides = {} if size == "full" else dict(header.get("quick", {}))
        if size == "smoke":
            self.overrides.update(header.get("smoke", {}))
        self.reference = {"solver.time_step": 0.0005, "solver.tolerance": 0.02}
        self.reference.update(header.get("reference", {}))

    def _header(self):
        header = {}
        for number, line in enumerate(self.path.read_text().splitlines(), 1):
            if not line.startswith(HEADER):
                continue
            key, _, value = line[len(HEADER):].partition(":")
            if key not in HEADER_KEYS:
                raise BenchError("%s:%d: bench %s: unknown; known here: %s"
                                 % (self.path, number, key, ", ".join(HEADER_KEYS)))
            try:
                header[key] = json.loads(value)
            except ValueError as error:
                raise BenchError("%s:%d: bench %s: not JSON: %s" % (self.path, number, key, error)) from error
        return header


def load_scenes(folder, size, names=()):
    """Scenes of a folder, all of them that have a place in the chart or those named."""
    scenes = [Scene(path, size) for path in sorted(pathlib.Path(folder).glob("*.yaml"))]
    unknown = set(names) - {scene.name for scene in scenes}
    if unknown:
        raise BenchError("%s: no scene %s" % (folder, ", ".join(sorted(unknown))))
    return [scene for scene in scenes if (scene.name in names if names else scene.chart)]


class Result:
    """What one run left in its directory; wall times are of all repeats [s]."""

    def __init__(self, directory, wall_times):
        self.directory = directory
        self.wall_times = wall_times
        try:
            self.summary = json.loads((directory / "summary.json").read_text())
            self.digest = _digest(directory)
        except (OSError, ValueError, KeyError) as error:
            raise BenchError("%s: malformed results: %r" % (directory, error)) from error

    @property
    def wall_time(self):
        return statistics.median(self.wall_times)

    @property
    def wall_per_second(self):
        """Wall time of the solver for a simulated second."""
        return self.wall_time / self.summary["simulated_time"]

    def positions(self):
        """Positions of the finest grid's particles [m], rows along weft."""
        table = np.loadtxt(self.directory / "particles.csv", delimiter=",", skiprows=1, ndmin=2)
        columns, rows = self.summary["particles"]
        if len(table) != rows * columns or not np.isfinite(table).all():
            raise BenchError("%s/particles.csv: malformed" % self.directory)
        return table[:, 3:6].reshape(rows, columns, 3)

    def probe(self):
        """Times [s] and forces on the probe [N]; empty without a probe."""
        with open(self.directory / "probe.csv") as stream:
            rows = list(csv.DictReader(stream))
        times = np.array([float(row["time"]) for row in rows])
        forces = np.array([[float(row["force_" + axis]) for axis in "xyz"] for row in rows])
        return times, forces.reshape(len(rows), 3)


def _digest(directory):
    """The few numbers that steps.csv is needed for, kept so that the file itself need not stay."""
    kept = directory / "digest.json"
    if kept.exists():
        return json.loads(kept.read_text())
    with open(directory / "steps.csv") as stream:
        steps = list(csv.DictReader(stream))
    if not steps:
        raise BenchError("%s: steps.csv has no rows" % directory)
    first = steps[0]
    digest = {
        # Independent of the machine and its load: what a solve costs is proportional to it.
        "particle_iterations": sum(int(s["iterations"]) * int(s["active_particles"]) for s in steps),
        "unconverged_share": sum(s["termination"] != "converged" for s in steps) / len(steps),
        "first_active": int(first["active_particles"]),
        "first_potential": sum(float(first[key]) for key in ("gravity", "stretch", "bend", "shear", "contact")),
    }
    kept.write_text(json.dumps(digest))
    return digest


def fingerprint(path):
    """Identifies the program and the library beside it: other code, other results."""
    digest = hashlib.sha256(path.read_bytes())
    for library in sorted(path.parent.parent.glob("libhaptic_cloth*.so")):
        digest.update(library.read_bytes())
    return digest.hexdigest()


class Simulator:
    """Runs scenes one after the other: two at once would spoil each other's times."""

    def __init__(self, program, cache, threads=1, repeat=1, time_limit=None):
        self.program = pathlib.Path(program).resolve()
        if not self.program.is_file():
            raise BenchError("%s: no such program; build it, or give --simulate PATH" % program)
        self.cache = pathlib.Path(cache)
        self.threads = threads
        self.repeat = repeat
        self.time_limit = time_limit
        self._fingerprint = fingerprint(self.program)

    def measure(self, scene, overrides):
        """Timed run, never from the cache; None where it failed or took too long."""
        directory = self._directory(scene, overrides, "timed")
        wall_times, hashes = [], set()
        for _ in range(self.repeat):
            result = self._run(scene, overrides, directory, self.time_limit)
            if result is None:
                return None
            wall_times += result.wall_times
            hashes.add(result.summary["state_hash"])
        if len(hashes) > 1:
            raise BenchError("%s %s: repeats end in different states" % (scene.name, overrides))
        result.wall_times = wall_times
        return result

    def reference(self, scene):
        """Truth and a check with twice its time step and tolerance, finest mesh, from the cache if there."""
        results = []
        for factor in (1.0, 2.0):
            overrides = {key: value * factor for key, value in scene.reference.items()}
            overrides.update({"adapt.strategy": "finest", "solver.max_iterations": 20000, "stop.rest_speed": 0})
            directory = self._directory(scene, overrides, "reference")
            cached = (directory / "digest.json").exists()
            result = Result(directory, [0.0]) if cached else self._run(scene, overrides, directory, None)
            if result is None:
                raise BenchError("%s: the reference run failed" % scene.name)
            results.append(result)
        return results

    def _directory(self, scene, overrides, kind):
        text = json.dumps([scene.path.read_text(), scene.overrides, overrides, self.threads, self._fingerprint],
                          sort_keys=True)
        return self.cache / kind / ("%s-%s" % (scene.name, hashlib.sha256(text.encode()).hexdigest()[:16]))

    def _run(self, scene, overrides, directory, time_limit):
        shutil.rmtree(directory, ignore_errors=True)
        directory.mkdir(parents=True)
        settings = dict(scene.overrides, **overrides)
        settings["solver.threads"] = self.threads
        command = [str(self.program), str(scene.path), "--out", str(directory)]
        for key, value in settings.items():
            command += ["--set", "%s=%s" % (key, value if isinstance(value, str) else json.dumps(value))]
        try:
            done = subprocess.run(command, stderr=subprocess.PIPE, text=True, timeout=time_limit, check=False)
        except subprocess.TimeoutExpired:
            print("%s %s: stopped after %g s" % (scene.name, overrides, time_limit), file=sys.stderr)
            return None
        if done.returncode == 2:
            raise BenchError(done.stderr.strip())
        if done.returncode != 0:
            print("%s %s: %s" % (scene.name, overrides, done.stderr.strip()), file=sys.stderr)
            return None
        result = Result(directory, [0.0])
        result.wall_times = [result.summary["wall_time"]]
        (directory / "steps.csv").unlink()
        return result


def add_arguments(parser):
    """What table1 and chart have in common."""
    parser.add_argument("--simulate", metavar="PATH", default=SIMULATE, help="the program (default: %(default)s)")
    parser.add_argument("--out", metavar="DIR", type=pathlib.Path, default=ROOT / "docs/charts",
                        help="where tables and data go (default: %(default)s)")
    parser.add_argument("--cache", metavar="DIR", type=pathlib.Path, default=CACHE,
                        help="where runs go and references stay (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--repeat", type=int, default=1, metavar="N", help="runs a point; the median time counts")
    parser.add_argument("--quick", action="store_true", help="smaller cloths")
    parser.add_argument("--smoke", action="store_true", help="tiny cloths: tests the program, measures nothing")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="settings",
                        help="a scene key for all timed runs, not for the reference")


def size_of(arguments):
    return "smoke" if arguments.smoke else "quick" if arguments.quick else "full"


def settings_of(arguments):
    """--set as a dictionary; values that are no JSON are text."""
    settings = {}
    for text in arguments.settings:
        key, equals, value = text.partition("=")
        if not equals:
            raise BenchError("--set %s: must be KEY=VALUE" % text)
        try:
            settings[key] = json.loads(value)
        except ValueError:
            settings[key] = value
    return settings
