#!/usr/bin/python3
"""Runs the physics tests and draws docs/validation.md's table and plots from what they record."""
import argparse
import collections
import csv
import os
import subprocess
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
BEGIN, END = "<!-- table: scripts/validation.py -->", "<!-- end of table -->"
COLUMNS = ["case", "quantity", "mesh", "at", "value", "exact", "error %"]
MESHES = ["finest", "amrc", "coarsest"]
Row = collections.namedtuple("Row", "case quantity mesh at value exact error")


def run_tests(program, filters):
    """Rows that the tests record; a failing test still has recorded its numbers."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "record.csv")
        done = subprocess.run([program, "--gtest_filter=" + filters],
                              env=dict(os.environ, HAPTIC_CLOTH_RECORD=path, GTEST_BRIEF="1"), check=False)
        if done.returncode != 0:
            print("some tests failed: their numbers are in the table too")
        with open(path, newline="") as file:
            return [Row(*row[:3], *map(float, row[3:])) for row in csv.reader(file)]


def groups(rows):
    """Rows by case and quantity, in the order of the names."""
    found = collections.defaultdict(list)
    for row in rows:
        found[row.case, row.quantity].append(row)
    return dict(sorted(found.items()))


def digits(value):
    return "0" if value == 0 else f"{value:.2g}" if abs(value) < 99.5 else f"{value:.0f}"


def table(rows):
    """Largest |error| of each case and quantity, a column a mesh."""
    lines = ["| case | quantity | at | " + " | ".join(f"{mesh}, %" for mesh in MESHES) + " |", "| --- " * 6 + "|"]
    for (case, quantity), members in groups(rows).items():
        at = sorted({row.at for row in members if row.mesh in MESHES})  # the others are for plots, or for charts/validation.csv alone
        if not at:
            continue
        span = "" if at == [0] else f"{at[0]:g}" if len(at) == 1 else f"{at[0]:g} … {at[-1]:g}"
        cells = []
        for mesh in MESHES:
            errors = [abs(row.error) for row in members if row.mesh == mesh]
            cells.append(digits(max(errors)) if errors else "")
        lines.append(f"| {case} | {quantity} | {span} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def write_table(path, text):
    with open(path) as file:
        page = file.read()
    if page.count(BEGIN) != 1 or page.count(END) != 1:
        raise SystemExit(f"{path}: needs one line '{BEGIN}' and one '{END}'")
    head, rest = page.split(BEGIN)
    with open(path, "w") as file:
        file.write(head + BEGIN + "\n" + text + "\n" + END + rest.split(END)[1])


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
    rows = run_tests(os.path.join(arguments.build, "devel/lib/haptic_cloth/physics_tests"), arguments.filter)
    for folder in ("charts", "images"):
        os.makedirs(os.path.join(ROOT, "docs", folder), exist_ok=True)
    with open(os.path.join(ROOT, "docs/charts/validation.csv"), "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([COLUMNS] + sorted(rows))
    write_table(os.path.join(ROOT, "docs/validation.md"), table(rows))
    for plot in (plot_cantilever, plot_convergence, plot_hysteresis):
        plot(rows)


if __name__ == "__main__":
    main()
