#!/usr/bin/python3
"""Runs the physics tests and writes docs/experiments/validation.* and the plots from what they record."""
import argparse
import collections
import csv
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
sys.path.insert(0, os.path.join(ROOT, "bench"))
import experiments
import tables

MESHES = ["finest", "amrc", "coarsest"]
Row = collections.namedtuple("Row", "case quantity mesh at value exact error")


def run_tests(program, filters):
    """What the program says of the machine, and rows that the tests record, also those that fail."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "record.csv")
        done = subprocess.run([program, "--gtest_filter=" + filters],
                              env=dict(os.environ, HAPTIC_CLOTH_RECORD=path, GTEST_BRIEF="1"), check=False,
                              stdout=subprocess.PIPE, universal_newlines=True)
        print(done.stdout, end="")
        if done.returncode != 0:
            print("some tests failed: their numbers are in the table too")
        machine = re.search(r"^processor (.*); kernels for (\w+)$", done.stdout, re.M)
        if not machine:
            sys.exit("physics_tests named no processor: it failed before its first test")
        with open(path, newline="") as file:
            return {"processor": machine[1], "simd": machine[2]}, [Row(*row[:3], *map(float, row[3:])) for row in csv.reader(file)]


def groups(rows):
    """Rows by case and quantity, in the order of the names."""
    found = collections.defaultdict(list)
    for row in rows:
        found[row.case, row.quantity].append(row)
    return dict(sorted(found.items()))


def digits(value):
    return "0" if value == 0 else f"{value:.2g}" if abs(value) < 99.5 else f"{value:.0f}"


def document(data):
    """Largest |error| of each case and quantity, a column a mesh."""
    lines = []
    for (case, quantity), members in groups([Row(**row) for row in data["rows"]]).items():
        at = sorted({row.at for row in members if row.mesh in MESHES})  # the others are for plots
        if not at:
            continue
        span = "" if at == [0] else f"{at[0]:g}" if len(at) == 1 else f"{at[0]:g} … {at[-1]:g}"
        errors = [[abs(row.error) for row in members if row.mesh == mesh] for mesh in MESHES]
        lines.append([case, quantity, span] + [digits(max(found)) if found else "" for found in errors])
    head = ["case", "quantity", "at"] + [f"{mesh}, %" for mesh in MESHES]
    return ["[What the rows mean](../validation.md#results).", ""] + tables.markdown(head, lines)


PAGE = experiments.Page("validation", "Errors against references", "scripts/validation.py", document)


def save(figure, axes, xlabel, ylabel, name):
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)
    axes.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(os.path.join(ROOT, "docs", "images", name), dpi=110)
    plt.close(figure)


def plot_cantilever(rows):
    """Tip of the heavy strip against λ: the exact values and those of the meshes."""
    figure, axes = plt.subplots(figsize=(6, 4))
    for quantity, colour in (("drop/L [-]", "C0"), ("x/L [-]", "C1")):
        members = [row for row in rows if row.case == "heavy cantilever" and row.quantity == quantity]
        if not members:
            return
        exact = sorted({(row.at, row.exact) for row in members})
        axes.plot(*zip(*exact), "-", color=colour, label=quantity + ", heavy elastica")
        for mesh, marker in zip(MESHES, "o^s"):
            points = sorted((row.at, row.value) for row in members if row.mesh == mesh)
            if points:
                axes.plot(*zip(*points), marker, color=colour, mfc="none", label=f"{quantity}, {mesh}")
    save(figure, axes, "λ = L/c [-]", "tip over length [-]", "validation_cantilever.png")


def plot_convergence(rows):
    """Cases named "... convergence": error over the number of cells, `at`."""
    figure, axes = plt.subplots(figsize=(6, 4))
    cells = []
    for (case, quantity), members in groups(rows).items():
        if not case.endswith("convergence"):
            continue
        points = np.array(sorted((row.at, abs(row.error)) for row in members))
        cells.extend(points[:, 0])
        axes.loglog(points[:, 0], points[:, 1], "o-", label=f"{case.replace(' convergence', '')}, {quantity}")
        axes.loglog(points[:, 0], points[0, 1] * (points[0, 0] / points[:, 0])**2, "k:", lw=1)
    if not cells:
        return
    axes.plot([], [], "k:", lw=1, label="second order")
    save(figure, axes, "cells [-]", "error [%]", "validation_convergence.png")


def plot_hysteresis(rows):
    """Tips of the strip with hysteresis in the band that the histories allow."""
    cases = {row.case for row in rows if row.case.startswith("strip with hysteresis")}
    figure, axes = plt.subplots(figsize=(6, 4))
    for case, marker in zip(sorted(cases), "os^Dv*"):
        tips = collections.defaultdict(dict)
        for row in (row for row in rows if row.case == case and row.quantity in ("x [mm]", "drop [mm]")):
            tips[row.mesh][row.quantity[:-5]] = row
        for mesh, tip in tips.items():
            known = mesh == "reference"
            style = dict(color="k", marker="+", ms=12) if known else dict(
                color=f"C{MESHES.index(mesh)}", marker=marker, mfc="none")
            label = case.replace("strip with hysteresis, ", "") + ("" if known else ", " + mesh)
            axes.plot(tip["x"].value, -tip["drop"].value, ls="", label=label, **style)
    if axes.lines:
        save(figure, axes, "x of the tip [mm]", "z of the tip [mm]", "validation_hysteresis.png")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", help="build directory with devel/lib/haptic_cloth/physics_tests")
    parser.add_argument("--filter", default="*", help="gtest filter, for a quick look (default: all)")
    arguments = parser.parse_args()
    machine, rows = run_tests(os.path.join(arguments.build, "devel/lib/haptic_cloth/physics_tests"), arguments.filter)
    experiments.write(pathlib.Path(ROOT) / "docs/experiments", PAGE, {
        **machine, "rows": [row._asdict() for row in sorted(rows)]})
    os.makedirs(os.path.join(ROOT, "docs/images"), exist_ok=True)
    for plot in (plot_cantilever, plot_convergence, plot_hysteresis):
        plot(rows)


if __name__ == "__main__":
    main()
