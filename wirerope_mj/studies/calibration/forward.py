"""The forward model of a calibration: values of quantities to the series that tests would have measured, many at once."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from wirerope_mj.engine.response import Response
from wirerope_mj.engine.simulation import BatchFailure, simulate_batch
from wirerope_mj.engine.simulation.stepper import initial_state
from wirerope_mj.engine.simulation.timestep import choose_timestep
from wirerope_mj.engine.system import Changes, System
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.mounts.isolator import Isolator
from wirerope_mj.studies.calibration.measured_test import Comparable, MeasuredTest, check_channel
from wirerope_mj.studies.calibration.nuisance import UNITS, chains, nuisances
from wirerope_mj.studies.calibration.prior import Prior
from wirerope_mj.studies.inputs.distributions import Choice, Distribution, Isotropic
from wirerope_mj.studies.inputs.quantities import quantities
from wirerope_mj.studies.inputs.sampling import values_at
from wirerope_mj.studies.inputs.variants import Maker

ACCURACY = 1e-3
"""Error of the peaks for which steps are chosen: a tenth of what a good channel measures."""

SAMPLED = 3.0
"""Samples of a simulation in one width of the smoothing of the samples that are compared."""


class SystemForward:
    """Series of all tests of a system as a function of what varies.

    Attributes:
        system: as the model has it.
        tests: measured.
        channels: of all tests, in the order of the series.
        prior: of what varies: first the quantities of the system, then those of the channels.
    """

    def __init__(self, system: System, tests: Sequence[MeasuredTest], vary: Mapping[str, Distribution]) -> None:
        self.system, self.tests = system, tuple(tests)
        for test in tests:
            for channel in test.channels:
                check_channel(system, test.name, channel)
        self._of_test = [[Comparable.of(test.name, one) for one in test.channels] for test in tests]
        self.channels = [one for own in self._of_test for one in own]
        own = {name: one for name, one in vary.items() if not name.startswith("channel/")}
        for name, one in vary.items():
            if isinstance(one, Choice | Isotropic):
                raise ValueError(
                    f"`vary`: {name!r} must be a Normal, a Uniform or Specimens to be calibrated, got {one!r}."
                )
        resolved = quantities(own, system, [test.motion for test in tests])
        self.columns = tuple(column for quantity in resolved for column in quantity.columns)
        self._nuisances = nuisances(vary, [one.name for one in self.channels])
        counts = np.cumsum([len(quantity.columns) for quantity in resolved])

        def quantiles(p: Array) -> Array:
            parts = zip(resolved, np.split(p[:, : counts[-1]], counts[:-1], axis=1), strict=True)
            system_values = [values for quantity, own in parts for values in values_at(quantity, own)]
            chain = [one.distribution.values(p[:, counts[-1] + k]) for k, one in enumerate(self._nuisances)]
            return np.stack([*system_values, *chain], axis=1)

        self.prior = Prior(
            names=(*(column.name for column in self.columns), *(one.name for one in self._nuisances)),
            units=tuple([*(column.unit for column in self.columns), *(UNITS[one.kind] for one in self._nuisances)]),
            quantiles=quantiles,
        )
        self._makers = [Maker(system, (test.motion,), self.columns) for test in tests]
        self._steps = [_Steps(system, test, own) for test, own in zip(tests, self._of_test, strict=True)]

    def __call__(self, values: Array) -> Array:
        """Return the series of values (n, d), one behind the other, (n, n_samples)."""
        cut = len(self.columns)
        rows, which = np.unique(values[:, :cut], axis=0, return_inverse=True)  # a channel's fault needs no run
        chain = chains(self._nuisances, values[:, cut:], len(self.channels))
        parts, k = [], 0
        for number, own in enumerate(self._of_test):
            responses = self.responses(number, rows)
            for one in own:
                out = np.full((len(values), one.series.at.size), np.nan)
                for i, row in enumerate(which.ravel()):
                    response = responses[row]
                    if response is not None:
                        history = one.of_response(response.time, one.taken_from(response), chain["delay"][i, k])
                        out[i] = chain["gain"][i, k] * history + chain["offset"][i, k]
                parts.append(out)
                k += 1
        return np.concatenate(parts, axis=1)

    def responses(self, number: int, rows: Array) -> list[Response | None]:
        """Return the responses of a test with values of the system's quantities (n, d); None where there is none."""
        test, steps, maker = self.tests[number], self._steps[number], self._makers[number]
        found: list[Response | None] = [None] * len(rows)
        systems, motions, places = [], [], []
        for place, row in enumerate(rows):
            named = self._row(row)
            try:
                systems.append(maker.system(named))
                motions.append(maker.motion(named))
            except (ValueError, WireRopeError):
                del systems[len(motions) :]
                continue
            places.append(place)
        maker.forget()
        done = simulate_batch(
            systems, motions, duration=steps.duration, timestep=steps.timestep, sample_rate=steps.sample_rate,
            initial=test.initial, corners=test.motion.corners, responses=True,
        )  # fmt: skip
        for place, one in zip(places, done, strict=True):
            found[place] = None if isinstance(one, BatchFailure) else one.response
        return found

    def system_at(self, values: Array) -> System:
        """Return the system with values of the unknowns, (d,)."""
        return self._makers[0].system(self._row(values))

    def isolators_at(self, values: Array) -> Mapping[str, Isolator]:
        """Return the isolators that values of the unknowns (d,) change, by mount; equal ones are one object."""
        return self._makers[0].changes(self._row(values)).isolators

    def moves_at(self, values: Array) -> Changes:
        """Return the changes of masses, centres and positions at values of the unknowns, (d,)."""
        return self._makers[0].moves(self._makers[0].draft(self._row(values)), {})

    def _row(self, values: Array) -> dict[str, Any]:
        return {column.name: float(value) for column, value in zip(self.columns, values, strict=False)}


class _Steps:
    """Duration [s], step [s] and sample rate [Hz] of a test's runs."""

    def __init__(self, system: System, test: MeasuredTest, channels: Sequence[Comparable]) -> None:
        self.sample_rate = SAMPLED / min(one.width for one in channels)
        end = max(one.series.at[-1] + 6.0 * one.width for one in channels)
        self.duration = math.ceil(self.sample_rate * end) / self.sample_rate
        self.timestep = choose_timestep(
            system, test.motion, initial_state(system, test.motion, test.initial), duration=self.duration,
            sample_rate=self.sample_rate, accuracy=ACCURACY,
        ).timestep  # fmt: skip
