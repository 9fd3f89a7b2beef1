"""The forward model of a calibration: values of quantities to the series that tests would have measured, many at once."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np

from wirerope_mj.engine.system import Changes, System
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.errors import ConvergenceError, ModelError
from wirerope_mj.mounts.isolator import AXES, Isolator
from wirerope_mj.studies.calibration.fit import Prior
from wirerope_mj.studies.calibration.measured_test import MeasuredTest, TransientRuns
from wirerope_mj.studies.calibration.noise import Domain
from wirerope_mj.studies.calibration.rig_tests import FrequencyRuns, FrequencyTest, LoopRuns, LoopTest
from wirerope_mj.studies.engines.compute import DONE, Chunk, compute
from wirerope_mj.studies.measures import measure_names
from wirerope_mj.studies.vary.distributions import Choice, Distribution, Isotropic, Normal, Uniform
from wirerope_mj.studies.vary.quantities import quantities
from wirerope_mj.studies.vary.sampling import values_at
from wirerope_mj.studies.vary.variants import Maker, Work

Test = MeasuredTest | FrequencyTest | LoopTest
AnyRuns = TransientRuns | FrequencyRuns | LoopRuns
# Names of the quantities of measuring channels; NAME may hold * and ? and matches channels with or without their test's name
FORM = "channel/NAME/gain, channel/NAME/delay, channel/NAME/offset"
UNITS = {"gain": "", "delay": "s", "offset": "SI"}
NEUTRAL = {"gain": 1.0, "delay": 0.0, "offset": 0.0}
_NAME = re.compile(r"channel/(.*)/(gain|delay|offset)")


class SystemForward:
    """Series of all tests of a system as a function of the unknowns: quantities of the system, then faults of channels."""

    def __init__(
        self, system: System, tests: Sequence[Test], vary: Mapping[str, Distribution], domain: Domain = "time"
    ) -> None:
        self.system, self.tests, self.vary, self.domain = system, tuple(tests), dict(vary), domain
        of_system = {name: distribution for name, distribution in vary.items() if not name.startswith("channel/")}
        for name, prior in vary.items():
            if isinstance(prior, Choice | Isotropic):
                raise ValueError(f"`vary`: {name!r} must be a Normal, a Uniform or Specimens to be calibrated, got {prior!r}.")
        resolved = quantities(of_system, system, [test.motion for test in tests if isinstance(test, MeasuredTest)])
        self.columns = tuple(column for quantity in resolved for column in quantity.columns)
        self._runs: list[AnyRuns] = []
        for test in tests:
            if isinstance(test, MeasuredTest):
                self._runs.append(TransientRuns(system, test, self.columns, domain))
            else:
                kind = FrequencyRuns if isinstance(test, FrequencyTest) else LoopRuns
                self._runs.append(kind(system, test, self.columns))  # type: ignore[arg-type]
        self.series = [series for runs in self._runs for series in runs.series]
        self._nuisances = nuisances(vary, [series.name for series in self.series])
        counts = np.cumsum([len(quantity.columns) for quantity in resolved])

        def quantiles(p: Array) -> Array:
            parts = zip(resolved, np.split(p[:, : counts[-1]], counts[:-1], axis=1), strict=True)
            system_values = [values for quantity, part in parts for values in values_at(quantity, part)]
            chain = [nuisance.distribution.values(p[:, counts[-1] + k]) for k, nuisance in enumerate(self._nuisances)]
            return np.stack([*system_values, *chain], axis=1)

        self.prior = Prior(
            names=(*(column.name for column in self.columns), *(nuisance.name for nuisance in self._nuisances)),
            units=tuple([*(column.unit for column in self.columns), *(UNITS[nuisance.kind] for nuisance in self._nuisances)]),
            quantiles=quantiles,
        )
        self._maker = Maker(system, (), self.columns)

    def __call__(self, values: Array) -> Array:
        """Return all series, one behind the other (n, n_samples), at values of the unknowns (n, d); NaN where a run fails."""
        cut = len(self.columns)
        rows, which = np.unique(values[:, :cut], axis=0, return_inverse=True)  # a channel's fault needs no run
        named = [self._row(row) for row in rows]
        chain = chains(self._nuisances, values[:, cut:], len(self.series))
        parts, k = [], 0
        for runs in self._runs:
            done = runs(named)
            for number, series in enumerate(runs.series):
                out = np.full((len(values), series.at.size), np.nan)
                for i, place in enumerate(which.ravel().tolist()):
                    raw = done[place]
                    if raw is not None:
                        out[i] = runs.recorded(number, raw[number], *(float(chain[kind][i, k]) for kind in UNITS))
                parts.append(out)
                k += 1
        return np.concatenate(parts, axis=1)

    def delayed(self, values: Array, number: int, delays: Array) -> Array:
        """Return the series of channel `number` at values (d,), with each of `delays` (n,) [s] added, (n, n_samples)."""
        chain, first = chains(self._nuisances, values[np.newaxis, len(self.columns) :], len(self.series)), 0
        for runs in self._runs:
            if number < first + len(runs.series):
                break
            first += len(runs.series)
        (raw,) = runs([self._row(values)])
        assert raw is not None
        gain, delay, offset = (float(chain[kind][0, number]) for kind in UNITS)
        return np.array([runs.recorded(number - first, raw[number - first], gain, delay + added, offset) for added in delays])

    def measures(self, work: Work, values: Array) -> Array:
        """Return the measures of a study at values of the unknowns (n, d), NaN of those that fail, (n, n_measures).

        Raises:
            ConvergenceError: all fail.
        """
        rows = [{"variant": k, **self._row(row)} for k, row in enumerate(values)]
        table = compute(work, Chunk(number=0, rows=rows)).table
        done = np.array(table["status"]) == DONE
        if not done.any():
            raise ConvergenceError(f"no draw of the posterior can be simulated: {table['message'][0]}")
        results = np.stack([table[name].to_numpy() for name in measure_names(self.system)], axis=1)
        return np.where(done[:, np.newaxis], results, np.nan)

    def tested_travel(self, values: Array) -> dict[tuple[str, str], float]:
        """Return the largest deflections of mounts in the tests, at values (d,), by mount and axis [m]."""
        names = measure_names(self.system)
        largest = dict.fromkeys(((mount, axis) for mount in self.system.mounts for axis in AXES), 0.0)
        for runs in self._runs:
            if isinstance(runs, LoopRuns):
                key = runs.test.mount, runs.test.axis
                largest[key] = max(largest[key], *(float(np.abs(loop.deflection).max()) for loop in runs.test.loops))
                continue
            for work in runs.works:
                (row,) = self.measures(work, values[np.newaxis])
                for key, reached in travel_of(names, row).items():
                    largest[key] = max(largest[key], reached)
        return largest

    def system_at(self, values: Array) -> System:
        return self._maker.system(self._row(values))

    def isolators_at(self, values: Array) -> Mapping[str, Isolator]:
        """Return the isolators that change at values of the unknowns (d,), by mount; equal ones are one object."""
        return self._maker.changes(self._row(values)).isolators

    def moves_at(self, values: Array) -> Changes:
        """Return the changes of masses, centres and positions at values (d,), without those of isolators."""
        return self._maker.moves(self._maker.draft(self._row(values)), {})

    def _row(self, values: Array) -> Entries:
        """Return values of the system's quantities, the first of (d,), by the names of their columns."""
        return {column.name: float(value) for column, value in zip(self.columns, values, strict=False)}


def travel_of(names: Sequence[str], measures: Array) -> dict[tuple[str, str], float]:
    """Return the largest deflections from measures (n_measures,), by mount and axis [m]; 0 where they are unknown."""
    travels: dict[tuple[str, str], float] = {}
    for name, value in zip(names, measures.tolist(), strict=True):
        if name.startswith("deflection/"):
            mount, _, side = name.removeprefix("deflection/").rpartition("/")
            key = mount, side if side in AXES else "axial"
            travels[key] = max(travels.get(key, 0.0), value)  # NaN is not larger
    return travels


@dataclass(frozen=True, kw_only=True)
class Nuisance:
    """Gain, delay or offset of one measuring channel or of several, as an unknown."""

    name: str  # as in `vary`, each channel's own where each has one
    kind: str  # "gain", "delay" or "offset"
    channels: tuple[int, ...]  # numbers of those that have it
    distribution: Normal | Uniform  # of its values


def nuisances(vary: Mapping[str, Distribution], channels: Sequence[str]) -> list[Nuisance]:
    """Return the gains, delays and offsets of measuring channels among the quantities that vary.

    Raises:
        ModelError: a name matches no channel.
        ValueError: a distribution is not Normal or Uniform, or relative.
    """
    nuisance_list = []
    for name, distribution in vary.items():
        if not name.startswith("channel/"):
            continue
        match = _NAME.fullmatch(name)
        if match is None:
            raise ModelError(f"`vary`: there is no quantity {name!r} of a channel; there is {FORM}.")
        pattern, kind = match.groups()
        matched = [
            k for k, full in enumerate(channels) if fnmatchcase(full, pattern) or fnmatchcase(full.partition("/")[2], pattern)
        ]
        if not matched:
            raise ModelError(f"`vary`: {name!r}: there is no channel {pattern!r}. There is: {', '.join(channels)}.")
        if not isinstance(distribution, Normal | Uniform) or distribution.relative:
            raise ValueError(f"`vary`: {name!r} must be a Normal or a Uniform, not relative, got {distribution!r}.")
        groups = [(k,) for k in matched] if distribution.each else [tuple(matched)]
        nuisance_list += [
            Nuisance(
                name=f"channel/{channels[group[0]]}/{kind}" if distribution.each else name, kind=kind, channels=group,
                distribution=distribution,
            )
            for group in groups
        ]  # fmt: skip
    return nuisance_list


def chains(nuisance_list: Sequence[Nuisance], values: Array, channels: int) -> dict[str, Array]:
    """Return gain [-], delay [s], offset [SI] of all channels, (n, n_channels) each, at nuisances' values (n, n_nuisances)."""
    chain = {kind: np.full((len(values), channels), neutral) for kind, neutral in NEUTRAL.items()}
    for nuisance, column in zip(nuisance_list, values.T, strict=True):
        for k in nuisance.channels:
            if nuisance.kind == "gain":
                chain[nuisance.kind][:, k] *= column
            else:
                chain[nuisance.kind][:, k] += column
    return chain
