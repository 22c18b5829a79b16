"""The picture of bench/realtime: error of the force and quality given up, by scene, threads and load."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

COLOURS = ("#1b4f8f", "#d1721c", "#2f8f4e")  # by load
LEAST_PERCENT = 0.1  # drawn for less


def draw(path, rows, words):
    names = list(dict.fromkeys(row["scene"] for row in rows))
    choices = list(dict.fromkeys((row["threads"], row["burners"]) for row in rows))
    loads = sorted({row["burners"] for row in rows})
    figure, (above, below) = plt.subplots(2, 1, figsize=(8.4, 5.6), sharex=True)
    width = 0.8 / len(choices)
    for k, (threads, burners) in enumerate(choices):
        own = {row["scene"]: row for row in rows if (row["threads"], row["burners"]) == (threads, burners)}
        places = [names.index(name) + (k - 0.5 * (len(choices) - 1)) * width for name in own]
        style = {"color": COLOURS[loads.index(burners) % len(COLOURS)], "alpha": threads ** -0.86,
                 "label": "%d thread%s, %d burners" % (threads, "s"[:threads - 1], burners)}
        above.bar(places, [max(row["force_percent"] or 0.0, LEAST_PERCENT) for row in own.values()], 0.9 * width, **style)
        below.bar(places, [row["mean_rung"] for row in own.values()], 0.9 * width, **style)
        for place, row in zip(places, own.values()):
            below.annotate("%.2f" % row["time_ratio"], (place, row["mean_rung"]), ha="center", va="bottom", fontsize=6)
    above.set_yscale("log")
    above.set_ylabel("probe force error, rms [%]", fontsize=9)
    above.legend(fontsize=7)
    above.set_title(words, fontsize=8)
    below.set_ylabel("mean rung; above: simulated / wall", fontsize=9)
    below.set_xticks(range(len(names)), names, fontsize=8)
    for axes in (above, below):
        axes.grid(True, axis="y", lw=0.3)
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    plt.close(figure)
