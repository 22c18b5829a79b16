"""Runs the program kernel_times, for bench/kernels and bench/threads."""
import json
import pathlib
import subprocess
import tempfile

import runs

SIDE = {"full": 77, "quick": 41, "smoke": 13}
TIME = {"full": 0.2, "quick": 0.1, "smoke": 0.005}         # of the drape, before the measurement [s]
REPETITIONS = {"full": 9, "quick": 5, "smoke": 1}
MIN_TIME = {"full": 0.05, "quick": 0.02, "smoke": 0.0005}  # of one repetition [s]


def cloth_options(size):
    return ["--side=%d" % SIDE[size], "--time=%g" % TIME[size]]


def run(program, options, size, interleaved=True):
    """Rows of Google Benchmark. Interleaved repetitions see the same load on average."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out.json"
        command = [str(program), *cloth_options(size), *options, "--benchmark_out=%s" % out, "--benchmark_out_format=json",
                   "--benchmark_min_time=%g" % MIN_TIME[size], "--benchmark_repetitions=%d" % REPETITIONS[size],
                   "--benchmark_enable_random_interleaving=%s" % ("true" if interleaved else "false")]
        try:
            done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, universal_newlines=True)
        except OSError as error:
            raise runs.BenchError("%s: %s; needs libbenchmark-dev and -DHAPTIC_CLOTH_BENCH=ON, or give --program PATH" % (
                program, error.strerror)) from error
        if done.returncode != 0:
            raise runs.BenchError("%s: status %d: %s" % (program, done.returncode, done.stderr.strip()))
        return json.loads(out.read_text())["benchmarks"]


def machine(program):
    """Processor and instruction set that the program runs with."""
    done = subprocess.run([str(program), "--machine"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
    if done.returncode != 0:
        raise runs.BenchError("%s: status %d: %s" % (program, done.returncode, done.stderr.strip()))
    return runs.machine_of(json.loads(done.stdout))


def least(rows, clock="real_time"):
    """The row of the least time for each name; its `median` is that of all repetitions.

    The least time is used, because other programs can only add to it. Manual times are used
    unchanged. For the others `clock` is real_time or, for one thread on a busy machine, cpu_time.
    """
    found = {}
    for row in sorted(rows, key=lambda row: row["family_index"]):
        if row["run_type"] != "iteration":
            continue
        if row.get("error_occurred"):
            raise runs.BenchError("%s: %s" % (row["name"], row["error_message"]))
        manual = "/manual_time" in row["run_name"]
        name = row["run_name"].split("/iterations:")[0].split("/manual_time")[0]
        found.setdefault(name, []).append(dict(row, time=row["real_time" if manual else clock]))
    best = {}
    for name, repeats in found.items():
        repeats.sort(key=lambda row: row["time"])
        best[name] = dict(repeats[0], median=repeats[len(repeats) // 2]["time"])
    return best
