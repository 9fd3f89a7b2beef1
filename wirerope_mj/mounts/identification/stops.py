"""A bump stop in cyclic tests, bare or beside a law that is known: its coordinates, and the sides that close."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy

from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.identification.coordinates import Coordinate, Family, Scales
from wirerope_mj.mounts.identification.measured import MeasuredLoop
from wirerope_mj.mounts.laws import Law, Parallel, Stop

HINGES = 12  # Gaps of the springs that make up any stop, evenly over the reach of a side
SURE = 30.0  # Variances by which a side has to lessen the sum of squares: in noise its springs find some ten
# Fraction of a loop's force range that a closed side carries at least: a law beside it is seldom known better.
LEAST = 0.02
ELASTIC = 1e-6  # Loss below which a stop is elastic: no test shows it, and the state of a lossy one costs time


def _coordinates(s: Scales) -> list[Coordinate]:
    x, f = s.deflection, s.force
    gaps = [
        Coordinate(name, "m", 0.0, reach, scale=x, stiffness=True)
        for name, reach in (("gap_below", s.below), ("gap_above", s.above))
        if reach > 0.0
    ]
    # The depth may be a hundredth of the amplitude, and k is the force over its power.
    return [
        *gaps,
        Coordinate("k", "N/m^exponent", 1e-4 * f / x, f / (0.01 * x) ** 3, linear=True, stiffness=True),
        Coordinate("exponent", "-", 1.0, 3.0, stiffness=True),
        Coordinate("rounding", "m", 0.0, 2.0 * x, scale=x, stiffness=True),
        Coordinate("loss", "-", 0.0, 1.0),
        Coordinate("reversal", "m", 1e-4 * x, 10.0 * x),
    ]


def _make(values: dict[str, float]) -> Law:
    if values["loss"] < ELASTIC:
        values = {key: value for key, value in values.items() if key not in ("loss", "reversal")}
    return Stop(**values)  # type: ignore[arg-type]


def _read(law: Law) -> dict[str, float]:
    assert isinstance(law, Stop)
    values = {
        key: getattr(law, key) for key in ("gap_below", "gap_above", "k", "exponent", "rounding", "loss", "reversal")
    }
    return {key: value for key, value in values.items() if value is not None}


# Stops with a gap on the sides that close; viscous loss does not show in quasi-static tests.
STOP = Family(coordinates=_coordinates, make=_make, read=_read, usual={"exponent": 1.0, "rounding": 0.0})


def beside_known(family: Family, known: Law | None) -> Family:
    """Return the family of laws in parallel with one that is known."""
    if known is None:
        return family
    return replace(family, make=lambda values: Parallel(laws=(*known.components, *family.make(values).components)))


def closing(loops: Sequence[MeasuredLoop], known: Law | None) -> tuple[list[MeasuredLoop], dict[str, float]]:
    """Return the loops that count for a stop, and how far beyond zero the sides that close were pressed [m], 0 of others.

    Loops within the gap of a bare stop hold noise alone and do not count.

    Raises:
        ValueError: none closes.
    """
    counted = [loop for loop in loops if known is not None or closes(loop)]
    low, high = (pick(float(pick(loop.deflection)) for loop in loops) for pick in (min, max))
    sides = _closed(counted, known) if counted else (False, False)
    if not any(sides):
        beyond = "" if known is None else f" beside the {known.name} law"
        raise ValueError(
            f"no loop closes a stop: between {1e3 * low:.4g} and {1e3 * high:.4g} mm no force is left{beyond} that grows "
            "towards an end. Test larger amplitudes, or about an operating point nearer to the stop."
        )
    return counted, {"below": max(-low, 0.0) * sides[0], "above": max(high, 0.0) * sides[1]}


def closes(loop: MeasuredLoop) -> bool:
    """Return True if a loop of a bare stop closes it."""
    return any(_closed([loop], None))


def _closed(loops: Sequence[MeasuredLoop], known: Law | None) -> tuple[bool, bool]:
    """Return two booleans: a stop pushes at the lower end, and at the upper one.

    Any elastic force that only grows with the depth is a sum of springs behind gaps, and a lossy one has another sum on the way
    back. They are fitted with stiffnesses >= 0; a side is closed if the fit without it is worse for sure.
    """
    left = [loop.force - (0.0 if known is None else loop.model_force(known)) for loop in loops]
    force = np.concatenate([(f - f.mean()) / loop.weight for f, loop in zip(left, loops, strict=True)])
    below, above = (_springs(loops, side) for side in (-1.0, 1.0))

    def cost(*sides: Array) -> tuple[float, Array]:
        matrix = np.hstack(sides)
        springs = scipy.optimize.lsq_linear(matrix, force, (0.0, np.inf)).x
        return float(np.sum((matrix @ springs - force) ** 2)), springs

    both, stiffness = cost(below, above)
    halves = np.split(stiffness, 2)
    gains = [(cost(other)[0] - both) / max(both / force.size, 1e-12) for other in (above, below)]
    pushes = [float(np.ptp(part @ half)) for part, half in zip((below, above), halves, strict=True)]
    first, second = (gain > SURE and push > LEAST * np.ptp(force) for gain, push in zip(gains, pushes, strict=True))
    return bool(first), bool(second)


def _springs(loops: Sequence[MeasuredLoop], side: float) -> Array:
    """Return forces (n_t, n) of unit springs behind gaps on one side, those of pressing and letting go apart, without means."""
    reach = max(0.0, *(float((side * loop.deflection).max()) for loop in loops))
    gaps, rows = np.linspace(0.0, reach, HINGES, endpoint=False), []
    for loop in loops:
        pressed = (side * np.gradient(loop.deflection) > 0.0)[:, None]
        springs = side * np.maximum(side * loop.deflection[:, None] - gaps, 0.0) / loop.weight
        columns = np.hstack([springs * pressed, springs * ~pressed])
        rows.append(columns - columns.mean(axis=0))
    return np.concatenate(rows)
