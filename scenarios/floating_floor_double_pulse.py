"""Does the floating floor survive a naval shock given as a three-branch design spectrum?

The double half-sine or double triangle that stands for the spectrum moves the deck, which ends at rest and displaced. The
levels here are an example, not those of a standard: take yours from the specification of the ship.
"""

import wirerope_mj as wr


def scenario(
    *,
    level_g: float = 40.0,
    velocity: float = 2.0,
    displacement_mm: float = 35.0,
    shape: str = "half-sine",
    direction: str = "z",
    factors: tuple[float, float, float] = (0.6, 0.75, 1.05),
    duration: float = 2.0,
    callback: str = "native",
) -> wr.Scenario:
    """Return the naval shock of the floating floor.

    Args:
        level_g: spectral acceleration of the design spectrum [g]; an example, not a standard.
        velocity: spectral pseudo-velocity of the design spectrum [m/s]; an example, not a standard.
        displacement_mm: spectral displacement of the design spectrum [mm]; an example, not a standard: 35 leaves a margin,
            45 exceeds the travel of mounts.
        shape: of the two pulses: half-sine or triangle.
        direction: axis along which the deck is struck: x, y or z.
        factors: peak, velocity and displacement of the pulse over those of the spectrum.
        duration: simulated time [s].
        callback: what makes the mount forces: native or python.
    """
    spectrum = wr.DesignSpectrum(
        displacement=1e-3 * displacement_mm, velocity=velocity, acceleration=level_g * wr.STANDARD_GRAVITY
    )
    if shape not in ("half-sine", "triangle"):
        raise ValueError(f"`shape` must be half-sine or triangle, got {shape!r}.")
    make = spectrum.double_half_sine if shape == "half-sine" else spectrum.double_triangle
    return wr.Scenario(
        question=__doc__ or "",
        model="floating_floor.xml",
        motion=make(direction=direction, factors=factors, start=0.05),
        simulate={"duration": duration, "sample_rate": 1000.0, "callback": callback},
    )
