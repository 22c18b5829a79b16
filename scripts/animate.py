#!/usr/bin/python3
"""Draws a scene as an animation: frames from `simulate`, one GIF. Needs matplotlib and yaml, no ROS.

Every frame is a run of `simulate` that resumes where the last one ended, so the same command always
gives the same picture. Blue: cloth and its mesh; red: probes, and arrows for the forces on them.
Boxes are drawn, other obstacles are not.

Example, the picture of the README:
    scripts/animate.py config/scenes/two_fingers.yaml docs/images/two_fingers.gif --from 0.3 --to 1.7
"""
import argparse
import csv
import os
import subprocess
import tempfile

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import PIL.Image
import yaml
from matplotlib.collections import PolyCollection

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
LIGHT = np.array([0.35, -0.5, 0.8]) / np.linalg.norm([0.35, -0.5, 0.8])
CLOTH, OBSTACLE, PROBE = (0.45, 0.65, 0.95), (0.85, 0.80, 0.72), (0.90, 0.30, 0.25)
FORCE_LENGTH = 0.08  # of the arrow [m/N]
BEHIND = 0.02  # obstacles are drawn as if so much farther away, else coarse cells on them sink in [m]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("out", help="GIF file")
    parser.add_argument("--from", dest="start", type=float, default=0.0, help="time of the first frame [s]")
    parser.add_argument("--to", type=float, default=2.0, help="time of the last frame [s]")
    parser.add_argument("--every", type=float, default=0.04, help="time between two frames [s]")
    parser.add_argument("--slow", type=float, default=2.0, help="slow motion, 2: half as fast")
    parser.add_argument("--build", default=os.path.join(ROOT, "build"), help="build with `simulate`")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="for `simulate`")
    parser.add_argument("--size", type=int, nargs=2, default=(480, 360), help="of the picture [pixels]")
    parser.add_argument("--camera", type=float, nargs=2, default=(30, 24), help="azimuth, elevation [deg]")
    parser.add_argument("--centre", type=float, nargs=3, default=(0.0, 0.0, 0.06), help="of the view [m]")
    parser.add_argument("--span", type=float, default=0.34, help="width of the view [m]")
    return parser.parse_args()


def run(args, until, state, folder):
    """Simulates up to a time, from `state` if that exists; results go to `folder`."""
    program = os.path.join(args.build, "devel", "lib", "haptic_cloth", "simulate")
    command = [program, args.scene, "--out", folder, "--save-state", state]
    for assignment in args.set + [f"stop.time={until}"]:
        command += ["--set", assignment]
    if os.path.exists(state):
        command += ["--resume", state]
    subprocess.run(command, check=True)


def read_mesh(file):
    """Triangles of a PLY file as `simulate` writes it: n x 3 corners x 3 coordinates."""
    with open(file) as stream:
        lines = stream.read().splitlines()
    vertices, faces = (int(line.split()[-1]) for line in lines if line.startswith("element"))
    body = lines[lines.index("end_header") + 1:]
    points = np.array([line.split() for line in body[:vertices]], float)
    corners = np.array([line.split()[1:] for line in body[vertices:vertices + faces]], int)
    return points[corners]


def read_probes(folder):
    """Proxy and force of every probe in the last step."""
    probes = []
    for name in sorted(os.listdir(folder)):
        if name.startswith("probe"):
            with open(os.path.join(folder, name), newline="") as stream:
                rows = list(csv.DictReader(stream))
            if rows:
                probes.append([np.array([float(rows[-1][f"{key}_{c}"]) for c in "xyz"])
                               for key in ("proxy", "force")])
    return probes


def box(obstacle, towards, parts=12):
    """Sides of a box that face the camera, in small quadrilaterals, so that sorting by depth works."""
    half, centre = np.array(obstacle["size"]) / 2, np.array(obstacle.get("position", [0, 0, 0]), float)
    steps = np.linspace(-1, 1, parts + 1)
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for a, b in zip(steps[:-1], steps[1:]):
            for c, d in zip(steps[:-1], steps[1:]):
                corners = np.zeros((4, 3))
                corners[:, axis] = np.sign(towards[axis])
                corners[:, u], corners[:, v] = (a, b, b, a), (c, c, d, d)
                yield centre + half * corners


def sphere(centre, radius, rings=8):
    def point(a, b):
        return centre + radius * np.array([np.sin(a) * np.cos(b), np.sin(a) * np.sin(b), np.cos(a)])
    polar, around = np.linspace(0, np.pi, rings + 1), np.linspace(0, 2 * np.pi, 2 * rings + 1)
    for a, b in zip(polar[:-1], polar[1:]):
        for c, d in zip(around[:-1], around[1:]):
            yield np.array([point(a, c), point(b, c), point(b, d), point(a, d)])


def shade(polygon, colour):
    normal = np.cross(polygon[2] - polygon[0], polygon[-1] - polygon[1 if len(polygon) > 3 else 0])
    length = np.linalg.norm(normal)
    light = abs(normal @ LIGHT) / length if length > 0 else 1.0
    return np.clip(np.array(colour) * (0.5 + 0.5 * light), 0, 1)


def draw(args, scene, folder):
    """One frame: all polygons in parallel projection, the farthest first."""
    azimuth, elevation = np.radians(args.camera)
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0])
    towards = np.array([np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation), np.sin(elevation)])
    screen = np.array([right, np.cross(towards, right)])
    mesh = read_mesh(os.path.join(folder, "mesh.ply"))
    polygons = [(side, shade(side, OBSTACLE), None, BEHIND)
                for obstacle in scene.get("obstacles", []) if obstacle["shape"] == "box"
                for side in box(obstacle, towards)]
    polygons += [(triangle, shade(triangle, CLOTH), (0.15, 0.25, 0.45), 0) for triangle in mesh]
    radius = scene.get("probe", {}).get("radius", 0.008)
    probes = read_probes(folder)
    for proxy, _ in probes:
        polygons += [(side, shade(side, PROBE), None, 0) for side in sphere(proxy, radius)]
    polygons.sort(key=lambda polygon: np.mean(polygon[0] @ towards) - polygon[3])

    width, height = args.size
    figure = plt.figure(figsize=(width / 100, height / 100), dpi=100)
    axes = figure.add_axes([0, 0, 1, 1])
    axes.add_collection(PolyCollection([polygon @ screen.T for polygon, *_ in polygons],
                                       facecolors=[face for _, face, *_ in polygons],
                                       edgecolors=[edge or tuple(face) for _, face, edge, _ in polygons],
                                       linewidths=[0.25 if edge else 0.8 for *_, edge, _ in polygons]))
    for proxy, force in probes:
        if np.linalg.norm(force) > 0.05:
            tail, arrow = screen @ proxy, screen @ (FORCE_LENGTH * force)
            axes.annotate("", tail + arrow, tail, arrowprops={"arrowstyle": "-|>", "color": PROBE, "lw": 2})
    middle = screen @ np.array(args.centre)
    axes.set_xlim(middle[0] - args.span / 2, middle[0] + args.span / 2)
    axes.set_ylim(middle[1] - args.span / 2 * height / width, middle[1] + args.span / 2 * height / width)
    axes.axis("off")
    figure.canvas.draw()
    picture = PIL.Image.fromarray(np.array(figure.canvas.buffer_rgba())).convert("RGB")
    plt.close(figure)
    return picture


def main():
    args = arguments()
    with open(args.scene) as stream:
        scene = yaml.safe_load(stream)
    frames = []
    with tempfile.TemporaryDirectory() as folder:
        state = os.path.join(folder, "animation.state")
        for time in np.arange(args.start, args.to + args.every / 2, args.every):
            run(args, max(round(time, 6), 1e-3), state, os.path.join(folder, "frame"))
            frames.append(draw(args, scene, os.path.join(folder, "frame")))
    palette = frames[len(frames) // 2].quantize(128)
    frames = [frame.quantize(palette=palette, dither=0) for frame in frames]
    frames[0].save(args.out, save_all=True, append_images=frames[1:], loop=0, optimize=True,
                   duration=round(1000 * args.every * args.slow))
    print(f"{args.out}: {len(frames)} frames, {os.path.getsize(args.out) // 1024} KiB")


if __name__ == "__main__":
    main()
