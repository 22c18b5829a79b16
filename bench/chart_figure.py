"""The picture of bench/chart: one log-log panel per scene and kind of error."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.lines import Line2D

COLOURS = {"finest": "#222222", "coarsest": "#999999", "refine": "#2f8f4e", "coarsen": "#d1721c", "amrc": "#1b4f8f"}
# The first setting that differs from the default and stands here chooses the marker.
MARKERS = (
    ("solver.cost", "X", "cost joint"),
    ("solver.preconditioner", "P", "other preconditioner"),
    ("adapt.refine_above", "D", "other thresholds"),
    ("solver.max_iterations", "v", "other iteration limit"),
    ("solver.tolerance", "s", "other tolerance"),
    ("solver.time_step", "^", "other time step"),
)
PLAIN = ("o", "strategy alone")
# Peers have hollow markers.
PEERS = {"explicit": ("<", "#c2185b"), "XPBD": (">", "#00838f"), "Bullet soft": ("h", "#6d4c41"),
         "Bullet deformable": ("p", "#558b2f")}
# Error, its label, what the reference is known to, and the error of the reference's own mesh.
ERRORS = (("rms_mm", "shape error at the end, rms [mm]", "reference_rms_mm", "mesh_rms_mm"),
          ("force_percent", "probe force error, rms [%]", "reference_force_percent", "mesh_force_percent"))
LINES = ((":", "reference known to"), ("-.", "finest mesh off one twice as fine"))
LEGEND = 1.3  # [inch]
WORST = 100.0  # points with an error more than so many times this package's largest are left out
SHIPPED_STRATEGY = "amrc"


def marker_of(row):
    for key, marker, _ in MARKERS:
        if row[key] != "default":
            return marker
    return PLAIN[0]


def strategy_of(row):
    return SHIPPED_STRATEGY if row["adapt.strategy"] == "default" else row["adapt.strategy"]


def draw_points(axes, rows, error):
    for row in rows:
        if row["program"] in PEERS:
            marker, colour = PEERS[row["program"]]
            axes.plot(row["wall_per_s"], row[error], marker, color=colour, ms=7, mfc="none", mew=1.4, zorder=4)
            continue
        axes.plot(row["wall_per_s"], row[error], marker_of(row), color=COLOURS[strategy_of(row)], ms=5, alpha=0.75,
                  mew=0)
        if row["default"]:
            axes.plot(row["wall_per_s"], row[error], "*", color="#e8112d", ms=15, mec="white", mew=0.8, zorder=5)


def draw_panel(axes, rows, error, label, *known):
    draw_points(axes, rows, error)
    front = sorted((row["wall_per_s"], row[error]) for row in rows if row["front_" + error])
    axes.step([t for t, _ in front], [e for _, e in front], where="post", color="#e8112d", lw=1, alpha=0.8, zorder=1)
    for key, (style, _) in zip(known, LINES):
        if rows[0][key]:
            axes.axhline(rows[0][key], color="0.4", lw=0.8, ls=style)
    axes.axvline(1.0, color="0.4", lw=0.8, ls="--")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.grid(True, which="major", lw=0.3)
    axes.set_title(rows[0]["scene"], fontsize=10)
    axes.set_xlabel("wall time per simulated second [s/s]", fontsize=9)
    axes.set_ylabel(label, fontsize=9)


def legend_entries():
    entries = [Line2D([], [], color=colour, marker="o", ls="", label=name) for name, colour in COLOURS.items()]
    markers = [PLAIN] + [(marker, text) for _, marker, text in reversed(MARKERS)]
    entries += [Line2D([], [], color="0.5", marker=marker, ls="", label=text) for marker, text in markers]
    entries += [Line2D([], [], color=colour, marker=marker, mfc="none", mew=1.4, ls="", label=name)
                for name, (marker, colour) in PEERS.items()]
    entries.append(Line2D([], [], color="#e8112d", marker="*", ms=12, ls="", label="shipped default"))
    entries.append(Line2D([], [], color="#e8112d", lw=1, label="Pareto front"))
    entries += [Line2D([], [], color="0.4", lw=0.8, ls=style, label=text) for style, text in LINES]
    entries.append(Line2D([], [], color="0.4", lw=0.8, ls="--", label="real time"))
    return entries


def draw(path, rows, size):
    panels = []
    for error, *others in ERRORS:
        for scene in dict.fromkeys(row["scene"] for row in rows):
            own = [row for row in rows if row["scene"] == scene and row[error] is not None]
            worst = WORST * max((row[error] for row in own if row["program"] not in PEERS), default=0.0)
            own = [row for row in own if row["program"] not in PEERS or row[error] <= worst]
            if own:
                panels.append((own, error, *others))
    columns = min(3, len(panels))
    lines = -(-len(panels) // columns)
    height = 3.7 * lines + LEGEND
    figure, all_axes = plt.subplots(lines, columns, figsize=(4.6 * columns, height), squeeze=False)
    for axes in all_axes.flat[len(panels):]:
        axes.axis("off")
    for axes, panel in zip(all_axes.flat, panels):
        draw_panel(axes, *panel)
    figure.legend(handles=legend_entries(), loc="lower center", ncol=max(2, 2 * columns), frameon=False, fontsize=9)
    title = "Error against speed%s: left and below is better (errors above %g times this package's largest left out)" % (
        "" if size == "full" else ", %s" % size, WORST)
    figure.suptitle(title, fontsize=12)
    figure.tight_layout(rect=(0, LEGEND / height, 1, 1 - 0.3 / height))
    figure.savefig(path, dpi=110)
    plt.close(figure)
