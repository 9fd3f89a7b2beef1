"""Records of cyclic tests as `wirerope identify` takes them: read, compared, and what is to be said of their loops."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from wirerope_mj.cli.identify_report import millimetres
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.mounts.identification.measured import prepare
from wirerope_mj.mounts.identification.result import Identification
from wirerope_mj.mounts.identification.stops import closes
from wirerope_mj.mounts.laws import Loop, Stop
from wirerope_mj.mounts.test_rig import read_cycles
from wirerope_mj.mounts.test_rig.clipping import is_level
from wirerope_mj.mounts.test_rig.recorded import RecordedLoop

Tests = Mapping[Path, Sequence[Loop]]

_STEADY = 0.01
"""Share of the force range within which cycles that count as steady close: noise of 1 % of its half shows half of it."""

_ONE_CYCLE = 0.05
"""The same of a single cycle, whose ends have the noise of samples."""

_SOFT = 1e3
"""Secant stiffness [N/m] below which a device carries less than a kilogram on a centimetre."""

_OTHER_UNITS = 100.0
"""Times that the stiffness of one file may be another's: amplitudes change it tenfold, a wrong unit a thousandfold."""


def read_tests(files: Sequence[Path], *, stop: bool = False) -> dict[Path, list[Loop]]:
    """Return the loops by file, or raise RecordError that names the file which cannot be used.

    Args:
        files: records.
        stop: whether the device is a bare bump stop, which may have no force in some of them.
    """
    tests: dict[Path, list[Loop]] = {}
    for path in files:
        if path in tests:
            raise ValueError(f"{path} is named twice; its loops would count twice.")
        tests[path] = read_cycles(path, stop=stop)
        try:
            prepare(tests[path], stop=stop)
        except ValueError as error:
            raise RecordError(f"{path}: {error}") from None
    if stop:
        return tests
    stiffness = {path: float(np.median([loop.secant_stiffness for loop in loops])) for path, loops in tests.items()}
    soft, stiff = min(stiffness, key=stiffness.__getitem__), max(stiffness, key=stiffness.__getitem__)
    if stiffness[stiff] > _OTHER_UNITS * stiffness[soft]:
        raise RecordError(
            f"{stiff}: the secant stiffness is {stiffness[stiff]:.3g} N/m, in {soft} it is {stiffness[soft]:.3g} N/m. Are the "
            "units those that the headers say, and is it the same device?"
        )
    return tests


def remarks(tests: Tests, result: Identification) -> list[str]:
    """Return what is to be known of loops before their fit is believed, one sentence each."""
    if isinstance(result.law, Stop):
        tests, open_ones = _closing(tests)
        return open_ones + _unsteady(tests) + _unexplained(tests, result)
    return _unsteady(tests) + _unexplained(tests, result) + _level(tests) + _soft(tests)


def _closing(tests: Tests) -> tuple[Tests, list[str]]:
    """Return the loops that close a bare stop, and which do not in words."""
    inside = {id(loop) for loops in tests.values() for loop in loops if not closes(prepare([loop], stop=True)[0])}
    words = [
        f"{path}: ±{1e3 * loop.amplitude:.3g} mm about {millimetres(loop.operating_point)} mm stays within the gap and is not "
        "fitted"
        for path, loops in tests.items()
        for loop in loops
        if id(loop) in inside
    ]
    return {path: [loop for loop in loops if id(loop) not in inside] for path, loops in tests.items()}, words


def _unsteady(tests: Tests) -> list[str]:
    """Return which loops count as steady and still change from cycle to cycle, in words."""
    return [
        f"{path}: ±{1e3 * loop.amplitude:.3g} mm about {millimetres(loop.operating_point)} mm is not steady, its last cycle "
        f"ends {100.0 * loop.closure:.2g} % of its force range from where it began, and is fitted as if it were: "
        "parameters may be off by more than their errors. Record the way from the unloaded device, or more cycles"
        for path, loops in tests.items()
        for loop in loops
        if not (isinstance(loop, RecordedLoop) and loop.averaged)
        and loop.closure > (_STEADY if loop.cycles > 1 else _ONE_CYCLE)
    ]


def _unexplained(tests: Tests, result: Identification) -> list[str]:
    """Return which loops change from cycle to cycle otherwise than the law on its way from the unloaded device, in words."""
    words = []
    for path, loops in tests.items():
        for loop in loops:
            if not (isinstance(loop, RecordedLoop) and loop.averaged > 1):
                continue
            law_closure = prepare([loop], stop=isinstance(result.law, Stop))[0].law_closure(result.law)
            # Besides its noise, which the residual is a measure of.
            if abs(loop.closure - law_closure) > _STEADY + result.residual:
                size, point = f"±{1e3 * loop.amplitude:.3g} mm", millimetres(loop.operating_point)
                words.append(
                    f"{path}: the last cycle of {size} about {point} mm ends {100.0 * loop.closure:.2g} % of its force range "
                    f"from where it began, the law's {100.0 * law_closure:.2g} %: was the device unloaded when the record "
                    "began? If not, parameters may be off by more than their errors; record all amplitudes in one, "
                    "or more cycles"
                )
    return words


def _level(tests: Tests) -> list[str]:
    """Return which loops have a force that stays level at an end, in words."""
    return [
        f"{path}: the force of ±{1e3 * loop.amplitude:.3g} mm about {millimetres(loop.operating_point)} mm is level at an end "
        "of its stroke: the device yields there, the load cell cut a little off, or one channel lags behind the other"
        for path, loops in tests.items()
        for loop in loops
        if is_level(loop)
    ]


def _soft(tests: Tests) -> list[str]:
    """Return which files hold a device so soft that its forces may be kilonewtons taken for newtons, in words."""
    stiffness = {path: max(loop.secant_stiffness for loop in loops) for path, loops in tests.items()}
    return [
        f"{path}: its secant stiffness of at most {size:.3g} N/m is that of a very soft device; "
        "are the forces in kN where N is said?"
        for path, size in stiffness.items()
        if size < _SOFT
    ]


def held(loops: Sequence[Loop]) -> str:
    """Return what a file holds in words."""
    parts = [
        f"±{1e3 * loop.amplitude:.3g} mm about {millimetres(loop.operating_point)} mm ({loop.cycles} cycles)"
        for loop in loops
    ]
    return ", ".join(parts)
