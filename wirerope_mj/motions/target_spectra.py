"""Spectra that standards prescribe: of earthquakes, for `match_spectrum` and files of levels; of naval shock, as pulses."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields

import numpy as np

from wirerope_mj.foundation.arguments import between, one_of, positive
from wirerope_mj.foundation.arrays import Array, ArrayLike
from wirerope_mj.motions import ranges
from wirerope_mj.motions.double_pulses import DoubleHalfSine, DoubleTriangle
from wirerope_mj.motions.phrases import SpokenMotion

# soil factor and corner periods TB, TC, TD [s] that EN 1998-1 recommends for its ground types, from memory; a national annex
# may have others
EN1998_TYPE_1 = {
    "A": {"soil_factor": 1.0, "corner_periods": (0.15, 0.4, 2.0)},
    "B": {"soil_factor": 1.2, "corner_periods": (0.15, 0.5, 2.0)},
    "C": {"soil_factor": 1.15, "corner_periods": (0.2, 0.6, 2.0)},
    "D": {"soil_factor": 1.35, "corner_periods": (0.2, 0.8, 2.0)},
    "E": {"soil_factor": 1.4, "corner_periods": (0.15, 0.5, 2.0)},
}
LONGEST_PERIOD = 4.0  # longest period of the shape of EN 1998-1 [s]
AC156_FREQUENCIES = (1.3, 8.3, 33.3)  # ends of the plateau and of the slope of ICC-ES AC156 [Hz]
# peak, velocity and displacement of the pulse over the spectrum's: as the BV 043/85 literature uses them, from memory
FACTORS = (0.6, 0.75, 1.05)


def en1998_spectrum(
    frequencies: ArrayLike, *, ground_acceleration: float, soil_factor: float,
    corner_periods: tuple[float, float, float], damping: float = 0.05, plateau: float = 2.5,
) -> Array:  # fmt: skip
    """Return the elastic response spectrum of EN 1998-1, 3.2.2.2 and 3.2.2.3, in the unit of the ground acceleration.

    With T = 1/f and eta = sqrt(10/(5 + 100 damping)), at least 0.55,

        Se = ag S (1 + T/TB (2.5 eta - 1))   up to TB
             2.5 ag S eta                    up to TC
             2.5 ag S eta TC/T               up to TD
             2.5 ag S eta TC TD/T^2          up to 4 s

    The vertical one has 3.0 for 2.5, S = 1 and corner periods of its own.
    `EN1998_TYPE_1["B"]` and the like hold soil factor and corner periods of the ground types.

    Args:
        frequencies: frequencies [Hz], any shape, 0.25 Hz or more.
        ground_acceleration: design ground acceleration on rock, ag, for instance in [m/s^2].
        soil_factor: factor S of the ground [-].
        corner_periods: TB, TC and TD [s].
        damping: damping ratio of the oscillators.
        plateau: amplification of the plateau at 5 % damping: 2.5, of the vertical spectrum 3.0.
    """
    level = positive("ground_acceleration", ground_acceleration) * positive("soil_factor", soil_factor)
    tb, tc, td = (positive("corner_periods", period) for period in corner_periods)
    if not tb <= tc <= td:
        raise ValueError(f"`corner_periods` must increase, got {corner_periods!r}.")
    period = 1 / _above(frequencies, 1 / LONGEST_PERIOD, "the spectrum of EN 1998-1 ends at 4 s")
    eta = max(math.sqrt(10 / (5 + 100 * positive("damping", damping))), 0.55)
    highest = plateau * eta
    # Beyond each corner the factor of the branch before it goes on.
    falling = highest * np.minimum(tc / period, 1.0) * np.minimum(td / period, 1.0)
    return level * np.where(period < tb, 1 + period / tb * (highest - 1), falling)


def ac156_spectrum(frequencies: ArrayLike, *, s_ds: float, height_ratio: float, vertical: bool = False) -> Array:
    """Return the required response spectrum of ICC-ES AC156 for 5 % damping [in the unit of `s_ds`].

    Horizontal: A_flx = S_DS (1 + 2 z/h), at most 1.6 S_DS, from 1.3 to 8.3 Hz, and A_rig = 0.4 S_DS (1 + 2 z/h), at most
    1.2 S_DS, from 33.3 Hz on; straight on logarithmic axes between them. Vertical: 0.67 and 0.27 S_DS at any height.
    A motion that `match_spectrum` makes holds the rigid plateau up to the last frequency of its target only: give it points
    beyond 33.3 Hz.

    Args:
        frequencies: frequencies [Hz], any shape, 1.3 Hz or more.
        s_ds: design spectral acceleration at short periods S_DS, for instance in [m/s^2].
        height_ratio: height of the attachment over that of the building z/h, from 0 to 1.
        vertical: whether the vertical spectrum is asked for.
    """
    s_ds = positive("s_ds", s_ds)
    between("height_ratio", height_ratio, 0.0, 1.0)
    checked = _above(frequencies, AC156_FREQUENCIES[0], "the plateau of AC156 begins at 1.3 Hz")
    raised = 1 + 2 * height_ratio
    flexible, rigid = (0.67, 0.27) if vertical else (min(raised, 1.6), min(0.4 * raised, 1.2))
    corners = np.log(AC156_FREQUENCIES)
    return s_ds * np.exp(np.interp(np.log(checked), corners, np.log([flexible, flexible, rigid])))


def _above(frequencies: ArrayLike, least: float, reason: str) -> Array:
    """Return the frequencies as an array; ValueError, with the reason, if one is below `least` [Hz]."""
    checked = np.asarray(frequencies, dtype=float)
    if not np.all(np.isfinite(checked)) or np.any(checked < least * (1 - 1e-9)):
        raise ValueError(f"`frequencies` must be at least {least:g} Hz: {reason}; got {np.min(checked):g} Hz.")
    return checked


@dataclass(frozen=True, kw_only=True)
class DesignSpectrum:
    """Undamped shock spectrum of constant displacement, velocity and acceleration, one branch after the other.

    The levels come from the customer's specification (BV 043, STANAG 4142, ...); none are built in. With the usual factors the
    undamped spectra of the pulses lie at 1.05 d0 far below the first corner f1. Where the second corner f2 is 3 to 40 times the
    first, that of the double half-sine lies between 0.69 and 1.19 v0 from f1 to f2 and reaches 1.06 to 1.19 a0 from f2 on; that
    of the double triangle 0.67 to 1.21 v0 (1.26 with `r2=0.6`) and 0.94 to 1.03 a0 (1.11). Neither pulse is an envelope.
    """

    phrases = (
        SpokenMotion(
            name="double-pulse", example="50 mm 3 m/s 100 g z", written="double[- ]?half[- ]?sine",
            says_more=True, summary="the double half-sine of a design spectrum d0, v0, a0.",
            needs={"displacement": 1, "velocity": 1, "acceleration": 1},
            make=lambda spectrum, phrase, direction, *_: spectrum(
                **{name: phrase.one(name) for name in ("displacement", "velocity", "acceleration")}
            ).double_half_sine(direction=direction, start=phrase.start),
        ),
    )  # fmt: skip

    displacement: float  #: spectral displacement d0 of the low branch [m]
    velocity: float  #: spectral pseudo-velocity v0 of the middle branch [m/s]
    acceleration: float  #: spectral acceleration a0 of the high branch [m/s^2]

    def __post_init__(self) -> None:
        for item in fields(self):
            object.__setattr__(self, item.name, ranges.level(item.name, positive(item.name, getattr(self, item.name))))
        highest = math.sqrt(self.displacement * self.acceleration)
        if self.velocity >= highest:
            raise ValueError(
                f"`velocity` must be below sqrt(displacement * acceleration) = {highest:.6g} m/s, where the other two "
                f"branches meet, got {self.velocity!r}: the spectrum would have no branch of constant velocity."
            )

    @property
    def corner_frequencies(self) -> tuple[float, float]:
        """Frequencies at which the branches meet [Hz]: f1 = v0/(2 pi d0) and f2 = a0/(2 pi v0)."""
        low = self.velocity / (2 * math.pi * self.displacement)
        return low, self.acceleration / (2 * math.pi * self.velocity)

    def pseudo_velocity(self, frequencies: ArrayLike) -> Array:
        """Return the spectrum's pseudo-velocity [m/s] at the frequencies [Hz]: the lowest of w d0, v0 and a0/w."""
        omega = 2 * np.pi * np.asarray(frequencies, dtype=float)
        if np.any(omega <= 0):
            raise ValueError("`frequencies` must be > 0.")
        return np.minimum(np.minimum(omega * self.displacement, self.velocity), self.acceleration / omega)

    def double_half_sine(
        self, *, direction: str | Sequence[float], factors: Sequence[float] = FACTORS, start: float = 0.0
    ) -> DoubleHalfSine:
        """Make the double half-sine that stands for the spectrum; its first pulse begins at `start` [s].

        `factors` are first peak over a0, velocity over v0 and final displacement over d0.
        """
        return DoubleHalfSine(**self._levels(factors), direction=direction, start=start)

    def double_triangle(
        self, *, direction: str | Sequence[float], factors: Sequence[float] = FACTORS, start: float = 0.0,
        r1: float = 0.4, r2: float = 0.4,
    ) -> DoubleTriangle:  # fmt: skip
        """Make the double triangle that stands for the spectrum; its first pulse begins at `start` [s].

        `factors` are those of `double_half_sine`; `r1` and `r2` say where in their triangles the peaks lie, from 0 to 1; for
        r2 sources give 0.4 and 0.6.
        """
        return DoubleTriangle(**self._levels(factors), direction=direction, start=start, r1=r1, r2=r2)

    def _levels(self, factors: Sequence[float]) -> dict[str, float]:
        if len(factors) != 3:
            raise ValueError(f"`factors` must be three, on acceleration, velocity and displacement, got {factors!r}.")
        a, v, d = (positive("factors", factor) for factor in factors)
        return {"peak": a * self.acceleration, "velocity": v * self.velocity, "displacement": d * self.displacement}


HIGHEST = 50.0  # frequency [Hz] up to which the rigid plateau goes on, so that the motion holds it
PER_OCTAVE = 12  # points of a table where a spectrum is curved
# vertical over horizontal ground acceleration, and corner periods TB, TC, TD [s] of EN 1998-1, 3.2.2.3, type 1, from memory
VERTICAL, VERTICAL_CORNERS = 0.9, (0.05, 0.15, 1.0)
LEVELS = {"ac156": "ICC-ES AC156", "en1998": "EN 1998-1, type 1"}


def ac156_levels(*, sds: float, z_h: float, stem: str = "ac156") -> dict[str, str]:
    """Return the texts of the file of levels STEM.toml of AC156 and its two tables, by file name, for S_DS [g] and z/h."""
    frequencies = np.array([*AC156_FREQUENCIES, HIGHEST])
    spectra = [ac156_spectrum(frequencies, s_ds=sds, height_ratio=z_h, vertical=vertical) for vertical in (False, True)]
    (flexible, _, _, rigid), (vertical, _, _, vertical_rigid) = spectra
    formulas = f"""\
S_DS = {sds:g} g, z/h = {z_h:g}, 5 % damping; written from the formulas:
horizontal A_flx = S_DS (1 + 2 z/h) <= 1.6 S_DS = {flexible:.4g} g, A_rig = 0.4 S_DS (1 + 2 z/h) <= 1.2 S_DS = {rigid:.4g} g;
vertical 0.67 S_DS = {vertical:.4g} g and 0.27 S_DS = {vertical_rigid:.4g} g; from 1.3 to 8.3 Hz and from 33.3 Hz on.
30 s with 20 s of strong motion: check lengths against your edition."""
    return _files(stem, "ac156", formulas, "30 s", " rise 5 s fall 5 s", frequencies, spectra)


def en1998_levels(*, ag: float, ground: str, stem: str = "en1998") -> dict[str, str]:
    """Return the texts of the file of levels STEM.toml of EN 1998-1 and its two tables, by file name, for ag [g] and ground."""
    one_of("ground", ground, tuple(EN1998_TYPE_1))
    lowest = 1.0 / LONGEST_PERIOD
    site = EN1998_TYPE_1[ground]
    even = np.geomspace(lowest, HIGHEST, int(np.ceil(PER_OCTAVE * np.log2(HIGHEST / lowest))) + 1)
    corners = [1.0 / period for period in (*site["corner_periods"], *VERTICAL_CORNERS)]  # type: ignore[misc]
    frequencies = np.unique([*even, *corners]).round(9)
    horizontal = en1998_spectrum(frequencies, ground_acceleration=ag, **site)  # type: ignore[arg-type]
    vertical = en1998_spectrum(
        frequencies, ground_acceleration=VERTICAL * ag, soil_factor=1.0, corner_periods=VERTICAL_CORNERS, plateau=3.0
    )
    formulas = f"""\
ag = {ag:g} g, ground {ground}: S = {site["soil_factor"]:g}, TB, TC, TD = {site["corner_periods"]} s; 5 % damping:
horizontal plateau 2.5 ag S = {horizontal.max():.4g} g (3.2.2.2),
vertical 3 x {VERTICAL:g} ag = {vertical.max():.4g} g (3.2.2.3).
Tables end at {HIGHEST:g} Hz, above ag still.
Of the ground: equipment in a building needs its floor's spectrum. A national annex may have other numbers."""
    return _files(stem, "en1998", formulas, "25 s", "", frequencies, [horizontal, vertical])


def _files(
    stem: str, name: str, formulas: str, length: str, ramps: str, frequencies: Array, spectra: list[Array]
) -> dict[str, str]:
    """Return the texts of the file of levels and of its tables, by file name; different seeds make x, y, z independent."""
    lines = [f"# {line}" for line in (f"{LEVELS[name]}, required response spectra", *formulas.splitlines())]
    lines.append(f'standard = "{LEVELS[name]}"')
    for seed, (axis, kind) in enumerate((("x", "horizontal"), ("y", "horizontal"), ("z", "vertical")), start=1):
        phrase = f"{stem}_{kind}.csv {length} {axis} damping 5 % seed {seed}{ramps}"
        lines.append(f'\n[[motion]]\nrequired-spectrum = "{phrase}"')
    tables = {
        f"{stem}_{kind}.csv": "".join(
            ["frequency [Hz],acceleration [g]\n", *(f"{f:.6g},{a:.6g}\n" for f, a in zip(frequencies, levels, strict=True))]
        )
        for kind, levels in zip(("horizontal", "vertical"), spectra, strict=True)
    }
    return {f"{stem}.toml": "\n".join(lines) + "\n", **tables}


WRITERS: dict[str, Callable[..., dict[str, str]]] = {"ac156": ac156_levels, "en1998": en1998_levels}
