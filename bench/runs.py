"""Runs `simulate` on the scenes of bench/scenes and reads its results."""
import csv
import hashlib
import json
import os
import pathlib
import re
import shutil
import statistics
import sys

import numpy as np

from child import Child

ROOT = pathlib.Path(__file__).resolve().parent.parent
SIMULATE = ROOT / "build/devel/lib/haptic_cloth/simulate"
PAGES = ROOT / "docs/experiments"
SCENES = ROOT / "bench/scenes"


def thresholds(angle, strain):
    """Settings that let cells split above an angle [rad] or strain [-], and merge below half of it."""
    return {"adapt.refine_above": angle, "adapt.coarsen_below": 0.5 * angle,
            "adapt.refine_above_strain": strain, "adapt.coarsen_below_strain": 0.5 * strain}


# Coarser meshes of AMRC: cells split above this angle [rad] and strain; the defaults are 0.7 and 0.005.
COARSER = ((1.0, 0.0075), (1.4, 0.015), (1.6, 0.021), (1.7, 0.025), (1.8, 0.03))
# The settings of config/scenes/haptic_1khz.yaml, without its time budget.
SWIFT = {"solver.tolerance": 1.0, "solver.max_iterations": 10, "adapt.interval": 9, **thresholds(1.6, 0.02)}
PEER_SCENES = ROOT / "bench/peers/scenes"
CACHE = ROOT / "build/bench_cache"
STRATEGIES = ("finest", "coarsest", "refine", "coarsen", "amrc")
SIZES = ("full", "quick", "smoke")
HEADER = "# bench "
HEADER_KEYS = ("chart", "choices", "from", "quick", "smoke", "reference", "note")
FABRICS = ROOT / "config/fabrics"


class BenchError(Exception):
    """A message for the user."""


class Scene:
    """A scene file and its `# bench KEY: JSON` lines.

    quick, smoke   scene keys that make it smaller
    reference      solver.time_step and solver.tolerance of its reference
    chart          false: not drawn by bench/chart
    choices        a size whose list of choices is enough for bench/chart
    scales         false: its pins name particles, so it means another cloth with more of them
    begin          time from which steps and forces count, if not all do (header `from`) [s]
    note           one sentence on what the scene tests
    """

    def __init__(self, path, size="full"):
        self.path = pathlib.Path(path).resolve()
        self.name = self.path.stem
        header = self._header()
        self.note = header.get("note", "")
        self.chart = header.get("chart", True)
        self.choices = header.get("choices", "full")
        self.begin = header.get("from", 0.0)
        text = self.path.read_text()
        self.has_probe = re.search(r"^probe:", text, re.M) is not None
        self.scales = re.search(r"\bparticles:\s*(\[\s*\[|-)", text) is None  # a list of places, not a size
        self.adapts = re.search(r"^adapt:.*\blevels: 0\b", text, re.M) is None
        self.overrides = {} if size == "full" else dict(header.get("quick", {}))
        if size == "smoke":
            self.overrides.update(header.get("smoke", {}))
        self.reference = {"solver.time_step": 0.0005, "solver.tolerance": 0.02}
        self.reference.update(header.get("reference", {}))

    def text(self, overrides):
        """Text of the scene and of its fabric: other text, other results."""
        texts = [self.path.read_text()]
        named = re.search(r"^  fabric: *(\S+)", texts[0], re.M)
        fabric = overrides.get("cloth.fabric", named.group(1) if named else "")
        places = [self.path.parent / fabric] if fabric.endswith(".yaml") else \
            [folder / (fabric + ".yaml") for folder in (self.path.parent.parent / "fabrics", FABRICS)]
        return texts + [place.read_text() for place in places if place.is_file()][:1]

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


def load_scenes(folders, size, names=()):
    """Scenes of one or several folders: those named, or all that belong in the chart."""
    folders = [folders] if isinstance(folders, (str, pathlib.Path)) else folders
    paths = [path for folder in folders for path in sorted(pathlib.Path(folder).glob("*.yaml"))]
    # A folder may also contain fabrics.
    scenes = [Scene(path, size) for path in paths if re.search(r"^cloth:", path.read_text(), re.M)]
    unknown = set(names) - {scene.name for scene in scenes}
    if unknown:
        raise BenchError("%s: no scene %s" % (", ".join(map(str, folders)), ", ".join(sorted(unknown))))
    return [scene for scene in scenes if (scene.name in names if names else scene.chart)]


class Result:
    """Files of one run; wall times are of all repeats [s]. Peers and runs in real time have no digest."""

    def __init__(self, directory, wall_times, peak_memory=0):
        self.directory = directory
        self.wall_times = wall_times
        self.peak_memory = peak_memory  # [bytes]; 0: it ended before the first reading
        try:
            self.summary = json.loads((directory / "summary.json").read_text())
            self.digest = {} if self.summary.keys() & {"peer", "pace"} else _digest(directory)
        except (OSError, ValueError, KeyError) as error:
            raise BenchError("%s: malformed results: %r" % (directory, error)) from error

    @property
    def wall_time(self):
        return statistics.median(self.wall_times)

    @property
    def wall_per_second(self):
        """Wall time of the solver per simulated second."""
        return self.wall_time / self.summary["simulated_time"]

    def state(self):
        """Hash of the final state."""
        if "state_hash" in self.summary:
            return self.summary["state_hash"]
        return hashlib.sha256((self.directory / "particles.csv").read_bytes()).hexdigest()[:16]

    def steps(self):
        """Columns of steps.csv by name, if it was kept. All are numbers except `termination`."""
        with open(self.directory / "steps.csv") as stream:
            rows = list(csv.reader(stream))
        columns = dict(zip(rows[0], zip(*rows[1:])))
        return {name: np.array(cells, dtype=str if name == "termination" else float)
                for name, cells in columns.items()}

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
    """The few numbers needed from steps.csv, stored so that the file itself can be removed."""
    kept = directory / "digest.json"
    if kept.exists():
        return json.loads(kept.read_text())
    with open(directory / "steps.csv") as stream:
        steps = list(csv.DictReader(stream))
    if not steps:
        raise BenchError("%s: steps.csv has no rows" % directory)
    first = steps[0]
    digest = {
        # Proportional to the cost of a solve, and independent of the machine and its load.
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


def machine_of(summary):
    """Processor and instruction set, to be shown with every figure."""
    return {key: summary.get(key) for key in ("processor", "simd")}


def machine_line(machine):
    return "Processor: %s. Instruction set of the kernels: %s." % (machine["processor"], machine["simd"])


class Simulator:
    """Runs scenes one after the other, because two at once would disturb each other's times."""

    def __init__(self, program, arguments, time_limit=None, keep_steps=False):
        self.program = pathlib.Path(program).resolve()
        if not self.program.is_file():
            raise BenchError("%s: no such program; build it, or give --simulate PATH" % program)
        self.cache = arguments.cache
        self.threads = arguments.threads
        self.repeat = arguments.repeat
        self.resume = arguments.resume
        self.time_limit = time_limit
        self.keep_steps = keep_steps
        self.machine = machine_of({})  # of all timed runs
        self.failure = ""  # why the last run that failed did
        self._fingerprint = fingerprint(self.program)

    def measure(self, scene, overrides, options=(), load=""):
        """Timed run, from the cache only with --resume; None if it failed or took too long.

        `options` are added to the command line; `load` names what else runs on the machine.
        """
        directory = self._directory(scene, overrides, [*options, *([load] if load else [])], "timed")
        if self.resume and (directory / "run.json").exists():
            run = json.loads((directory / "run.json").read_text())
            if "failed" in run and run["time_limit"] == self.time_limit:
                self.failure = run["failed"]
                print("%s %s: %s" % (scene.name, overrides, run["failed"]), file=sys.stderr)
                return None
            if len(run.get("wall_times", ())) >= self.repeat:
                return self._timed(Result(directory, run["wall_times"], run["peak_memory"]))
        wall_times, states = [], set()
        for _ in range(self.repeat):
            result = self._run(scene, overrides, options, directory, self.time_limit)
            if result is None:
                return None
            wall_times += result.wall_times
            states.add(result.state())
        # With a time budget, or in real time, the clock decides what a step does, so final states may differ.
        clocked = "solver.time_budget" in overrides or "--real-time" in options
        if len(states) > 1 and not clocked:
            raise BenchError("%s %s: repeats end in different states" % (scene.name, overrides))
        result.wall_times = wall_times
        _note(directory, {"wall_times": wall_times, "peak_memory": result.peak_memory})
        return self._timed(result)

    def _timed(self, result):
        """Checks that all times of a table are from one machine."""
        machine = machine_of(result.summary)
        if self.machine["processor"] and machine != self.machine:
            raise BenchError("%s was made elsewhere (%s), others here (%s); run without --resume" % (
                result.directory, machine_line(machine), machine_line(self.machine)))
        self.machine = machine
        return result

    def measure_in_turn(self, scene, choices):
        """measure() for a list of overrides; None for each that failed.

        Each round repeats all of them once, so a machine that becomes slower affects all equally.
        """
        kept, wall_times, results = (self.repeat, self.resume), [[] for _ in choices], []
        self.repeat, self.resume = 1, False
        for _ in range(kept[0]):
            results = [self.measure(scene, overrides) for overrides in choices]
            for times, result in zip(wall_times, results):
                times += result.wall_times if result else []
        self.repeat, self.resume = kept
        for times, result in zip(wall_times, results):
            if result:
                result.wall_times = times
        return results

    def reference(self, scene):
        """Reference, and a check with twice step and tolerance; finest mesh, cached."""
        return [self._converged(scene, factor, {}) for factor in (1.0, 2.0)]

    def finer(self, scene, reference):
        """The reference of a scene on a mesh twice as fine, cached; None if its pins are single particles."""
        if not scene.scales:
            return None
        return self._converged(scene, 1.0, {"cloth.particles": [2 * count - 1 for count in
                                                                reference.summary["particles"]]})

    def _converged(self, scene, factor, overrides):
        """Cached run on the finest mesh with a multiple of the reference's step and tolerance."""
        overrides = {**{key: value * factor for key, value in scene.reference.items()}, **overrides,
                     "adapt.strategy": "finest", "solver.max_iterations": 20000, "stop.rest_speed": 0}
        directory = self._directory(scene, overrides, (), "reference")
        if (directory / "digest.json").exists():
            return Result(directory, [0.0])
        print("%s: reference with a step of %g s%s ..." % (
            scene.name, overrides["solver.time_step"],
            " on a finer mesh" if "cloth.particles" in overrides else ""), flush=True)
        result = self._run(scene, overrides, (), directory, None)
        if result is None:
            raise BenchError("%s: the reference run failed" % scene.name)
        return result

    def _directory(self, scene, overrides, options, kind):
        # The number of threads changes no bit, so one reference serves all.
        timing = [] if kind == "reference" else [self.threads, self.keep_steps, os.environ.get("HAPTIC_CLOTH_SIMD", "")]
        text = json.dumps([scene.text(overrides), scene.overrides, overrides, list(options), timing,
                           self._fingerprint], sort_keys=True)
        return self.cache / kind / ("%s-%s" % (scene.name, hashlib.sha256(text.encode()).hexdigest()[:16]))

    def _run(self, scene, overrides, options, directory, time_limit):
        shutil.rmtree(directory, ignore_errors=True)
        directory.mkdir(parents=True)
        settings = {"solver.threads": self.threads, **scene.overrides, **overrides}
        command = [str(self.program), str(scene.path), "--out", str(directory), *options]
        for key, value in settings.items():
            command += ["--set", "%s=%s" % (key, value if isinstance(value, str) else json.dumps(value))]
        child = Child(command, time_limit)
        if child.status in (2, 4):  # bad input, or the results could not be written
            raise BenchError(child.errors)
        if child.status != 0:
            failed = "stopped after %g s" % time_limit if child.status is None else child.errors or (
                "ended with status %d" % child.status)
            print("%s %s %s: %s" % (scene.name, " ".join(options), overrides, failed), file=sys.stderr)
            self.failure = failed
            _note(directory, {"failed": failed, "time_limit": time_limit})
            return None
        result = Result(directory, [0.0], child.peak_memory)
        result.wall_times = [result.summary["wall_time"]]
        if result.digest and not self.keep_steps:
            (directory / "steps.csv").unlink()
        return result


def _note(directory, run):
    (directory / "run.json").write_text(json.dumps(run))


def cores():
    """Processors this process may use."""
    return len(os.sched_getaffinity(0))


def wait_policy():
    """How threads of OpenMP wait for each other; on a busy machine `passive` saves most."""
    spin = os.environ.get("GOMP_SPINCOUNT")
    return os.environ.get("OMP_WAIT_POLICY", "not set") + (", GOMP_SPINCOUNT " + spin if spin else "")


def add_arguments(parser):
    """Adds the arguments that all scripts have in common."""
    parser.add_argument("--simulate", metavar="PATH", default=SIMULATE, help="the program (default: %(default)s)")
    parser.add_argument("--out", metavar="DIR", type=pathlib.Path, default=PAGES,
                        help="where tables and data go (default: %(default)s)")
    parser.add_argument("--cache", metavar="DIR", type=pathlib.Path, default=CACHE,
                        help="where runs go and references stay (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--repeat", type=int, default=1, metavar="N", help="runs a point; the median time counts")
    parser.add_argument("--resume", action="store_true",
                        help="takes timed runs of the same program from --cache too: continues after a break")
    parser.add_argument("--quick", action="store_true", help="smaller cloths")
    parser.add_argument("--smoke", action="store_true", help="tiny cloths: tests the program, measures nothing")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", dest="settings",
                        help="a scene key for all timed runs, not for the reference")


def run_main(name, main):
    """Runs a script and returns its exit status; an error in its input is reported in one line."""
    try:
        sys.exit(main())
    except BenchError as error:
        sys.exit("%s: %s" % (name, error))


def size_of(arguments):
    """Size of the scenes. Those of --smoke measure nothing, so they must not replace the pages."""
    if arguments.smoke and arguments.out.resolve() == PAGES:
        raise BenchError("--smoke measures nothing: name a folder other than %s with --out" % PAGES)
    return "smoke" if arguments.smoke else "quick" if arguments.quick else "full"


def settings_of(arguments):
    """--set as a dictionary; values that are not JSON are text."""
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
