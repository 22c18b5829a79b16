"""The picture of bench/realtime: error of the force over speed, and durations of steps."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

THREADS = {1: ("o", "#1b4f8f"), 2: ("s", "#d1721c")}
OTHER = ("^", "#2f8f4e")
LIMIT_MS = 1.0  # the scene's time step


def draw_errors(axes, rows, known_to):
    """Draws one point per row; its number is that of a line below."""
    for k, row in enumerate(rows):
        if row["force_percent"] is None:
            continue
        marker, colour = THREADS.get(row["threads"], OTHER)
        axes.plot(row["real_time_factor"], row["force_percent"], marker, color=colour, ms=6, mew=0)
        axes.annotate(str(k + 1), (row["real_time_factor"], row["force_percent"]), fontsize=7,
                      xytext=(4, 3), textcoords="offset points")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.axvline(1.0, color="0.4", lw=0.8, ls="--")
    if known_to:
        axes.axhline(known_to, color="0.4", lw=0.8, ls=":")
    axes.grid(True, lw=0.3)
    axes.set_xlabel("real-time factor: right is quicker, dashed: real time", fontsize=9)
    axes.set_ylabel("probe force error, rms [%]", fontsize=9)


def draw_steps(axes, rows):
    """Draws p50, p99 and the longest step."""
    for k, row in enumerate(rows):
        _, colour = THREADS.get(row["threads"], OTHER)
        axes.plot([row["p50_ms"], row["max_ms"]], [k, k], color=colour, lw=1)
        axes.plot(row["p50_ms"], k, "o", color=colour, ms=5)
        axes.plot(row["p99_ms"], k, "|", color=colour, ms=9, mew=2)
        axes.plot(row["max_ms"], k, "x", color=colour, ms=5)
    axes.set_yticks(range(len(rows)))
    axes.set_yticklabels(["%d  %s, %d thread%s" % (k + 1, row["setting"], row["threads"], "s"[:row["threads"] - 1])
                          for k, row in enumerate(rows)], fontsize=7)
    axes.invert_yaxis()
    axes.set_xscale("log")
    axes.axvline(LIMIT_MS, color="0.4", lw=0.8, ls="--")
    axes.grid(True, axis="x", lw=0.3)
    axes.set_xlabel("wall time of a step [ms]: dot p50, bar p99, cross longest; dashed: the time step", fontsize=9)


def draw(path, rows, known_to, size):
    figure, (above, below) = plt.subplots(2, 1, figsize=(9.0, 5.6 + 0.19 * len(rows)),
                                          gridspec_kw={"height_ratios": [4.4, 0.8 + 0.19 * len(rows)]})
    draw_errors(above, rows, known_to)
    draw_steps(below, rows)
    figure.suptitle("Haptic scene, probe pressing and sliding%s" % ("" if size == "full" else " (%s)" % size), fontsize=12)
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    plt.close(figure)
