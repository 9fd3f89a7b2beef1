"""A candidate judged by simulation: its isolator with its share of the mass on a shaken base."""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from wirerope_mj.assessment.criteria.criterion import Criterion
from wirerope_mj.assessment.criteria.ended import PERIODS, require_over
from wirerope_mj.assessment.criteria.verdict import Verdict, smallest_margin
from wirerope_mj.assessment.selection.select import NOT_GIVEN, UNSTATED, Candidate
from wirerope_mj.assessment.selection.worksheet import Shock, Worksheet
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.simulation import simulate
from wirerope_mj.engine.simulation.stability import slowest_period
from wirerope_mj.engine.system import System, load_system
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.motions import VelocityStep
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.mounts.vendor_parts import load_isolator
from wirerope_mj.mounts.vendor_parts.parts import VendorPart

_START = 0.01  # Instant of the shock [s]: a moment of rest before it shows the sag
# Periods of the shock stiffness simulated after the shock at the least: the first swing and the rebound hold the extremes.
_CYCLES = 2.0
_ACCURACY = 1e-3  # Error of the peaks [-]: the table's values are good to two digits
_SQRT_HALF = float(np.sqrt(0.5))
# Direction in the mount's axes from its base to the payload: axial, between axial and roll, along the bars.
_MODE_DIRECTIONS = {"compression": (0.0, 0.0, 1.0), "45": (_SQRT_HALF, 0.0, _SQRT_HALF), "shear": (0.0, 1.0, 0.0)}
_MODEL = """\
<mujoco model="selected">
  <option gravity="{gravity}" integrator="RK4"/>
  <default><geom contype="0" conaffinity="0"/></default>
  <worldbody>
    <body name="base">
      <joint name="base_x" type="slide" axis="1 0 0"/>
      <joint name="base_y" type="slide" axis="0 1 0"/>
      <joint name="base_z" type="slide" axis="0 0 1"/>
      <geom size="0.1" mass="10"/><site name="base/m1" pos="0 0 0.1"/>
    </body>
    <body name="payload" pos="0 0 0.2">
      {joints}
      <geom size="0.05" mass="{mass!r}"/><site name="payload/m1" pos="0 0 -0.1"/>
    </body>
  </worldbody>
  <custom>
    <text name="isolator/part" data="part.toml"/>
    <tuple name="mount/m1">
      <element objtype="site" objname="payload/m1"/>
      <element objtype="site" objname="base/m1"/>
      <element objtype="text" objname="isolator/part"/>
    </tuple>
  </custom>
</mujoco>"""


@dataclass(frozen=True, kw_only=True)
class SimulatedShock:
    """The simulated shock of a candidate.

    Attributes:
        candidate: its values by the worksheet.
        isolator: of its file where one ships, else fitted from its row.
        sag: deflection under the weight along the loading mode [m], on the virgin path.
        travel: largest deflection from the sagged position along the shock [m]: what the worksheet calls dynamic travel.
        deflection: largest deflection from the unloaded position along the shock [m], on the side where the part is rated.
        acceleration: peak of the payload [m/s^2].
        verdicts: rated travel (by `deflection`), room (by `travel`), acceleration, and static load.
    """

    candidate: Candidate
    isolator: Isolator
    sag: float
    travel: float
    deflection: float
    acceleration: float
    verdicts: tuple[Verdict, ...]
    response: Response

    @property
    def margin(self) -> float:
        """Smallest margin of all that is judged; infinite if nothing is."""
        return smallest_margin(self.verdicts)

    @property
    def travel_utilisation(self) -> float | None:
        """Utilisation of the rated travel from the unloaded position; None = not rated."""
        return self.verdicts[0].utilisation


def simulate_candidate(candidate: Candidate, worksheet: Worksheet) -> SimulatedShock:
    """Return the simulated shock of a candidate: a guided mass, settled under its weight, on its isolator.

    All mounts move alike, so one with its share of the mass stands for them.

    Raises:
        ModelError: the row has no stiffnesses to fit.
        ConvergenceError: no law fits all stiffnesses of the row, or there is no equilibrium under the weight.
        SimulationError: the run failed.
    """
    isolator = load_isolator(candidate.part)
    for mode, axis, law in (("shear", "shear", isolator.shear), ("45", "roll", isolator.roll)):
        if mode in (worksheet.loading, worksheet.direction) and law is None:
            raise ModelError(
                f"{candidate.part.name}: the table does not state travel and stiffnesses in {axis}; nothing to fit."
            )
    shock, system = _shock_along_mode(worksheet), _system(isolator, worksheet)
    ringing = max(_CYCLES / candidate.shock_frequency, PERIODS * slowest_period(system))
    response = simulate(
        system, shock, duration=shock.end + ringing, accuracy=_ACCURACY, sample_rate=4000.0
    )  # a sample every quarter of a millisecond: a mount of 50 Hz has 80 of them in a period
    return _simulated_shock(candidate, isolator, worksheet, response)


def _simulated_shock(
    candidate: Candidate, isolator: Isolator, worksheet: Worksheet, response: Response
) -> SimulatedShock:
    """Return sag, travel and acceleration of a run, and their verdicts."""
    deflection = response.mounts["m1"].deflection
    along = deflection @ np.array(_MODE_DIRECTIONS[worksheet.direction])
    deflected = float((-along).max() if worksheet.direction == "compression" else np.abs(along).max())
    travel = float(np.abs(along - along[0]).max())
    acceleration = response.peaks.bodies["payload"].acceleration.value
    rated = candidate.part.modes[worksheet.direction].travel
    return SimulatedShock(
        candidate=candidate,
        isolator=isolator,
        sag=float(-deflection[0] @ np.array(_MODE_DIRECTIONS[worksheet.loading])),
        travel=travel,
        deflection=deflected,
        acceleration=acceleration,
        verdicts=(
            *require_over(response, _verdicts(candidate.part, rated, worksheet, deflected, travel, acceleration)),
            candidate.verdicts[0],
        ),
        response=response,
    )


def _verdicts(
    part: VendorPart, rated: float | None, worksheet: Worksheet, deflection: float, travel: float, acceleration: float
) -> tuple[Verdict, ...]:
    def verdict(criterion: str, value: float, limit: float | None, unit: str, missing: str) -> Verdict:
        note = missing if limit is None else ""
        return Verdict(
            criterion=Criterion(criterion), subject=part.name, value=value, limit=limit, unit=unit, note=note
        )

    return (
        verdict("rated travel", deflection, rated, "m", UNSTATED),
        verdict("room", travel, worksheet.travel, "m", NOT_GIVEN),
        verdict("acceleration", acceleration, worksheet.fragility, "m/s^2", NOT_GIVEN),
    )


def _system(isolator: Isolator, worksheet: Worksheet) -> System:
    """Return one mount upright with its share of the mass; gravity turns with the loading mode instead of the mount."""
    modes = dict.fromkeys((worksheet.loading, worksheet.direction))
    joints = [
        f'<joint name="payload_{mode}" type="slide" axis="{_numbers(_MODE_DIRECTIONS[mode])}"/>' for mode in modes
    ]
    text = _MODEL.format(
        gravity=_numbers(-worksheet.gravity * np.array(_MODE_DIRECTIONS[worksheet.loading])),
        joints="\n      ".join(joints),
        mass=worksheet.mass / worksheet.mounts,
    )
    return load_system(text, isolators={"part": isolator})


def _shock_along_mode(worksheet: Worksheet) -> Shock:
    """Return the shock of the base against the payload along its mode."""
    direction = _MODE_DIRECTIONS[worksheet.direction]
    if isinstance(worksheet.shock, VelocityStep):
        return VelocityStep(velocity=worksheet.velocity, direction=direction, start=_START)
    return replace(worksheet.shock, peak=abs(worksheet.shock.peak), direction=direction, start=_START)


def _numbers(vector: npt.ArrayLike) -> str:
    """Return a vector as MJCF writes it."""
    return " ".join(f"{value + 0.0:.17g}" for value in np.asarray(vector, dtype=np.float64))
