"""How likely do the floating floor's mounts leave their travel, if every mount is one more specimen of its make?

The scatter is that of five specimens: twins, made up and identified in the virtual rig, because the thesis published no records
of its five springs. Give your own isolator instead, whose file has a [spread].
"""

from pathlib import Path
from typing import Any

import wirerope_mj as wr
from wirerope_mj.foundation.resources import catalogue_folder


def study(
    *,
    isolator: Path | None = None,
    variants: int = 512,
    level_g: float = 15.0,
    mass: float = 0.05,
    offset_mm: float = 50.0,
    level: float = 0.10,
    redraw: int = 0,
    seed: int = 1,
) -> wr.Study:
    """Return the study of specimens.

    Args:
        isolator: file of the sixteen upright mounts, with a [spread]; the five twins if it is not given.
        variants: how many floors are drawn.
        level_g: nominal peak acceleration along each axis [g].
        mass: standard deviation of the floor's mass, as a share; 0 = none, as for the next two.
        offset_mm: standard deviation of the centre of mass along x and y [mm].
        level: standard deviation of the shock's level, as a share.
        redraw: 0 for the isolator as it is; 1, 2, ... for what as many other specimens might have given, each time others.
        seed: of the sampling.
    """
    mount = wr.load_isolator(isolator or catalogue_folder() / "twins" / "five_twins_wr16_400.toml")
    if redraw:
        mount = wr.redrawn(mount, seed=redraw)
    peak = level_g * wr.STANDARD_GRAVITY
    x, y, z = (wr.HalfSine(peak=peak, duration=0.011, direction=axis, start=0.02) for axis in "xyz")
    vary: dict[str, Any] = {"mount/m*/spread": wr.Specimens()}
    if mass:
        vary["body/floor/mass"] = wr.Normal(1.0, mass, relative=True, low=0.5, high=1.5)
    if offset_mm:
        vary |= {f"body/floor/centre_shift/{axis}": wr.Normal(0.0, 1e-3 * offset_mm) for axis in "xy"}
    if level:
        vary["motion/level"] = wr.Normal(1.0, level, low=0.5, high=1.5)
    return wr.Study(
        model="floating_floor.xml",
        isolators={"wr16_400": mount},
        motion=x + y + z,
        duration=0.6,
        vary=vary,
        variants=variants,
        sampling="latin-hypercube",  # of so many inputs some pairs of Sobol's dimensions go hand in hand
        seed=seed,
        timestep=1.25e-4,  # see floor_tolerances
    )
