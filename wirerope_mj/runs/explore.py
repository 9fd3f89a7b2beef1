"""A what-if of a scenario: its sliders, and runs at their values; the last two runs are kept."""

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path
from time import perf_counter

import numpy as np

from wirerope_mj.content.judged_run import judged_run
from wirerope_mj.content.numbers import title_of
from wirerope_mj.engine.flexible.panel import NAME
from wirerope_mj.engine.simulation import simulate
from wirerope_mj.engine.simulation.simulate import RING_DOWN
from wirerope_mj.engine.simulation.stability import slowest_period
from wirerope_mj.engine.statics.payloads import payloads_of
from wirerope_mj.engine.system import System, load_system
from wirerope_mj.engine.system.varied import moving_bodies, sprung_joints, varied, with_changes
from wirerope_mj.foundation.arguments import finite
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.directions import directions_in
from wirerope_mj.foundation.errors import ModelError, RecordError
from wirerope_mj.foundation.plain_text import quoted
from wirerope_mj.foundation.resources import model_file, shipped_models
from wirerope_mj.foundation.units import STANDARD_GRAVITY, significant
from wirerope_mj.motions import BaseMotion, HalfSine, Measured, Scaled, Turned
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.runs.scenario import Scenario, ScenarioFile, load_scenario, shipped_scenarios
from wirerope_mj.runs.scenario_file import is_run, judged_by, stored_scenario
from wirerope_mj.runs.write import checked_arguments
from wirerope_mj.views.explore.answer import answer
from wirerope_mj.views.explore.recorder import Recorder, ShownRun
from wirerope_mj.views.explore.server import OvertakenError

# Keys of the sliders; that of a stiffness is followed by what the model calls the isolator.
LEVEL, DIRECTION, MASS, DAMPING, STIFFNESS, DECK = "level", "direction", "mass", "damping", "stiffness/", "deck"
Values = Mapping[str, float]


@dataclass(frozen=True, kw_only=True)
class Slider:
    """One quantity that can be changed."""

    key: str  # by which its value is handed over
    label: str  # what it is called
    unit: str  # "×" for a factor on what the scenario has, "°" for an angle
    # minimum, maximum: smallest and largest value
    minimum: float
    maximum: float
    nominal: float  # what leaves the scenario as it is
    note: str  # what it acts on, and what stays

    def text(self, value: float) -> str:
        return f"{value:.4g}°" if self.unit == "°" else f"×\N{NO-BREAK SPACE}{value:.4g}"


def sliders_of(system: System, motion: BaseMotion) -> tuple[Slider, ...]:
    """Return the sliders that have an effect on a system under a motion."""
    # A fall has the level of its height, and the direction of gravity.
    falls = motion.up is not None
    sliders = [] if falls else [_factor(LEVEL, "Base motion level", (0.1, 2.0), f"On {motion.description}.")]
    drive = system.assembly.tables.drive
    reach = np.linalg.pinv(drive) @ drive  # projector onto what the slides span
    # The base follows any horizontal motion, and there is one; 1e-9: rounding of unit vectors, as where simulations check it.
    if not (falls or motion.rotates) and np.abs(reach[:2, :2] - np.eye(2)).max() < 1e-9 < np.abs(motion.directions[:, :2]).max(
        initial=0.0
    ):
        sliders.append(Slider(
            key=DIRECTION, label="Base motion direction", unit="°", minimum=-180.0, maximum=180.0, nominal=0.0,
            note="Turns the motion about the vertical, from x towards y.",
        ))  # fmt: skip
    if system.mounts:
        mass = sum(payload.mass for payload in payloads_of(system))
        note = f"On mass and inertia of all that the mounts carry, {significant(mass)} kg; its shape stays."
        sliders.append(_factor(MASS, "Payload mass", (0.5, 2.0), note))
    groups = groups_of(system)
    for group, mounts in groups.items():
        device = system.mounts[mounts[0]].written.name
        note = f"On all forces of {len(mounts)} {'mounts' if len(mounts) > 1 else 'mount'}; their ratings stay."
        sliders.append(_factor(STIFFNESS + group, f"Stiffness of {device}", (0.5, 2.0), note))
    laws = {group: system.mounts[mounts[0]].written.axes.values() for group, mounts in groups.items()}
    damped = [group for group in groups if any(law.damping_parameters for law in laws[group] if law is not None)]
    if damped:
        undamped = [system.mounts[groups[group][0]].written.name for group in groups if group not in damped]
        note = "On rope friction and dampers of all mounts. Friction resists small deflections, too: they become stiffer."
        note += f" {', '.join(undamped)}: loss and stiffness are one law, which stays." if undamped else ""
        sliders.append(_factor(DAMPING, "Damping of all mounts", (0.33, 3.0), note))
    if (deck := sprung_joints(system.model).get(NAME)) is not None:
        note = f"On the {significant(deck)} Hz of the deck panel alone; its mass and damping ratio stay."
        sliders.append(_factor(DECK, "Deck frequency", (0.5, 2.0), note))
    return tuple(sliders)


def groups_of(system: System) -> dict[str, list[str]]:
    """Group the mounts by the name of their isolator in the model; stops are left out."""
    groups: dict[str, list[str]] = {}
    for name, mount in system.mounts.items():
        if not mount.written.is_stop:
            groups.setdefault(mount.isolator_name, []).append(name)
    return groups


def checked_values(sliders: Sequence[Slider], values: object) -> dict[str, float]:
    """Return a value for every slider: the given value limited to the slider's range, else the nominal value.

    ValueError if `values` is no table of finite numbers, or names what is no slider.
    """
    if not isinstance(values, Mapping):
        raise ValueError(f'the sliders\' values must be a table such as {{"level": 1.2}}, got {quoted(values, 40)}.')
    known = {slider.key: slider for slider in sliders}
    checked = {slider.key: slider.nominal for slider in sliders}
    for key, value in values.items():
        if key not in known:
            raise ValueError(f"there is no slider {str(key)[:40]!r}; there are {', '.join(known)}.")
        try:
            number = finite(key, value)
        except ValueError:
            raise ValueError(f"the value of {key!r} must be a finite number, got {quoted(value, 40)}.") from None
        checked[key] = min(max(number, known[key].minimum), known[key].maximum)
    return checked


def variant(system: System, motion: BaseMotion, values: Values) -> tuple[System, BaseMotion]:
    """Return system and motion at the sliders' values; the given system and motion if all values are nominal.

    ValueError if a factor takes a parameter out of its law's range; ModelError if the compiled model has no room for the
    change.
    """
    mass, damping = values.get(MASS, 1.0), values.get(DAMPING, 1.0)
    isolators: dict[str, Isolator] = {}
    for group, mounts in groups_of(system).items():
        stiffness = values.get(STIFFNESS + group, 1.0)
        for mount in mounts:
            written = system.mounts[mount].written
            changed = written if stiffness == 1.0 else written.scaled(stiffness)
            isolators[mount] = changed if damping == 1.0 else changed.with_damping(damping)
    ids = {body for payload in payloads_of(system) for body in payload.bodies} if mass != 1.0 else set()
    carried = [name for name in moving_bodies(system.model) if system.model.body(name).id in ids]
    tunings = {NAME: values[DECK]} if values.get(DECK, 1.0) != 1.0 else {}
    if carried or tunings or any(isolators[mount] is not system.mounts[mount].written for mount in isolators):
        system = varied(system, isolators=isolators, masses=dict.fromkeys(carried, mass), tunings=tunings)
    if angle := values.get(DIRECTION, 0.0):
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        motion = Turned(motion, rotation=[[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    if (level := values.get(LEVEL, 1.0)) != 1.0:
        motion = Scaled(motion, level)
    return system, motion


def frequency_ratio(values: Values) -> float:
    """Return the largest ratio of a natural frequency to the scenario's: root of stiffness over mass, >= 1."""
    stiffest = max((value for key, value in values.items() if key.startswith(STIFFNESS)), default=1.0)
    # Damping multiplies the friction, which is a part of the stiffness at small amplitudes, and a damper's rate itself.
    mounts = max(1.0, stiffest * max(1.0, values.get(DAMPING, 1.0)) ** 2 / values.get(MASS, 1.0)) ** 0.5
    return max(mounts, values.get(DECK, 1.0))


def _factor(key: str, label: str, ends: tuple[float, float], note: str) -> Slider:
    return Slider(key=key, label=label, unit="×", minimum=ends[0], maximum=ends[1], nominal=1.0, note=note)


_START = 0.05  # Instant at which the pulse begins [s]: the curves show the rest before it


def scenario_or_model(name_or_path: str | Path) -> ScenarioFile:
    """Return the scenario of a name, a path or a run; of a model, a half-sine shock of its base.

    ModelError if there is neither.
    """
    path = Path(name_or_path)
    if is_run(path):
        return stored_scenario(path)
    if str(name_or_path) in shipped_scenarios() or path.suffix == ".py":
        return load_scenario(name_or_path)
    file = model_file(name_or_path)
    if file is None:
        raise ModelError(
            f"there is no scenario and no model {str(name_or_path)!r}. The package ships the scenarios "
            f"{', '.join(shipped_scenarios())} and the models {', '.join(shipped_models())}; anything else must be the path of "
            "a scenario's .py or a model's .xml file."
        )
    return _shock_of(file.resolve())


def _shock_of(model: Path) -> ScenarioFile:
    def scenario(
        *, level_g: float = 15.0, direction: str = "z", pulse_ms: float = 11.0, duration: float | None = None
    ) -> Scenario:
        """Do payload and mounts keep their limits under a half-sine that strikes the base?

        Args:
            level_g: peak acceleration along each axis [g].
            direction: axes along which the base is struck: x, y, z, xy, xyz, ...
            pulse_ms: length of the half-sine [ms].
            duration: simulated time [s]; until ten periods of the slowest mode after the pulse by default.
        """
        along = directions_in(direction)
        if not along:
            raise ValueError(f"`direction` must name axes, such as xyz or z, got {direction!r}.")
        peak, length = level_g * STANDARD_GRAVITY, 1e-3 * pulse_ms
        pulses = [HalfSine(peak=peak, duration=length, direction=axis, start=_START) for axis in along]
        if duration is None:
            duration = round(_START + length + RING_DOWN * slowest_period(load_system(model)), 1)
        return Scenario(
            question=(scenario.__doc__ or "").split("\n", 1)[0], model=model, simulate={"duration": duration},
            motion=pulses[0] if len(pulses) == 1 else sum(pulses[1:], start=pulses[0]),
        )  # fmt: skip

    return ScenarioFile(name=model.stem, path=model, function=scenario)


_NUMERICS = ("timestep", "accuracy")


class Exploration:
    """Simulates one scenario again and again, each time with the sliders at other values.

    The first run, with all of them nominal, is simulated when it is made, as `wirerope run` would. Later runs take its step,
    shorter by as much as their fastest motion is faster: choosing a step for the accuracy again takes several times as long
    as the run, and much longer where stops are struck.

    One thread at a time may call `run`; `start` and `recording` may be called meanwhile. `sliders` are what can be changed.
    """

    def __init__(self, scenario: Scenario, tests: Sequence[Measured] = ()) -> None:
        """Simulate the scenario, whose channels are compared with `tests`; raises what `wirerope_mj.simulate` raises.

        Raises:
            ModelError: an argument is none of it.
            RecordError: a test was measured at what the model does not have.
        """
        scenario = scenario.on_its_floor()
        self._scenario, self._tests = scenario, tests
        self._arguments = checked_arguments(scenario)
        system = load_system(scenario.model_source(), isolators=scenario.isolators)
        changed = with_changes(system, scenario.changes)
        self._system = judged_by(changed, combined_travel=scenario.combined_travel, limits=scenario.limits)
        self.sliders = sliders_of(self._system, scenario.motion)
        self._numbers = count(1)
        self._recorder: Recorder | None = None
        self._shown = (self._simulated(checked_values(self.sliders, {}), passing=False, exact=True),)
        self._step = self._shown[0].response.numerics.timestep

    def start(self) -> Entries:
        return {
            "title": title_of(self._scenario.name), "question": self._scenario.question.strip().split("\n", 1)[0],
            "sliders": [vars(slider) for slider in self.sliders], "answer": self._answer(),
        }  # fmt: skip

    def run(self, values: object, *, passing: bool = False, exact: bool = False) -> Entries:
        """Simulate with the sliders at some values, and return the result beside the run before it.

        A run that was passing gives way to this one; every other one is what this one is compared with from now on. Values of
        sliders, by key, are brought into their ranges, nominal where they are not given; one on its way is `passing`; with
        `exact` the step is chosen for the accuracy of the scenario, as in the first run. ValueError if `values` is no table of
        finite numbers, or names what is no slider; WireRopeError if the variant cannot be simulated.
        """
        checked = checked_values(self.sliders, values)
        last = self._shown[-1]
        same = dict(last.values) == checked
        if same and (last.exact or not exact):
            run = replace(last, passing=passing and last.passing)
        else:
            run = self._simulated(checked, passing=passing, exact=exact)
        # The run that is checked, or that a slider was passing, is not one of its own.
        earlier = self._shown[:-1] if same or last.passing else self._shown
        self._shown = (*earlier[-1:], run)
        return self._answer()

    def recording(self, number: int) -> bytes:
        """Return the recording of the last two runs together, or of the only run.

        Raises:
            OvertakenError: run `number` is not the last any more.
            RecordError: the process that writes it has died.
        """
        shown = self._shown
        if shown[-1].number != number:
            raise OvertakenError
        self._recorder = self._recorder or Recorder()
        try:
            return self._recorder.recording(shown, title_of(self._scenario.name))
        except RuntimeError as error:  # a broken pool, or one that is closed
            self._recorder = None
            raise RecordError(f"the recording was not written: {error}") from error

    def close(self) -> None:
        if self._recorder is not None:
            self._recorder.close()

    def _answer(self) -> Entries:
        shown = self._shown  # another thread may put others in their place
        return answer(shown[-1], shown[0] if len(shown) > 1 else None, self._tests)

    def _simulated(self, values: Mapping[str, float], *, passing: bool, exact: bool) -> ShownRun:
        began = perf_counter()
        system, motion = variant(self._system, self._scenario.motion, values)
        arguments = dict(self._arguments)
        if not exact:
            arguments = {name: value for name, value in arguments.items() if name not in _NUMERICS}
            arguments["timestep"] = self._step / frequency_ratio(values)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            response = simulate(system, motion, **arguments)
            judged = judged_run(system, motion, response)
        moved = {each.label: each.text(values[each.key]) for each in self.sliders if values[each.key] != each.nominal}
        return ShownRun(
            number=next(self._numbers), values=values, changes=moved,
            motion=motion.description, response=response, verdicts=judged.verdicts, random=judged.random,
            untested=judged.untested, seconds=perf_counter() - began, exact=exact, passing=passing,
            warnings=tuple(dict.fromkeys((*judged.model_warnings, *(str(warning.message) for warning in caught)))),
        )  # fmt: skip
