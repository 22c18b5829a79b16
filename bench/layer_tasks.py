"""Tasks T4 to T6 of bench/peers_table: cloth that meets itself, by this package and by the programs of bench/peers."""
import numpy as np

import peer_programs
import runs
import tables

OWN, OWN_PROGRAM = "haptic_cloth", "own_cloth"
# `bounds`: what Newton's example checks: largest |coordinate| of each axis [m] and largest speed [m/s].
# `corner`: the corner that is taken to the middle.
TASKS = {
    "t4": {"scene": "ribbon"},
    "t5": {"scene": "twist"},
    "t5n": {"scene": "twist_newton", "bounds": ((0.9, 0.6, 0.6), 1.0)},
    "t6": {"scene": "fold", "corner": True},
}
TIME_LIMIT = {"full": 120.0, "quick": 25.0, "smoke": 10.0}  # wall time of the steps of one run [s]
OFF = {"cloth.self_contact": False}


def own(step, strategy="amrc", **other):
    return {"solver.time_step": step, "adapt.strategy": strategy, **other}


CHOICES = {
    "full": [own(0.001, "finest"), own(0.004, "finest"), own(0.001), own(0.004), own(0.004, **OFF)],
    "quick": [own(0.001), own(0.004), own(0.004, **OFF)],
    "smoke": [own(0.01), own(0.01, **OFF)],
}
# Label, program, tasks and command lines of each peer. Bullet's deformable solver loses control of cloth on a floor.
_X, _S, _D = peer_programs.xpbd, peer_programs.soft, peer_programs.deformable
LINES = (
    ("XPBD", "xpbd_cloth", TASKS, {
        "full": [_X(0.001, 10), _X(0.001, 30)], "quick": [_X(0.001, 10)], "smoke": [_X(0.001, 5)]}),
    ("Bullet", "bullet_cloth_double", TASKS, {
        "full": [_S(0.001, 10), _S(0.001, 40)], "quick": [_S(0.001, 10)], "smoke": [_S(0.001, 10)]}),
    ("Bullet", "bullet_cloth_double", ("t5", "t5n"), {"full": [_D(0.001)], "quick": [_D(0.001)], "smoke": []}),
)
COLUMNS = ("system", "step ms", "wall s", "simulated s", "most crossings", "instants with crossings", "stretch %",
           "compression %", "energy gained mJ", "corner from middle mm", "in Newton's bounds")


def row_of(task, system, result, step_ms):
    summary = result.summary
    instants = summary["instants"]
    row = {
        "system": system, "step_ms": step_ms, "wall_per_s": result.wall_per_second, "simulated": summary["simulated_time"],
        "stopped": summary["stopped"], "crossings": [instant["crossings"] for instant in instants],
    }
    if instants:
        row["stretch_percent"] = 100.0 * max(instant["stretch"] for instant in instants)
        row["compression_percent"] = 100.0 * max(instant["compression"] for instant in instants)
    if instants and summary["energy_gained"] is not None:
        row["energy_gained_mj"] = 1e3 * summary["energy_gained"]
    if "corner" in task and not summary["stopped"]:
        row["corner_mm"] = 1e3 * float(np.linalg.norm(result.positions()[-1, -1, :2]))
    if "bounds" in task:
        box, speed = task["bounds"]
        row["in_bounds"] = all(instant["speed"] < speed and np.all(np.array(instant["extent"]) < box)
                               for instant in instants)
    return row


def measure(arguments, programs, name, size, settings):
    """Rows of one task. A run that fails has a row that says how."""
    task, limit = TASKS[name], arguments.time_limit or TIME_LIMIT[size]
    scene = runs.Scene(runs.SCENES / (task["scene"] + ".yaml"), size)
    rows = []

    def run(system, program, overrides, line):
        step_ms = 1e3 * (overrides.get("solver.time_step") or float(line[line.index("--step") + 1]))
        result = programs[program].measure(scene, overrides, (*line, "--limit", str(limit)))
        rows.append(row_of(task, system, result, step_ms) if result else
                    {"system": system, "step_ms": step_ms, "failed": programs[program].failure.split(": ", 1)[-1]})
        print("%-4s %-50s %s" % (name, system[:50], " | ".join(line_of(rows[-1])[2:6])), flush=True)

    for choice in CHOICES[size]:
        words = [choice["adapt.strategy"]] + (["without self-contact"] if OFF.items() <= choice.items() else [])
        run("%s %s" % (OWN, ", ".join(words)), OWN_PROGRAM, dict(settings, **choice), ())
    for label, program, names, lines in LINES:
        for line in lines[size] if program in programs and name in names else ():
            run("%s (%s)" % (label, " ".join(line)), program, {"solver.threads": 1}, line)
    return {"note": scene.note, "rows": rows}


def programs_of(arguments, size):
    """Simulators of the programs that are built; empty without this package's own."""
    folder = peer_programs.folder(arguments)
    names = [OWN_PROGRAM] + [line[1] for line in LINES if not arguments.no_peers]
    limit = 3.0 * (arguments.time_limit or TIME_LIMIT[size]) + 60.0  # the programs end in time themselves
    found = {name: runs.Simulator(folder / name, arguments, limit) for name in names if (folder / name).is_file()}
    return found if OWN_PROGRAM in found else {}


def faults(tasks):
    """What is not as published for these scenes: this package's cloth never crosses itself and stays in its bounds.

    Without self-contact it has to cross itself: else the check could not fail.
    """
    found = []
    for name, task in tasks.items():
        for row in task["rows"]:
            if not row["system"].startswith(OWN):
                continue
            label = "%s, %s, %g ms: " % (name, row["system"], row["step_ms"])
            off = "without" in row["system"]
            if row.get("failed"):
                found.append(label + row["failed"])
            elif off and not row["stopped"] and not any(row["crossings"]):
                found.append(label + "does not cross itself")
            elif not off and any(row["crossings"]):
                found.append(label + "crosses itself")
            elif not off and row.get("in_bounds") is False:
                found.append(label + "leaves the bounds of Newton's example")
    return found


def line_of(row):
    if row.get("failed"):
        return (row["system"], "%.3g" % row["step_ms"], row["failed"]) + ("-",) * (len(COLUMNS) - 3)
    crossings = row["crossings"]
    wall = ("stopped after %.3g" if row["stopped"] else "%.3g") % (row["wall_per_s"] * row["simulated"])
    bounds = {None: "-", True: "yes", False: "**no**"}[row.get("in_bounds")]
    return (row["system"], "%.3g" % row["step_ms"], wall, "%.3g" % row["simulated"],
            str(max(crossings)) if crossings else "-", "%d of %d" % (sum(n > 0 for n in crossings), len(crossings)),
            tables.cell(row.get("stretch_percent"), "%.3g"), tables.cell(row.get("compression_percent"), "%.3g"),
            tables.cell(row.get("energy_gained_mj"), "%.3g"), tables.cell(row.get("corner_mm"), "%.1f"), bounds)


def lines_of(rows, write):
    lines = [line_of(row) for row in rows]
    kept = [k for k in range(len(COLUMNS)) if any(line[k] != "-" for line in lines)]
    return write([COLUMNS[k] for k in kept], [[line[k] for k in kept] for line in lines])


ABOUT = [
    "Crossings: pairs of an edge and a triangle that cut each other, at ten instants evenly spread over the simulated time, "
    "by one check for all ([0033](../decisions/0033-check-for-crossings.md)): on the finest mesh, for this package on the "
    "surface of its own mesh. A run that takes too long is stopped and has fewer instants.",
    "Stretch and compression: the largest along a thread at these instants; in a crease compression is the chord of a fold. "
    "Energy gained: sum of the rises of the total energy from instant to instant; only where nothing drives the cloth (T4).",
    "T5 follows the twist of Codim-IPC, which is published without crossings. T5N is Newton's example `cloth_twist`: "
    "no crossing, all particles within 0.9 m along the axis and 0.6 m across, and slower than 1 m/s. "
    "`explicit` is left out: its cloth does not meet itself. Bullet's probe only carries what it touched when it "
    "closed; its deformable solver throws cloth off a floor, so it is left out of T4 and T6. What the peers do about "
    "layers: [bench/peers](../../bench/peers/README.md). Elsewhere: PositionBasedDynamics (#82) and Jolt (#789) have no "
    "self-collision; NvCloth keeps particles at one fixed distance.",
]
