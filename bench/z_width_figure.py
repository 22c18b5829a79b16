"""The picture of bench/z_width: a panel per damping, without and with controller."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.lines import Line2D

QUIET, BUZZ, BOUND = "#1b4f8f", "#e8112d", "#222222"


def draw_panel(axes, rows):
    for row in rows:
        share = 0.2 + 0.8 * min(1.0, row["mean_force"] / row["full_force"])
        axes.plot(1e3 * row["delay"], row["stiffness"], "o" if row["stable"] else "x", ms=4,
                  color=QUIET if row["stable"] else BUZZ, alpha=share if row["stable"] else 1.0, mew=1)
    bound = sorted({(row["delay"], row["bound"]) for row in rows})
    axes.plot([1e3 * delay for delay, _ in bound], [limit for _, limit in bound], color=BOUND, lw=1.2)
    axes.set_yscale("log")
    axes.set_ylim(40, 6500)
    axes.grid(True, which="major", lw=0.3)


def legend_entries():
    return [Line2D([], [], color=QUIET, marker="o", ls="", label="quiet; the paler, the weaker its force"),
            Line2D([], [], color=BUZZ, marker="x", ls="", label="buzzes: more than 0.15 mm"),
            Line2D([], [], color=BOUND, lw=1.2, label="K = (b + B)/(T/2 + delay)")]


def draw(path, rows):
    # Force of the wall (coupling and hand's spring in series): the largest of quiet rows of a K.
    for row in rows:
        row["full_force"] = max(other["mean_force"] for other in rows
                                if other["stiffness"] == row["stiffness"] and other["stable"])
    dampings = sorted({row["damping"] for row in rows})
    figure, all_axes = plt.subplots(2, len(dampings), figsize=(3.8 * len(dampings), 7.0), squeeze=False, sharey=True)
    for line, controller in zip(all_axes, (False, True)):
        for axes, damping in zip(line, dampings):
            draw_panel(axes, [r for r in rows if r["controller"] == controller and r["damping"] == damping])
            axes.set_title("%s controller, mechanism %.1f N·s/m" % ("with" if controller else "without", damping),
                           fontsize=9)
            axes.set_xlabel("delay there and back [ms]", fontsize=9)
    for line in all_axes:
        line[0].set_ylabel("coupling stiffness [N/m]", fontsize=9)
    figure.legend(handles=legend_entries(), loc="lower center", ncol=3, frameon=False, fontsize=9)
    figure.suptitle("Z-width of a rigid wall: 1 kHz, B = 1 N·s/m, 0.1 kg in a hand of 300 N/m and 0.5 N·s/m", fontsize=11)
    figure.tight_layout(rect=(0, 0.05, 1, 1))
    figure.savefig(path, dpi=100)
    plt.close(figure)
