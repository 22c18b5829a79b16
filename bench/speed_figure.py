"""The pictures of bench/threads and bench/scaling."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

COLOURS = {"finest": "#222222", "amrc": "#1b4f8f"}


def _finish(figure, title, size, path):
    figure.suptitle(title + ("" if size == "full" else " (%s)" % size), fontsize=12)
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    plt.close(figure)


def _lines(axes, rows, x, y):
    for strategy, colour in COLOURS.items():
        points = [(row[x], row[y]) for row in rows if row["strategy"] == strategy and row[y] is not None]
        axes.plot([a for a, _ in points], [b for _, b in points], "o-", color=colour, label=strategy, ms=5)
    axes.set_xlabel(x, fontsize=9)
    axes.grid(True, lw=0.3)


def draw_threads(path, rows, size):
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.8))
    _lines(left, rows, "threads", "speedup")
    counts = sorted({row["threads"] for row in rows})
    left.plot(counts, counts, color="0.4", lw=0.8, ls="--", label="threads")
    left.set_ylabel("speedup", fontsize=9)
    left.legend(fontsize=8, frameon=False)
    _lines(right, rows, "threads", "ms_per_step")
    right.set_ylabel("wall time of a step [ms]", fontsize=9)
    right.set_ylim(bottom=0.0)
    _finish(figure, "Threads", size, path)


def draw_scaling(path, rows, size):
    panels = (("us_per_iteration", "time of an iteration [us]"), ("iterations_per_step", "iterations a step"),
              ("peak_memory", "peak memory [bytes]"))
    figure, all_axes = plt.subplots(1, len(panels), figsize=(12.0, 3.8))
    for axes, (key, label) in zip(all_axes, panels):
        _lines(axes, rows, "particles", key)
        axes.set_ylabel(label, fontsize=9)
        axes.set_xscale("log")
        axes.set_yscale("log")
    all_axes[0].legend(fontsize=8, frameon=False)
    _finish(figure, "Box drape of one size, more and more particles", size, path)
