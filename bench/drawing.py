"""Oblique views of meshes, coloured by level."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D

AZIMUTH, ELEVATION = np.radians(35.0), np.radians(32.0)
LEVEL_COLOURS = ("#1b4f8f", "#d1721c", "#2f8f4e", "#8f2f7a", "#777777", "#777777", "#777777", "#777777", "#777777")


def read_cells(directory):
    """Corners [m] of each cell in cyclic order, and its level."""
    lines = (directory / "mesh.ply").read_text().split("\n")
    end = lines.index("end_header")
    vertices = int(lines[2].split()[-1])
    text = lines[end + 1:end + 1 + vertices]
    faces = [[int(n) for n in line.split()[1:]] for line in lines[end + 1 + vertices:] if line]
    points = np.array([[float(word) for word in line.split()] for line in text])
    column = _columns(directory)
    cells, levels = [], []
    for (a, b, d), (_, _, c) in zip(faces[0::2], faces[1::2]):
        # The two triangles of a cell are (00, 10, 11) and (00, 11, 01).
        cells.append(points[[a, b, d, c]])
        span = column[text[b]] - column[text[a]]
        levels.append(int(span).bit_length() - 1)
    return np.array(cells), np.array(levels)


def _columns(directory):
    """Finds the column of a particle by the text of its position; both files have all digits."""
    with open(directory / "particles.csv") as stream:
        next(stream)
        rows = (line.strip().split(",") for line in stream)
        return {" ".join(row[3:6]): int(row[0]) for row in rows}


def project(points):
    """Oblique view: two coordinates in the picture and the distance from the viewer."""
    cos_a, sin_a = np.cos(AZIMUTH), np.sin(AZIMUTH)
    across = cos_a * points[..., 0] - sin_a * points[..., 1]
    away = sin_a * points[..., 0] + cos_a * points[..., 1]
    up = np.cos(ELEVATION) * points[..., 2] + np.sin(ELEVATION) * away
    depth = np.cos(ELEVATION) * away - np.sin(ELEVATION) * points[..., 2]
    return np.stack([across, up], axis=-1), depth


def draw_mesh(axes, directory):
    """Draws filled cells, the farthest first, so that nearer ones hide them."""
    cells, levels = read_cells(directory)
    flat, depth = project(cells)
    order = np.argsort(-depth.mean(axis=1))
    colours = [LEVEL_COLOURS[level] for level in levels[order]]
    axes.add_collection(PolyCollection(1e3 * flat[order], facecolors="white", edgecolors=colours, linewidths=0.45))
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.axis("off")
    return sorted(set(levels.tolist()))


def draw_row(path, pictures, remark):
    """Draws pictures, each (directory, title), side by side, with a remark beside the legend."""
    figure, all_axes = plt.subplots(1, len(pictures), figsize=(3.6 * len(pictures), 3.3))
    levels = set()
    for axes, (directory, text) in zip(all_axes, pictures):
        levels.update(draw_mesh(axes, directory))
        axes.set_title(text, fontsize=10)
    names = ["level %d%s" % (level, " (finest)" if level == 0 else "") for level in sorted(levels)]
    lines = [Line2D([], [], color=LEVEL_COLOURS[level]) for level in sorted(levels)]
    figure.legend(lines, names, loc="lower center", ncol=len(names), frameon=False, fontsize=10)
    figure.text(0.01, 0.03, remark, fontsize=9, color="0.4")
    figure.tight_layout(rect=(0, 0.06, 1, 1))
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    plt.close(figure)
