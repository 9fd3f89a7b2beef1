"""How likely is it that the floating floor's mounts leave their travel, if mounts, load and shock scatter?

Every mount has its own axial stiffness, hysteretic and elastic; sideways they share one. The floor weighs and balances not
quite as planned, and the shock has not quite its level. The scatter is our assumption, not a vendor's figure.
"""

from typing import Any

import wirerope_mj as wr


def study(
    *,
    variants: int = 512,
    level_g: float = 15.0,
    stiffness: float = 0.10,
    mass: float = 0.05,
    offset_mm: float = 50.0,
    level: float = 0.10,
    duration: float = 0.6,
    seed: int = 1,
) -> wr.Study:
    """Return the study of tolerances.

    Args:
        variants: how many floors are drawn.
        level_g: nominal peak acceleration along each axis [g].
        stiffness: standard deviation of the mounts' stiffness, as a share.
        mass: standard deviation of the floor's mass, as a share.
        offset_mm: standard deviation of the centre of mass along x and y [mm].
        level: standard deviation of the shock's level, as a share.
        duration: simulated time [s].
        seed: of the sampling.
    """
    peak = level_g * wr.STANDARD_GRAVITY
    x, y, z = (wr.HalfSine(peak=peak, duration=0.011, direction=axis, start=0.02) for axis in "xyz")
    share: dict[str, Any] = {"relative": True, "low": 0.5, "high": 1.5}
    return wr.Study(
        model="floating_floor.xml",
        motion=x + y + z,
        duration=duration,
        vary={
            "mount/m*/axial/alpha": wr.Normal(1.0, stiffness, each=True, **share),
            "mount/m*/axial/k1": wr.Normal(1.0, stiffness, each=True, **share),
            "mount/m*/shear/alpha": wr.Normal(1.0, stiffness, **share),
            "mount/m*/roll/alpha": wr.Normal(1.0, stiffness, **share),
            "body/floor/mass": wr.Normal(1.0, mass, **share),
            "body/floor/centre_shift/x": wr.Normal(0.0, 1e-3 * offset_mm),
            "body/floor/centre_shift/y": wr.Normal(0.0, 1e-3 * offset_mm),
            "motion/level": wr.Normal(1.0, level, low=0.5, high=1.5),
        },
        variants=variants,
        sampling="latin-hypercube",  # of so many inputs some pairs of Sobol's dimensions go hand in hand
        seed=seed,
        # Accelerations are off by 5e-5 at most, those of floors that strike a stop; see docs/studies.md, "How large a step".
        timestep=1.25e-4,
    )
