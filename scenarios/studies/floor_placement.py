"""How many mounts does the floating floor need, and where, for the least acceleration that their travel allows?

Every place of a wire-rope mount may be fitted or left empty, and the two middle rows move fore and aft below the beams. Fewer
mounts are softer, and each carries more: the floor feels less of the shock and travels farther, up to the stops.
"""

import wirerope_mj as wr


def study(
    *,
    level_g: float = 8.0,
    interval: float = 0.4,
    population: int = 48,
    generations: int = 25,
    horizontal: bool = True,
    timestep: float = 2.5e-4,
    seed: int = 1,
) -> wr.Search:
    """Return the search for places of mounts.

    Args:
        level_g: peak acceleration along each axis [g].
        interval: from one shock to the next, which comes from another side [s].
        population: floors of one generation.
        generations: how many generations are tried.
        horizontal: whether places of horizontal mounts may be empty, too.
        timestep: largest step [s].
        seed: of the search.
    """
    if interval < 0.1:
        raise ValueError(f"`interval` must be >= 0.1 s, so that a shock ends before the next, got {interval:g}.")
    peak, sides = level_g * wr.STANDARD_GRAVITY, ((1, 1), (1, -1), (-1, -1), (-1, 1))
    # Each design meets shocks from all four quarters: from one alone, a lopsided floor would be the best.
    pulses = [
        wr.HalfSine(peak=sign * peak, duration=0.011, direction=axis, start=0.02 + number * interval)
        for number, side in enumerate(sides)
        for axis, sign in zip("xyz", (*side, 1), strict=True)
    ]
    fitted = wr.Choice(False, True, each=True)
    places: dict[str, wr.Choice | wr.Uniform] = {"mount/m*/fitted": fitted}
    if horizontal:
        places["mount/h*/fitted"] = fitted
    # Between the transverses' ends and the stops' pads, 5 cm clear of either.
    places["mount/m02,m06,m10,m14/position_shift/x"] = wr.Uniform(-0.7, 1.2)
    places["mount/m03,m07,m11,m15/position_shift/x"] = wr.Uniform(-1.2, 0.7)
    designs = wr.Study(
        model="floating_floor.xml",
        motion=sum(pulses[1:], start=pulses[0]),
        duration=len(sides) * interval,
        vary=places,
        variants=population,
        sampling="latin-hypercube",
        seed=seed,
        timestep=timestep,
    )
    as_drawn = {name: True if name.endswith("fitted") else 0.0 for name in places}
    limits, aims = {"travel": 1.0, "static_load": 1.0}, ("acceleration", "travel")
    return wr.Search(designs, minimise=aims, limits=limits, generations=generations, start=[as_drawn])
