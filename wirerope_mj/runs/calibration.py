"""A calibration as one folder: page, summary, draws, the calibrated model with its isolators, and a run of the first test."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from wirerope_mj.content.blocks import Content
from wirerope_mj.engine.system import Changes, System, load_system
from wirerope_mj.engine.system.model_files import write_whole
from wirerope_mj.engine.system.varied import with_changes
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.foundation.atomic_files import atomic_folder, json_text
from wirerope_mj.foundation.parquet_files import write_rows
from wirerope_mj.mounts.isolator import Isolator, Provenance, Spread
from wirerope_mj.runs.page import REPORT
from wirerope_mj.studies.calibration.calibrate import Calibration
from wirerope_mj.views.report import report_html

SUMMARY, DRAWS = "calibration.json", "draws.parquet"
KIND, MARKS = "calibration", (SUMMARY,)
_SECTIONS = ("values", "answer", "prediction", "channels", "known-together", "read-from")

_DRAWS = 400  # draws from which a spread is taken: its standard deviations are then known to 4 %
_MOVED = 1e-9  # relative standard deviation below which a parameter is constant


def write_calibration(result: Calibration, content: Content, folder: Path, *, force: bool = False) -> list[str]:
    """Write a calibration as `folder`, atomically, and return the names of what lies there.

    It holds `report.html`, `calibration.json`, the draws, and `model/`: the model with the calibrated isolators, each with its
    spread, and with the masses, centres and positions that were found.

    Raises:
        RecordError: the folder exists and must not be replaced.
    """
    with atomic_folder(folder, force=force, kind=KIND, marks=MARKS) as temporary:
        isolators = calibrated_isolators(result, [test.name for test in result.forward.tests])
        write_whole(calibrated_system(result, isolators), temporary / "model")
        said = {"format": 1, **content.to_dict(*_SECTIONS)}
        (temporary / SUMMARY).write_text(json_text(said), encoding="utf-8")
        write_rows(temporary / DRAWS, list(result.names), result.samples, {"units": list(result.units)})
        (temporary / REPORT).write_text(report_html(content), encoding="utf-8")
    return sorted(f"{path.name}{'/' if path.is_dir() else ''}" for path in folder.iterdir())


def calibrated_isolators(calibration: Calibration, tests: Sequence[str]) -> dict[str, Isolator]:
    """Return the isolators that a calibration changed, by mount, with the spread that the tests leave.

    The spread is the covariance of the laws' parameters over draws of the posterior, so that a study with
    `"mount/NAME/spread": Specimens()` draws from it.
    """
    forward = calibration.forward
    middle = forward.isolators_at(calibration.values)
    draws = [forward.isolators_at(row) for row in calibration.samples[:_DRAWS]]
    varied = [name for name in calibration.names if name.startswith("mount/")]
    calibrated: dict[str, Isolator] = {}
    same: dict[tuple[int, ...], Isolator] = {}
    for mount, isolator in middle.items():
        key = tuple(id(draw[mount]) for draw in draws)  # mounts that vary together share their isolators
        if key not in same:
            written = forward.system.mounts[mount].written
            before = written.provenance
            provenance = Provenance(
                kind="identified",
                source=f"calibrated from {', '.join(tests)}" + (f"; before: {before.source}" if before.source else ""),
                fitted_to=f"{', '.join(varied)}; {calibration.message}",
                assumed=(*before.assumed, *calibration.not_identified),
            )
            values: Array = np.array([[value for _, value in _parameters(draw[mount])] for draw in draws])
            moved = np.std(values, axis=0) > _MOVED * np.abs(values).max(axis=0)
            spread = None
            if moved.any():
                names = tuple(name for (name, _), varies in zip(_parameters(isolator), moved, strict=True) if varies)
                covariance = np.atleast_2d(np.cov(values[:, moved].T)).tolist()
                spread = Spread(parameters=names, covariance=tuple(map(tuple, covariance)), calibrated=True)
            same[key] = replace(isolator, provenance=provenance, spread=spread)
        calibrated[mount] = same[key]
    return calibrated


def calibrated_system(calibration: Calibration, isolators: dict[str, Isolator]) -> System:
    """Load the system with the medians of the unknowns, in its isolator files where files can hold them.

    Mounts that share an isolator file get one calibrated file; where they differ now, and of masses, centres and positions,
    `changes` say it.
    """
    system = calibration.forward.system
    files: dict[str, Isolator] = dict(system.isolators)
    of_mounts: dict[str, Isolator] = {}
    for name in files:
        mounts = [mount for mount, item in system.mounts.items() if item.isolator_name == name]
        changed = {id(isolators.get(mount)): isolators.get(mount) for mount in mounts}
        (first, *differing) = changed.values() or [None]
        if first is not None and not differing:
            files[name] = first
        else:
            of_mounts |= {mount: isolators[mount] for mount in mounts if mount in isolators}
    loaded = load_system(system.path or system.mjcf, isolators=files)
    moves = calibration.forward.moves_at(calibration.values)
    changes = [*system.changes, replace(moves, isolators=of_mounts)]
    return with_changes(loaded, [change for change in changes if change != Changes()])


def _parameters(isolator: Isolator) -> Iterator[tuple[str, float]]:
    """Yield names, such as "axial.alpha", and values of all numbers of an isolator's laws."""
    for axis, law in isolator.axes.items():
        for number, part in enumerate(law.components if law is not None else ()):
            before = f"{axis}.laws[{number}]." if law is not part else f"{axis}."
            for key, value in part.to_dict().items():
                if key == "law" or isinstance(value, str | bool):
                    continue
                if isinstance(value, list):
                    yield from ((f"{before}{key}[{k}]", float(item)) for k, item in enumerate(value))
                else:
                    yield f"{before}{key}", float(value)
