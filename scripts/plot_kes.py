#!/usr/bin/python3
"""Draws a curve of kes_test (CSV on stdin) beside the fabric's loop.
Usage: plot_kes.py FILE.png TEST TITLE [TEMPORARY] < curve.csv
TEST: tensile, shear or bending, for the names of the axes.
TEMPORARY: written instead, to be renamed to FILE.png.
Exit status 4: the file cannot be written."""
import os
import sys

if {"-h", "--help"} & set(sys.argv):
    print(__doc__)
    sys.exit(0)

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

AXES = {
    "tensile": ("strain [-]", "force per width [N/m]"),
    "shear": ("shear angle [rad]", "force per width [N/m]"),
    "bending": ("curvature [1/m]", "moment per width [N·m/m]"),
}
name, test, title = sys.argv[1:4]
s, force, upper, lower = np.loadtxt(sys.stdin, delimiter=",", skiprows=1, unpack=True)
order = np.argsort(s)
plt.figure(figsize=(6, 4.5))
plt.plot(s[order], upper[order], color="0.6", lw=3, label="fabric: branches of the loop")
plt.plot(s[order], lower[order], color="0.6", lw=3)
plt.plot(s, force, color="C3", lw=1, label="mesh")
plt.xlabel(AXES[test][0])
plt.ylabel(AXES[test][1])
plt.title(title)
plt.legend()
plt.tight_layout()

try:
    plt.savefig(sys.argv[4] if len(sys.argv) > 4 else name, dpi=110, format=os.path.splitext(name)[1][1:] or "png")
except OSError as error:
    print("%s: %s" % (name, error.strerror), file=sys.stderr)
    sys.exit(4)
