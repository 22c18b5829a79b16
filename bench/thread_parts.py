"""Results of kernel_times for bench/threads: parts of Table 2, costs of OpenMP, work shares."""
import json
import subprocess

import kernel_runs
import runs

SHOWN = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)
FABRIC = "winter_suiting"  # that of the scene
PARTS = ("gradient", "energy", "total")
TIMES = 100                # evaluations, regions, loops or barriers in one run, kTimes in kernel_times/main.cpp
LIMIT_PERCENT = 3.0        # target for the imbalance


def measure(program, size, counts):
    options = ["--strategy=finest,amrc", "--fabric=" + FABRIC]
    best = kernel_runs.least(kernel_runs.run(program, options + ["--threads=" + ",".join(map(str, counts))], size, False))
    return {"table2": table2(best, counts), "openmp": openmp(best, counts), "shares": shares(program, options, size)}


def table2(best, counts):
    """Times of an evaluation (value and gradient), a quadratic form, and an iteration."""
    rows = []
    for strategy in ("finest", "amrc"):
        one = None
        for threads in counts:
            found = {part: best["threads/%d/%s/%s" % (threads, strategy, part)] for part in PARTS}
            row = {"strategy": strategy, "threads": threads, "particles": found["total"]["particles"]}
            row.update({part + "_us": 1e-3 * found[part]["time"] / (1 if part == "total" else TIMES) for part in PARTS})
            one = one or row
            row.update({part + "_speedup": one[part + "_us"] / row[part + "_us"] for part in PARTS})
            rows.append(row)
    return rows


def openmp(best, counts):
    """Costs by the method of [M04]: the time of a delay inside, minus that outside."""
    rows = []
    for threads in counts:
        took = {what: 1e-3 * best["openmp/%d/%s" % (threads, what)]["time"] / TIMES
                for what in ("delay", "fork", "loop", "barrier")}
        rows.append({"threads": threads, "delay_us": took["delay"],
                     **{what + "_us": took[what] - took["delay"] for what in ("fork", "loop", "barrier")}})
    return rows


def shares(program, options, size):
    done = subprocess.run([str(program), *kernel_runs.cloth_options(size), *options, "--shares"], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, universal_newlines=True)
    if done.returncode != 0:
        raise runs.BenchError("%s: status %d: %s" % (program, done.returncode, done.stderr.strip()))
    return json.loads(done.stdout)


def remarks(parts):
    text = ["A parallel region takes %.2f us, a loop shared out %.2f us, a barrier %.2f us, on %d threads." % (
        row["fork_us"], row["loop_us"], row["barrier_us"], row["threads"]) for row in parts["openmp"] if row["threads"] > 1]
    for strategy in ("finest", "amrc"):
        even = [row for row in parts["shares"] if row["strategy"] == strategy and row["shared"] == "active lists"]
        grid = {row["threads"]: row["imbalance_percent"] for row in parts["shares"]
                if row["strategy"] == strategy and row["shared"] == "finest grid"}
        off = [row["threads"] for row in even if row["imbalance_percent"] > LIMIT_PERCENT]
        worst = {threads: next(row["imbalance_percent"] for row in even if row["threads"] == threads) for threads in (2, 4, 8)}
        text.append("%s, %d particles: the busiest thread has %s %% more than the mean on 2, 4, 8 threads; by parts of the "
                    "grid %s %%. Above %g %% from %s threads on." % (
                        strategy, even[0]["particles"], ", ".join("%.1f" % value for value in worst.values()),
                        ", ".join("%.1f" % grid[threads] for threads in worst), LIMIT_PERCENT, min(off) if off else "no number of"))
    return text


def sections(parts):
    """(title, columns, lines) of three tables."""
    yield ("Parts of an iteration, after Table 2 of [M04]",
           ("mesh", "threads", "gradient us", "speedup", "energy us", "speedup", "total us", "speedup"),
           [(row["strategy"], str(row["threads"]), *[cell for part in PARTS for cell in (
               "%.1f" % row[part + "_us"], "%.2f" % row[part + "_speedup"])]) for row in parts["table2"]])
    yield ("OpenMP's own costs", ("threads", "region us", "loop us", "barrier us"),
           [(str(row["threads"]), "%.2f" % row["fork_us"], "%.2f" % row["loop_us"], "%.2f" % row["barrier_us"])
            for row in parts["openmp"]])
    yield ("Most work of a thread over the mean, in percent above it (counted)",
           ("mesh", "shared", "threads", "gradient", "energy", "both"),
           [(row["strategy"], row["shared"], str(row["threads"]), "%.1f" % row["gradient_percent"], "%.1f" % row["energy_percent"],
             "%.1f" % row["imbalance_percent"]) for row in parts["shares"] if row["threads"] in SHOWN])
