"""Errors of a run against the reference of its scene, and the Pareto front of error over time."""
import math

import numpy as np

from runs import BenchError

# Contact begins when the reference's force first exceeds this share of its largest value.
CONTACT_SHARE = 0.01
# Largest change of a reference between its two levels, over the error of the coarsest mesh.
WELL_POSED = 0.1
# Keys of the errors of shape and of force in rows of tables.
ERRORS = ("rms_mm", "force_percent")


def shape_error(result, reference):
    """RMS and largest distance between equal particles [mm]; the reference may have a multiple of the cells."""
    own, other = result.positions(), reference.positions()
    every = (len(other) - 1) // (len(own) - 1)
    distance = 1e3 * np.linalg.norm(own - other[::every, ::every], axis=2)
    return math.sqrt(np.mean(distance**2)), float(distance.max())


def force_error(result, reference):
    """RMS of the difference of probe forces over the RMS of the reference's, after contact [%]."""
    times, forces = reference.probe()
    own_times, own_forces = result.probe()
    if len(times) == 0 or len(own_times) == 0:
        return None
    size = np.linalg.norm(forces, axis=1)
    if size.max() == 0.0:
        return None
    begin = int(np.argmax(size > CONTACT_SHARE * size.max()))
    times, forces = times[begin:], forces[begin:]
    same = np.stack([np.interp(times, own_times, own_forces[:, axis]) for axis in range(3)], axis=1)
    return 100.0 * math.sqrt(np.sum((same - forces)**2) / np.sum(forces**2))


def potential(result):
    energy = result.summary["energy"]
    return sum(energy[key] for key in ("gravity", "stretch", "bend", "shear", "contact"))


def energy_error(result, reference):
    """Difference of the final potential energies over the energy released in the reference [%]."""
    released = reference.digest["first_potential"] - potential(reference)
    return 100.0 * (potential(result) - potential(reference)) / abs(released)


class Errors:
    """All errors of one run."""

    def __init__(self, result, reference):
        self.rms, self.largest = shape_error(result, reference)
        self.force = force_error(result, reference)
        self.energy = energy_error(result, reference)


class Reference:
    """The converged result of a scene, and its distance from one with twice step and tolerance.

    With `finer` also its distance from one on a mesh twice as fine, if the scene allows that: the error of the
    finest mesh itself, which all strategies share.
    """

    def __init__(self, simulator, scene, finer=False):
        self.result, check = simulator.reference(scene)
        self.uncertainty = Errors(check, self.result)
        fine = simulator.finer(scene, self.result) if finer else None
        self.mesh = Errors(self.result, fine) if fine else None

    def errors(self, result):
        return Errors(result, self.result)

    def verdict(self, coarsest_rms):
        """Whether the reference is known to a tenth of the coarsest mesh's error."""
        share = self.uncertainty.rms / coarsest_rms if coarsest_rms > 0.0 else math.inf
        word = "well-posed" if share < WELL_POSED else "NOT well-posed"
        words = "%s, the reference moves by %.3g mm rms with twice its time step and tolerance, %.0f %% of the " \
            "coarsest mesh's error" % (word, self.uncertainty.rms, 100 * share)
        if self.mesh:
            force = "" if self.mesh.force is None else ", and its force %.2g %%," % self.mesh.force
            words += "; it is %.3g mm rms%s off one on a mesh twice as fine" % (self.mesh.rms, force)
        return words


def pareto_front(points):
    """Indices of the (time, error) points that no other point beats in both, ordered by time."""
    order = sorted(range(len(points)), key=lambda k: points[k])
    front, best = [], math.inf
    for k in order:
        if points[k][1] < best:
            best = points[k][1]
            front.append(k)
    return front


def mark_fronts(rows, time):
    """Adds which rows are on the front of shape and of force over a time, `front_rms_mm` and `front_force_percent`."""
    for error in ERRORS:
        measured = [row for row in rows if row[error] is not None]
        front = pareto_front([(row[time], row[error]) for row in measured])
        for k, row in enumerate(measured):
            row["front_" + error] = int(k in front)


def fronts_of(row):
    """Names of the fronts that a row is on."""
    return [name for name, key in (("shape", "front_rms_mm"), ("force", "front_force_percent")) if row.get(key)]


def error_at_time(points, time):
    """Least error within a time; None if no point is that fast."""
    within = [error for wall, error in points if wall <= time]
    return min(within) if within else None


def distance_to_front(points, own):
    """Ratios to the best time for the same error, and to the least error in the same time."""
    same_error = min(wall for wall, error in points if error <= own[1])
    same_time = error_at_time(points, own[0])
    if same_time is None or own not in points:
        raise BenchError("the point is none of those that the front is made of")
    return own[0] / same_error, own[1] / same_time if same_time > 0.0 else 1.0


def edge_strains(result, size):
    """Largest stretch, largest compression and mean |strain| of the final shape, none negative.

    They are those of warp and weft threads of the finest grid, for a cloth of a size [m]. The mean is
    weighted by area.
    """
    positions = result.positions()
    rows, columns = positions.shape[:2]
    warp = np.linalg.norm(np.diff(positions, axis=1), axis=2) * (columns - 1) / size[0] - 1.0
    weft = np.linalg.norm(np.diff(positions, axis=0), axis=2) * (rows - 1) / size[1] - 1.0
    # Threads along a border represent half a cell.
    warp_weight, weft_weight = np.ones_like(warp), np.ones_like(weft)
    warp_weight[[0, -1], :] = 0.5
    weft_weight[:, [0, -1]] = 0.5
    strains = np.concatenate([warp.ravel(), weft.ravel()])
    weights = np.concatenate([warp_weight.ravel(), weft_weight.ravel()])
    return (max(0.0, float(strains.max())), max(0.0, -float(strains.min())),
            float(np.average(np.abs(strains), weights=weights)))


def box_penetration(result, size, centre, parts=8):
    """Largest final depth of a triangle of the finest grid in a box [m], `parts` samples a side."""
    x = result.positions() - np.asarray(centre)
    half = 0.5 * np.asarray(size)
    deepest = 0.0
    corners = (x[:-1, :-1], x[:-1, 1:], x[1:, 1:], x[1:, :-1])
    for a, b, c in ((0, 1, 2), (0, 2, 3)):
        for k in range(parts + 1):
            for m in range(parts + 1 - k):
                u, v = k / parts, m / parts
                point = (1.0 - u - v) * corners[a] + u * corners[b] + v * corners[c]
                deepest = max(deepest, float(np.min(half - np.abs(point), axis=2).max()))
    return deepest


def tip_drop(result):
    """Height of the first column above the last one [m]."""
    heights = result.positions()[:, :, 2]
    return float(heights[:, 0].mean() - heights[:, -1].mean())
