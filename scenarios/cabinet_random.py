"""How much random vibration reaches an 850 kg rack on its mounts, and how far do the mounts travel in it?

The density is constant up to a corner and falls by 6 dB per octave from there; the level is its overall rms.
"""

import wirerope_mj as wr


def scenario(
    *,
    level_g: float = 0.5,
    low_hz: float = 5.0,
    corner_hz: float = 50.0,
    high_hz: float = 200.0,
    direction: str = "z",
    seed: int = 1,
    duration: float = 30.0,
    callback: str = "native",
) -> wr.Scenario:
    """Return the random vibration of the rack.

    Args:
        level_g: overall rms acceleration of the deck [g]; an example, not a standard.
        low_hz: where the density begins [Hz].
        corner_hz: where it begins to fall [Hz].
        high_hz: where it ends [Hz].
        direction: axis along which the deck vibrates: x (front to back), y (sideways) or z.
        seed: chooses one of all the vibrations of that density.
        duration: simulated time, with rise and fall of the vibration [s].
        callback: what makes the mount forces: native or python.
    """
    if not 0.0 < low_hz < corner_hz < high_hz:
        raise ValueError(f"0 < `low_hz` < `corner_hz` < `high_hz` must hold, got {low_hz}, {corner_hz} and {high_hz}.")
    shape = [(low_hz, 1.0), (corner_hz, 1.0), (high_hz, (corner_hz / high_hz) ** 2)]
    scale = (level_g * wr.STANDARD_GRAVITY / wr.motions.psd_rms(shape)) ** 2
    psd = [(frequency, scale * level) for frequency, level in shape]
    # The vibration must have time to rise and fall, whatever part of it is simulated.
    motion = wr.RandomVibration(psd=psd, duration=max(duration, 2.0 / low_hz), seed=seed, direction=direction)
    return wr.Scenario(
        question=__doc__ or "",
        model="cabinet.xml",
        motion=motion,
        simulate={"duration": duration, "sample_rate": max(1000.0, 8.0 * high_hz), "callback": callback},
    )
