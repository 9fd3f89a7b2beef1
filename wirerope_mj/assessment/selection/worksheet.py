"""The vendors' worksheet: load, shock and room of a payload, in the formulas of their sheets."""

import math
from dataclasses import dataclass, replace

from wirerope_mj.foundation.arguments import between, integer, positive
from wirerope_mj.foundation.plain_text import short
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.motions import VelocityStep, ranges
from wirerope_mj.motions.pulses import Pulse
from wirerope_mj.motions.spoken import motion_from_words
from wirerope_mj.mounts.vendor_parts.parts import MODES

# Acceleration of gravity of the vendors' sheets [m/s^2]: their printed digits need it, 0.03 % above the standard one.
WORKSHEET_GRAVITY = 9.81
ISOLATION_RATIO = 3.0  # Disturbing over natural frequency that the vendors ask for: it keeps out 80 % and more
# Natural frequency times length of a pulse up to which only its velocity change counts (the vendors' condition).
IMPULSE = 0.25
# The same from which the rule says nothing: there an undamped mass under a half-sine reaches 1.73 times the pulse's peak, and
# the rule says 4 times.
LONG = 1.0
Shock = Pulse | VelocityStep


@dataclass(frozen=True, kw_only=True)
class Worksheet:
    """Demands on the mounts; all stand alike, below a central centre of mass.

    A pulse counts by its velocity change V alone. That is right within a few per cent while (natural frequency x length of the
    pulse) < 0.25; above it the worksheet is on the safe side: no pulse of one sign moves a linear undamped mass more than a
    sudden V.
    """

    mass: float  # of the payload [kg]
    mounts: int  # number of mounts that share it
    shock: Shock  # pulse or velocity step of the base
    travel: float | None = None  # room that the payload has [m]; None = not judged, as for the next two
    fragility: float | None = None  # acceleration that the payload stands [m/s^2]
    disturbance: float | None = None  # lowest disturbing frequency to be isolated [Hz]
    loading: str = "compression"  # mode in which the weight loads the mounts: compression, 45 or shear
    direction: str = "compression"  # mode in which the shock does
    isolation_ratio: float = ISOLATION_RATIO  # disturbing over natural frequency that is asked for
    gravity: float = WORKSHEET_GRAVITY  # of the weight [m/s^2]

    def __post_init__(self) -> None:
        for name in ("mass", "isolation_ratio", "gravity", "travel", "fragility", "disturbance"):
            value = getattr(self, name)
            if value is not None and not ranges.SMALLEST <= positive(name, value) <= ranges.LARGEST:
                raise ValueError(f"`{name}` must be {ranges.SMALLEST:g} to {ranges.LARGEST:g} in SI units, got {value!r}.")
        integer("mounts", self.mounts, least=1)
        for name in ("loading", "direction"):
            mode = "shear" if getattr(self, name) == "roll" else getattr(self, name)
            if mode not in MODES:
                raise ValueError(f"`{name}` must be one of {', '.join(MODES)} or roll, got {mode!r}.")
            object.__setattr__(self, name, mode)

    @property
    def load(self) -> float:
        """Weight W on one mount [N]."""
        return self.mass * self.gravity / self.mounts

    @property
    def velocity(self) -> float:
        """Velocity change V of the shock [m/s]."""
        return abs(self.shock.velocity_change)

    @property
    def peak(self) -> float | None:
        """Acceleration of the pulse at its peak [m/s^2]; None for a velocity step, which has none."""
        return None if isinstance(self.shock, VelocityStep) else abs(self.shock.peak)

    @property
    def largest_frequency(self) -> float | None:
        """Natural frequency that isolates the disturbance [Hz], f_i / 3."""
        return None if self.disturbance is None else self.disturbance / self.isolation_ratio

    @property
    def largest_vibration_stiffness(self) -> float | None:
        """Kv_max of one mount for that frequency [N/m], W (2 pi f)^2 / g."""
        frequency = self.largest_frequency
        return None if frequency is None else self.load * (2.0 * math.pi * frequency) ** 2 / self.gravity

    @property
    def smallest_travel(self) -> float | None:
        """D_min that a spring needs to keep within the fragility [m], V^2 / AT."""
        return None if self.fragility is None else self.velocity**2 / self.fragility

    @property
    def largest_shock_stiffness(self) -> float | None:
        """Ks_max of one mount for the fragility [N/m], (W / g) (AT / V)^2."""
        return None if self.fragility is None else self.load / self.gravity * (self.fragility / self.velocity) ** 2

    def amplifies(self, acceleration: float) -> bool:
        """Return whether a transmitted acceleration [m/s^2] is above the pulse's own peak."""
        return self.peak is not None and acceleration > self.peak

    def frequency(self, stiffness: float) -> float:
        """Return the natural frequency [Hz] on mounts of a stiffness [N/m] each, sqrt(K g / W) / 2 pi."""
        return math.sqrt(stiffness * self.gravity / self.load) / (2.0 * math.pi)

    def dynamic_travel(self, shock_stiffness: float) -> float:
        """Return D = V / sqrt(Ks g / W) [m]."""
        return self.velocity / (2.0 * math.pi * self.frequency(shock_stiffness))

    def acceleration(self, shock_stiffness: float) -> float:
        """Return the transmitted acceleration 2 pi f V [m/s^2] with f of the shock stiffness [N/m]; GT in g is it over g."""
        return 2.0 * math.pi * self.frequency(shock_stiffness) * self.velocity

    def impulse(self, shock_stiffness: float) -> float:
        """Return natural frequency times length of the pulse [-]; 0 for a velocity step."""
        return self.frequency(shock_stiffness) * self.shock.duration


def mode_text(mode: str) -> str:
    """Return a mode in a sentence: "at 45 degrees", "in compression"."""
    return "at 45 degrees" if mode == "45" else f"in {mode}"


_EXAMPLES = '"15 g 11 ms half-sine", "20 g 11 ms sawtooth", "10 g 18 ms trapezoid" or "2 m/s"'


def shock_of(pulse: Shock | None, velocity: float | None, drop: float | None, rebound: float, gravity: float) -> Shock:
    """Return the one shock that was given; a fall from h with rebound e changes the velocity by (1 + e) sqrt(2 g h)."""
    given = [value for value in (pulse, velocity, drop) if value is not None]
    if len(given) != 1:
        raise ValueError(f"give one shock: `pulse`, `velocity` or `drop`; got {len(given)}.")
    between("rebound", rebound, 0.0, 1.0)
    if rebound and drop is None:
        raise ValueError("`rebound` belongs to `drop`; a `pulse` or a `velocity` is the whole velocity change.")
    if pulse is not None:
        if not isinstance(pulse, Shock):
            raise ValueError(
                "`pulse` must be a half-sine, sawtooth, trapezoid or velocity step: the worksheet counts by velocity changes."
            )
        return pulse
    if drop is not None:
        velocity = (1.0 + rebound) * math.sqrt(2.0 * gravity * ranges.level("drop", positive("drop", drop, unit="m")))
    return VelocityStep(velocity=positive("velocity", velocity, unit="m/s"), direction="z")


def shock_from_text(text: str) -> Shock:
    """Make the shock of a text such as `15 g 11 ms half-sine` or `2 m/s`; its g are those of the worksheet.

    ValueError if the text is no pulse and no velocity.
    """
    shock = motion_from_words(text)
    if not isinstance(shock, Shock):
        raise ValueError(f"a worksheet's shock is one pulse or a velocity, such as {_EXAMPLES}; got {short(text)!r}.")
    if isinstance(shock, VelocityStep):
        return shock
    return replace(shock, peak=shock.peak * WORKSHEET_GRAVITY / STANDARD_GRAVITY)
