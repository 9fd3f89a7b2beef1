"""Which of stiffness, mass, balance, level and direction decide what the floating floor's equipment and mounts suffer?

Sobol's indices tell what each explains of the scatter alone, and what it explains together with the others. A half-sine
strikes from anywhere above the horizon. The scatter is our assumption, not a vendor's figure.
"""

from typing import Any

import wirerope_mj as wr


def study(
    *,
    rows: int = 512,
    level_g: float = 20.0,
    stiffness: float = 0.10,
    mass: float = 0.05,
    offset_mm: float = 50.0,
    level: float = 0.10,
    duration: float = 0.6,
    seed: int = 1,
) -> wr.Study:
    """Return the study of sensitivity.

    Args:
        rows: a power of two; seven floors are drawn for each.
        level_g: nominal peak acceleration along the direction [g].
        stiffness: standard deviation of the mounts' stiffness, each its own, as a share.
        mass: standard deviation of the floor's mass, as a share.
        offset_mm: standard deviation of the centre of mass along x and y [mm].
        level: standard deviation of the shock's level, as a share.
        duration: simulated time [s].
        seed: of the sampling.
    """
    share: dict[str, Any] = {"relative": True, "low": 0.5, "high": 1.5}
    own: dict[str, Any] = {"each": True, "group": "stiffness", **share}
    return wr.Study(
        model="floating_floor.xml",
        motion=wr.HalfSine(peak=level_g * wr.STANDARD_GRAVITY, duration=0.011, direction="z", start=0.02),
        duration=duration,
        vary={
            **{f"mount/m*/{axis}/alpha": wr.Normal(1.0, stiffness, **own) for axis in ("axial", "shear", "roll")},
            **{f"mount/m*/{axis}/k1": wr.Normal(1.0, stiffness, **own) for axis in ("axial", "shear", "roll")},
            "body/floor/mass": wr.Normal(1.0, mass, group="mass", **share),
            "body/floor/centre_shift/x": wr.Normal(0.0, 1e-3 * offset_mm, group="centre of mass"),
            "body/floor/centre_shift/y": wr.Normal(0.0, 1e-3 * offset_mm, group="centre of mass"),
            "motion/level": wr.Normal(1.0, level, low=0.5, high=1.5, group="level"),
            "motion/azimuth": wr.Uniform(-180.0, 180.0, group="direction"),
            "motion/elevation": wr.Isotropic(low=0.0, high=90.0, group="direction"),
        },
        variants=7 * rows,
        sampling="sobol-indices",
        seed=seed,
        timestep=1.25e-4,  # see floor_tolerances
    )
