"""A judged run: response, verdicts, and derived results that outputs share, computed at first use."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime
from functools import cached_property, partial
from pathlib import Path
from typing import TypeVar

import numpy as np

from wirerope_mj.assessment.criteria import Verdict, headline, judge, stationary_verdicts
from wirerope_mj.assessment.criteria.sampled import SAMPLED, steady_interval
from wirerope_mj.assessment.criteria.travel import falling_line, untested_line
from wirerope_mj.assessment.criteria.verdict import ACCELERATION, LARGEST, RMS, Amplification
from wirerope_mj.content.numbers import title_of
from wirerope_mj.content.run_spectra import RunSpectra, spectra_of
from wirerope_mj.content.selection import Selection, select
from wirerope_mj.dynamics.modes import Modes, modes
from wirerope_mj.engine.response import Response
from wirerope_mj.engine.simulation.run import missing_modes
from wirerope_mj.engine.statics import StaticTable, model_warnings, static_table
from wirerope_mj.engine.statics.loading import HISTORIES
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.errors import Absent, WireRopeError
from wirerope_mj.motions import BaseMotion, Sweep, motion_from_dict
from wirerope_mj.motions.achieved_spectra import AchievedSpectrum, AxisPair, achieved_spectra, axis_pairs
from wirerope_mj.motions.records.record import record_warnings
from wirerope_mj.motions.registry import SPOKEN_MOTIONS
from wirerope_mj.mounts.isolator import Validity

Result = TypeVar("Result")

STILL = 1e-6  # [m/s^2]: an rms up to which the base is at rest


@dataclass(frozen=True, kw_only=True)
class RunResult:
    """A response with its verdicts, which is what peaks, histories and the answer need."""

    response: Response
    # static loads are those on the first loading and relaxed, not at the start of the run
    verdicts: tuple[Verdict, ...]
    # rms and 3-sigma accelerations of the payload where random vibration is the only motion of the base; those with a
    # limit are among the verdicts, too. Absent where the run is too short.
    random: tuple[Verdict, ...] | Absent = ()
    untested: str = ""  # text on mounts that exceed the tests of their laws; "" without such mounts

    @property
    def headline(self) -> str:
        return headline(self.verdicts)

    @cached_property
    def selection(self) -> Selection:
        return select(self.response, self.verdicts)

    @cached_property
    def sweep(self) -> Sweep | None:
        """The sweep of the base; None for other motions."""
        motion = self.response.motion
        if motion.get("kind") != Sweep.kind:
            return None
        sweep = motion_from_dict({name: value for name, value in motion.items() if name != "description"})
        assert isinstance(sweep, Sweep)
        return sweep

    @cached_property
    def base_rms(self) -> Array:
        """Rms accelerations of the base while its random vibration is stationary [m/s^2], (3,)."""
        return _base_rms(self.response)

    @property
    def validity(self) -> Mapping[str, Validity]:
        return {}


@dataclass(frozen=True, kw_only=True)
class JudgedRun(RunResult):
    """A judged run with its system, motion, statics and inputs."""

    system: System  # that was simulated
    motion: BaseMotion
    statics: StaticTable | Absent  # where the system rests, on the first loading and relaxed
    # see `wirerope_mj.engine.statics.model_warnings`
    model_warnings: tuple[str, ...] = ()
    inputs: Entries = field(default_factory=dict)  # resolved inputs, the content of the run's scenario.toml
    decks: bool = False  # whether the run is repeated on decks that bend

    @property
    def acting(self) -> str:
        """The base motion, or what acts on the payload, in words, with the options that said it."""
        options = self.inputs.get("options", {})
        phrases = [f"{kind} {options[kind]}" for kind, form in SPOKEN_MOTIONS.items() if form.says_more and options.get(kind)]
        return f"{self.motion.description} (from {'; '.join(phrases)})" if phrases else self.motion.description

    @property
    def validity(self) -> Mapping[str, Validity]:
        return {name: mount.isolator.validity for name, mount in self.system.mounts.items()}

    @property
    def title(self) -> str:
        return title_of(str(self.inputs.get("name", self.response.scene.name)))

    @property
    def model_file(self) -> str:
        return Path(self.inputs.get("model", {}).get("file", self.response.scene.name)).name

    @property
    def written(self) -> str:
        written = self.inputs.get("written")
        return f"{written:%Y-%m-%d %H:%M} UTC" if isinstance(written, datetime) else "at an unknown time"

    @property
    def sample_rate(self) -> float:
        """Sampling rate of the response [Hz]."""
        if (rate := self.inputs.get("simulate", {}).get("sample_rate")) is not None:
            return float(rate)  # of a single sample there is no other
        time = self.response.time
        return (time.size - 1) / float(time[-1] - time[0])

    @property
    def gravity(self) -> float:
        """Gravity of the model [m/s^2]."""
        return float(np.linalg.norm(self.system.model.opt.gravity))

    @property
    def record_warnings(self) -> tuple[str, ...]:
        return record_warnings(self.motion)

    @cached_property
    def achieved(self) -> tuple[AchievedSpectrum, ...]:
        """Response spectra of the simulated base motion against the required spectra that it was made for."""
        return achieved_spectra(self.motion, until=float(self.response.time[-1]))

    @cached_property
    def axis_pairs(self) -> tuple[AxisPair, ...]:
        """Correlation and coherence of each pair of axes of a base motion that was made for required spectra."""
        return axis_pairs(self.motion, self.achieved, until=float(self.response.time[-1]))

    @cached_property
    def spectra(self) -> RunSpectra:
        return spectra_of(self.motion, self.response, self.sample_rate)

    @cached_property
    def modes(self) -> Mapping[str, Modes | Absent]:
        """Modes about the equilibrium of each loading history; without gravity of the first one only."""
        histories = HISTORIES if self.gravity else HISTORIES[:1]
        return {history: result_or_absent(partial(modes, self.system, history=history)) for history in histories}


def judged_run(system: System, motion: BaseMotion, response: Response, inputs: Entries | None = None) -> JudgedRun:
    """Judge a run of `system`; `inputs` is the content of its scenario.toml."""
    statics = result_or_absent(partial(static_table, system))
    has_gravity = bool(system.model.opt.gravity.any())  # without a load there is no static load to judge
    known = statics if has_gravity and isinstance(statics, StaticTable) else None
    random = result_or_absent(partial(stationary_verdicts, response))
    rows = () if isinstance(random, Absent) else random
    limited = tuple(row for row in rows if row.limit is not None or row.note.startswith(SAMPLED))
    verdicts = (*judge(response, statics=known), *limited)
    if rows:  # under random vibration the amplification of accelerations is the ratio of rms values
        rms, largest = _base_rms(response), dict[str, Amplification]()
        for row in rows:
            axis = row.criterion.axis
            if row.criterion.kind == RMS and (base := float(rms["xyz".index(axis)])) > STILL:
                along = Amplification(measure=f"rms along {axis}", value=row.value, base=base)
                largest[row.subject] = max(along, largest.get(row.subject, along), key=lambda entry: entry.ratio)
        verdicts = tuple(
            replace(row, amplification=largest.get(row.subject)) if row.criterion.kind in (ACCELERATION, LARGEST) else row
            for row in verdicts
        )
    isolators = {name: mount.isolator for name, mount in system.mounts.items()}
    return JudgedRun(
        system=system, motion=motion, response=response, statics=statics,
        verdicts=verdicts, random=random,
        untested=" ".join(filter(None, (untested_line(isolators, response), falling_line(isolators, response)))),
        model_warnings=(*model_warnings(system, turned=motion.up is not None), *missing_modes(system, motion)),
        inputs=inputs or {},
    )  # fmt: skip


def _base_rms(response: Response) -> Array:
    _, first, last = steady_interval(response.motion)
    rows = slice(*np.searchsorted(response.time, [first, last]))
    return response.base.acceleration[rows].std(axis=0)


def result_or_absent(compute: Callable[[], Result]) -> Result | Absent:
    """Compute a result; Absent with the reason if it cannot be computed."""
    try:
        return compute()
    except (WireRopeError, ValueError) as error:
        return Absent(reason=str(error))
