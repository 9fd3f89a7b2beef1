"""A frequency response as one folder: settings, figures, tables, pictures, the recording, and the model as it was used."""

import json
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

import tomli_w

from wirerope_mj.dynamics.frequency_response import FrequencyResponse
from wirerope_mj.dynamics.frequency_response.storage import save_tables
from wirerope_mj.dynamics.frequency_response.summary import Findings, summary
from wirerope_mj.engine.system.model_files import model_table, write_model
from wirerope_mj.foundation.directions import direction_text, plain_direction
from wirerope_mj.runs.folder import atomic_run

FORMAT = 1
SETTINGS, SUMMARY = "settings.toml", "frequency_response.json"
KIND, MARKS = "frequency response", (SETTINGS, SUMMARY)
"""What messages call such a folder, and the files by which one is known."""

_PACKAGES = ("wirerope-mj", "mujoco", "numpy", "scipy", "numba", "pyarrow", "rerun-sdk", "matplotlib")


def write_frequency_response(
    result: FrequencyResponse, findings: list[Findings], folder: Path, *, force: bool = False
) -> None:
    """Write a frequency response as `folder`, whole or not at all.

    Args:
        result: what was computed.
        findings: what is read off it, level by level.
        folder: must not exist, or be empty, or hold a frequency response that `force` replaces.
        force: whether one that is there is replaced.

    Raises:
        RecordError: the folder exists and must not be replaced.
    """
    with atomic_run(folder, force=force, kind=KIND, marks=MARKS) as beside:
        model = write_model(result.system, beside / "model")
        content = _settings(result, model_table(result.system, model))
        (beside / SETTINGS).write_text(tomli_w.dumps(content), encoding="utf-8")
        figures = {"format": FORMAT, "levels": summary(findings)}
        (beside / SUMMARY).write_text(json.dumps(figures, indent=2, allow_nan=False) + "\n", encoding="utf-8")
        save_tables(result, beside)
        _write_pictures(result, findings, beside)


def _settings(result: FrequencyResponse, model: dict[str, str]) -> dict[str, Any]:
    """Return every input with nothing left open, and the versions that computed it."""
    asked = result.question
    start, stop = asked.range
    assert asked.response_direction is not None
    content: dict[str, Any] = {
        "format": FORMAT,
        "name": result.name,
        "written": datetime.now(UTC).replace(microsecond=0),
        "model": model,
        "question": {
            "accelerations": list(asked.accelerations),
            "method": asked.method,
            "direction": plain_direction(asked.direction),
            "payload": asked.payload,
            "response_direction": plain_direction(asked.response_direction),
            "start": start,
            "stop": stop,
            "range_from": asked.range_from,
        },
    }
    if asked.method != "sweep":
        parts = ("periods", "largest_step", "smallest_step")
        content["continuation"] = {part: getattr(asked, part) for part in parts}
        if asked.smoothing is not None:
            content["continuation"]["smoothing"] = asked.smoothing
    if asked.method != "continuation":
        content["sweep"] = {"rate": asked.rate}
    return content | {"versions": {name: version(name) for name in _PACKAGES}}


def _write_pictures(result: FrequencyResponse, findings: list[Findings], folder: Path) -> None:
    # Here, because matplotlib and rerun take longer to import than checking what was asked.
    from wirerope_mj.views.plots.frequency_response import save_amplitudes, save_transmissibilities
    from wirerope_mj.views.plots.orbit_loops import save_resonance_loops

    asked = result.question
    assert asked.response_direction is not None
    what = f"{asked.payload} along {direction_text(asked.response_direction)}"
    title = f"{result.name}, base along {direction_text(asked.direction)}"
    save_amplitudes(findings, folder / "frequency_response.png", title=title, what=what)
    save_transmissibilities(findings, folder / "transmissibility.png", title=title, what=what)
    if result.branches and result.system.mounts:
        save_resonance_loops(result.branches, folder / "loops.png", title=title)
    if result.branches:
        from wirerope_mj.views.recording.branch import record_branches

        record_branches(result, findings, folder / "run.rrd")
