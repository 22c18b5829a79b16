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


def draw_threads(path, rows, shares, size):
    """Draws speed over threads. `shares` are counted (bench/thread_parts.py) and may be empty."""
    figure, (left, right, counted) = plt.subplots(1, 3, figsize=(13.0, 3.8))
    _lines(left, rows, "threads", "speedup")
    counts = sorted({row["threads"] for row in rows})
    left.plot(counts, counts, color="0.4", lw=0.8, ls="--", label="threads")
    left.set_ylabel("speedup", fontsize=9)
    left.legend(fontsize=8, frameon=False)
    _lines(right, rows, "threads", "ms_per_step")
    right.set_ylabel("wall time of a step [ms]", fontsize=9)
    right.set_ylim(bottom=0.0)
    for strategy, colour in COLOURS.items():
        for shared, style in (("active lists", "-"), ("active lists, in rows", "--"), ("finest grid", ":")):
            points = [(row["threads"], row["imbalance_percent"]) for row in shares
                      if row["strategy"] == strategy and row["shared"] == shared]
            if points:
                counted.plot(*zip(*points), style, color=colour, label="%s, by %s" % (strategy, shared))
    counted.set_xlabel("threads", fontsize=9)
    counted.set_ylabel("most work of a thread above the mean [%]", fontsize=9)
    counted.set_ylim(0.0, 120.0)
    counted.grid(True, lw=0.3)
    if shares:
        counted.legend(fontsize=8, frameon=False)
    _finish(figure, "Threads", size, path)


def draw_scaling(path, rows, size):
    figure, all_axes = plt.subplots(2, 3, figsize=(12.5, 7.4))
    panels = (("growth", "us_per_iteration", "time of an iteration [us]", "log"),
              ("solved", "iterations_per_step", "iterations a step", "log"),
              ("solved", "ms_per_step", "time of a solved step [ms]", "log"),
              ("growth", "adapt_percent", "following the shape [% of a step]", "linear"),
              ("growth", "peak_memory", "peak memory [bytes]", "log"))
    for axes, (series, key, label, scale) in zip(all_axes.flat, panels):
        _lines(axes, [row for row in rows if row["series"] == series], "particles", key)
        axes.set_xlabel("particles of the finest grid", fontsize=9)
        axes.set_ylabel(label, fontsize=9)
        axes.set_xscale("log")
        axes.set_yscale(scale)
    all_axes[0][0].legend(fontsize=8, frameon=False)
    _draw_active(all_axes[1][2], rows)
    _finish(figure, "Box drape of one size, more and more particles", size, path)


def _draw_active(axes, rows):
    """Draws the cost over active particles: one line for all grids."""
    own = [row for row in rows if row["series"] == "growth"]
    _lines(axes, own, "active", "us_per_iteration")
    levels = [row for row in rows if row["series"] == "levels"]
    if levels:
        axes.plot([row["active"] for row in levels], [row["us_per_iteration"] for row in levels], "s--", color="#d1721c", ms=6,
                  label="one grid of %d, 0 to 5 levels" % levels[0]["particles"])
    axes.set_xlabel("active particles", fontsize=9)
    axes.set_ylabel("time of an iteration [us]", fontsize=9)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.legend(fontsize=8, frameon=False)
