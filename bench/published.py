"""Results of public systems on the scenes of bench/peers/scenes, measured on one 2-core machine.

Other programs ran at the same time, so wall times are accurate to a factor of two; the rest is exact.
One thread unless stated. Strains are the final ones of warp and weft edges; penetration is the largest
of any triangle into the box. (least, most): runs differ. None: not measured.
"""
SOURCE = "measured elsewhere"


def _row(system, step_ms, wall, strain, mean, penetration=None, threads=1, remark=""):
    return {"source": SOURCE, "system": system, "step_ms": step_ms, "threads": threads, "wall_2s": wall,
            "max_strain_percent": strain, "mean_strain_percent": mean, "penetration_mm": penetration, "remark": remark}


def _tip(system, drop_mm, remark):
    return {"source": SOURCE, "system": system, "step_ms": None, "threads": 1, "wall_2s": None,
            "tip_drop_mm": drop_mm, "remark": remark}


CODIM = "Codim-IPC (implicit Newton, barrier)"
ARCSIM = "ARCSim 0.2.1, adaptive"
NVCLOTH = "NvCloth 1.1.6, CPU, %d Hz"
GEL = "explicit particle-spring (CHAI3D GEL)"
JOLT = "Jolt soft body (XPBD)"
PBD = "PositionBasedDynamics (XPBD)"
BULLET = "Bullet btSoftBody"
PROJECTIVE = "projective dynamics (prefactored)"
CLAMP = "its clamp is a full cell, its bending a hinge"

ROWS = {
    "t1": [
        _row(CODIM, 10.0, 876.0, 1.1, 0.067, 0.0, remark="20 x 20 particles: 33 s"),
        _row(ARCSIM, 10.0, (97.0, 150.0), (5.0, 7.5), 0.024, (0.0, 0.26), remark="2100 to 2270 vertices at the end"),
        _row(ARCSIM, 5.0, 117.0, 1.3, 0.022, 0.0),
        _row(NVCLOTH % 300, 10.0, 0.06, 182.0, 7.6, 9.8),
        _row(NVCLOTH % 1000, 10.0, 0.22, 42.0, 0.75, 2.7),
        _row(NVCLOTH % 3000, 10.0, 0.62, 11.0, 0.15, 1.2),
        _row(NVCLOTH % 10000, 10.0, 2.1, 6.9, 0.065, 0.37),
        _row(GEL, 0.05, 5.8, 2.6, 0.038, 3.6),
        _row(JOLT, 10.0, 3.3, 12.8, 0.23, 1.4),
        _row(JOLT, 2.0, 8.2, 5.5, 0.062, 0.6),
        _row(JOLT, 1.0, 16.6, 3.2, 0.040, 0.5),
        _row(JOLT, 10.0, 2.1, 12.8, 0.23, 1.4, threads=2),
        _row(JOLT, 2.0, 5.6, 5.5, 0.062, 0.6, threads=2),
        _row(JOLT, 1.0, 11.1, 3.2, 0.040, 0.5, threads=2),
        _row(PBD, 5.0, 3.5, 10.0, 0.76, 17.0),
        _row(PBD, 1.0, 17.0, 2.5, 0.072, 7.5),
        _row(PBD, 5.0, 2.3, 10.0, 0.76, 17.0, threads=2),
        _row(PBD, 1.0, 10.9, 2.5, 0.072, 7.5, threads=2),
        _row(BULLET, 4.2, 4.7, 16.0, 0.97, 5.3),
        _row(BULLET, 1.0, 10.2, 10.0, 0.25, 1.6),
        _row(PROJECTIVE, 10.0, 1.6, 142.0, 7.0, 11.0),
        _row(PROJECTIVE, 2.0, 8.4, 60.0, 0.34, 7.0),
        _row("ADMM (contact in the global solve)", 10.0, 31.0, (2.1, 3.1), (0.06, 0.08), (2.4, 3.1)),
    ],
    "t2": [
        _row(CODIM, 10.0, 495.0, 8.4, 0.074),
        _row(ARCSIM, 10.0, 1.5, 0.5, 0.043, remark="69 vertices"),
        _row(NVCLOTH % 1000, 10.0, 0.16, 111.0, 1.8),
        _row(NVCLOTH % 3000, 10.0, 0.48, 21.0, 0.33),
        _row(NVCLOTH % 10000, 10.0, 1.6, 2.9, 0.068),
        _row(GEL, 0.1, 2.5, 3.8, 0.16),
        _row(JOLT, 10.0, 2.8, 16.0, 0.34, remark="20 iterations"),
        _row(JOLT, 10.0, 13.6, 4.4, 0.085, remark="100 iterations"),
        _row(PROJECTIVE, 10.0, 1.6, 5.2, 0.083, remark="few iterations"),
        _row(PROJECTIVE, 10.0, 8.6, 2.7, 0.054, remark="many iterations"),
    ],
    "t3": [_tip(CODIM, 173.12, CLAMP)],
    "t3b": [_tip(CODIM, 74.55, CLAMP)],
}
