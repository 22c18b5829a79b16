"""The programs of bench/peers, where they are built, and their command lines."""
import pathlib

import runs


def xpbd(step, substeps):
    return ("--step", str(step), "--substeps", str(substeps))


def soft(step, iterations):
    return ("--solver", "soft", "--step", str(step), "--iterations", str(iterations))


def deformable(step, iterations=300):
    return ("--solver", "deformable", "--step", str(step), "--iterations", str(iterations))


# Name on charts, program, whether it has a force on the probe, command lines by size.
# explicit_cloth chooses its largest stable step itself.
PEERS = (
    ("explicit", "explicit_cloth", True, {"full": [()], "quick": [()], "smoke": [()]}),
    ("XPBD", "xpbd_cloth", True, {
        "full": [xpbd(0.01, 10), xpbd(0.01, 30), xpbd(0.005, 30), xpbd(0.001, 5), xpbd(0.001, 10), xpbd(0.001, 20),
                 xpbd(0.001, 60)],
        "quick": [xpbd(0.01, 30), xpbd(0.001, 10), xpbd(0.001, 20)],
        "smoke": [xpbd(0.001, 5)]}),
    ("Bullet soft", "bullet_cloth", False, {
        "full": [soft(0.004, 10), soft(0.002, 10), soft(0.001, 10), soft(0.001, 40), soft(0.001, 100)],
        "quick": [soft(0.004, 10), soft(0.001, 10), soft(0.001, 40)],
        "smoke": [soft(0.001, 10)]}),
    ("Bullet deformable", "bullet_cloth", False, {
        "full": [deformable(0.004), deformable(0.001), deformable(0.001, 50), deformable(0.00025)],
        "quick": [deformable(0.004), deformable(0.001)],
        "smoke": [deformable(0.001)]}),
)
NAMES = tuple(peer[0] for peer in PEERS)


def add_arguments(parser):
    parser.add_argument("--peers", metavar="DIR", type=pathlib.Path,
                        help="where the programs of bench/peers lie (default: beside simulate); those missing are left out")
    parser.add_argument("--no-peers", action="store_true", help="leaves out all programs of bench/peers")


def folder(arguments):
    return arguments.peers or pathlib.Path(arguments.simulate).resolve().parent


class Peers:
    """The programs of bench/peers that are built."""

    def __init__(self, arguments, size, time_limit):
        self.size = size
        self.simulators = {}
        if arguments.no_peers:
            return
        for program in dict.fromkeys(peer[1] for peer in PEERS):
            path = folder(arguments) / program
            if path.is_file():
                self.simulators[program] = runs.Simulator(path, arguments, time_limit)
            else:
                print("%s: not there, left out (the tests or -DHAPTIC_CLOTH_BENCH=ON build it)" % path)

    def measure(self, scene):
        """(name, command line, result) of each completed run; one thread each, without self-contact."""
        for name, program, feels, lines in PEERS:
            if program not in self.simulators or (scene.has_probe and not feels):
                continue
            for line in lines[self.size]:
                result = self.simulators[program].measure(
                    scene, {"solver.threads": 1, "cloth.self_contact": False}, line)
                if result is not None:
                    yield name, " ".join(line), result
