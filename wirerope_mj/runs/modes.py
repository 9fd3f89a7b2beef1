"""Modes as one folder: settings, summary, the recording, and the model as it was used."""

import json
from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

import tomli_w

from wirerope_mj.dynamics.modes import Modes
from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.model_files import model_table, write_model
from wirerope_mj.runs.folder import atomic_run

FORMAT = 1
SETTINGS, FIGURES = "settings.toml", "modes.json"
# Name of such a folder in messages, and the files by which one is known.
KIND, MARKS = "folder of modes", (SETTINGS, FIGURES)
_PACKAGES = ("wirerope-mj", "mujoco", "numpy", "scipy", "numba", "rerun-sdk")


def write_modes(system: System, name: str, results: Sequence[Modes], folder: Path, *, force: bool = False) -> None:
    """Write the modes of a system as `folder`, atomically.

    Args:
        system: the system.
        name: of the model.
        results: modes of small cycles, which are recorded, and those of larger ones.
        folder: must not exist, or be empty, or hold modes that `force` replaces.
        force: whether those that are there are replaced.

    Raises:
        RecordError: the folder exists and must not be replaced.
    """
    with atomic_run(folder, force=force, kind=KIND, marks=MARKS) as temporary:
        model = write_model(system, temporary / "model")
        settings = {
            "format": FORMAT,
            "name": name,
            "written": datetime.now(UTC).replace(microsecond=0),
            "model": model_table(system, model),
            "question": {
                "history": results[0].history,
                "amplitudes": [modes.amplitude for modes in results if modes.amplitude is not None],
            },
            "versions": {package: version(package) for package in _PACKAGES},
        }
        (temporary / SETTINGS).write_text(tomli_w.dumps(settings), encoding="utf-8")
        content = {"format": FORMAT, "results": [modes.to_dict() for modes in results]}
        (temporary / FIGURES).write_text(json.dumps(content, indent=2, allow_nan=False) + "\n", encoding="utf-8")
        # Here, because rerun takes longer to import than checking the options.
        from wirerope_mj.dynamics.modes.animation import animated_modes
        from wirerope_mj.views.recording.modes import record_modes

        record_modes(animated_modes(system, results[0]), temporary / "run.rrd", title=name, larger=results[1:])
