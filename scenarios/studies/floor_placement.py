"""How many mounts does the floating floor need, and where, for the least acceleration that their travel allows?

Every place of a wire-rope mount may be fitted or left empty, and the two middle rows move fore and aft below the beams. Fewer
mounts are softer: the floor feels less of the shock and travels farther, up to the rated travel and the stops behind it.
"""

import wirerope_mj as wr


def study(
    *,
    level_g: float = 12.0,
    direction: str = "xyz",
    population: int = 48,
    generations: int = 25,
    horizontal: bool = True,
    duration: float = 0.4,
    timestep: float = 5e-4,
    seed: int = 1,
) -> wr.Search:
    """Return the search for places of mounts.

    Args:
        level_g: peak acceleration along each axis [g].
        direction: axes along which the deck is struck: x, y, z, xy, xyz, ...
        population: floors of one generation.
        generations: how many generations are tried.
        horizontal: whether places of horizontal mounts may be empty, too.
        duration: simulated time [s].
        timestep: largest step [s].
        seed: of the search.
    """
    if not direction or not set(direction) <= set("xyz"):
        raise ValueError(f"`direction` must name axes, such as xyz or z, got {direction!r}.")
    peak = level_g * wr.STANDARD_GRAVITY
    pulses = [wr.HalfSine(peak=peak, duration=0.011, direction=axis, start=0.02) for axis in direction]
    fitted = wr.Choice(False, True, each=True)
    places: dict[str, wr.Choice | wr.Uniform] = {"mount/m*/fitted": fitted}
    if horizontal:
        places["mount/h*/fitted"] = fitted
    # Between the transverses' ends and the stops' pads, 5 cm clear of either.
    places["mount/m02,m06,m10,m14/position/x"] = wr.Uniform(-0.7, 1.2)
    places["mount/m03,m07,m11,m15/position/x"] = wr.Uniform(-1.2, 0.7)
    designs = wr.Study(
        model="floating_floor.xml",
        motion=sum(pulses[1:], start=pulses[0]),
        duration=duration,
        vary=places,
        variants=population,
        sampling="latin-hypercube",
        seed=seed,
        timestep=timestep,
    )
    as_drawn = {name: True if name.endswith("fitted") else 0.0 for name in places}
    return wr.Search(
        designs, minimise=("acceleration", "travel"), limits={"travel": 1.0}, generations=generations, start=[as_drawn]
    )
