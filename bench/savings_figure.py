"""The picture of bench/savings: bars, one panel per group of times."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

PANELS = (("terms", "terms of the fabric"), ("contact", "contact"), ("sleep, at rest", "drape at rest"),
          ("sleep, touched", "drape touched"))
FIRST, OTHER = "#999999", "#1b4f8f"


def draw(path, rows, size):
    groups = [[row for row in rows if row["group"] == group] for group, _ in PANELS]
    figure, all_axes = plt.subplots(len(PANELS), 1, figsize=(8.5, 1.2 * len(PANELS) + 0.32 * sum(map(len, groups))),
                                    gridspec_kw={"height_ratios": [len(g) + 1 for g in groups]})
    for axes, group, (_, title) in zip(all_axes, groups, PANELS):
        values = [row["value"] for row in group]
        colours = [FIRST] + [OTHER] * (len(group) - 1)
        axes.barh([row["case"] for row in group], values, color=colours)
        for k, row in enumerate(group):
            ratio = "" if k == 0 or row["ratio"] is None else "  (x %.3g)" % row["ratio"]
            axes.text(row["value"], k, " %.3g%s" % (row["value"], ratio), va="center", fontsize=8)
        axes.set_xlim(0.0, 1.3 * max(values))
        axes.invert_yaxis()
        axes.set_title("%s: %s" % (title, group[0]["what"]), fontsize=10, loc="left")
        axes.tick_params(labelsize=8)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    figure.suptitle("No more model than a scene needs%s" % ("" if size == "full" else " (%s)" % size), fontsize=12)
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    plt.close(figure)
