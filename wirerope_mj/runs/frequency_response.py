"""A frequency response as one folder: settings, summary, tables, pictures, the recording, and the model as it was used."""

import json
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

import tomli_w

from wirerope_mj.content.blocks import Content
from wirerope_mj.content.panels import Chart
from wirerope_mj.dynamics.frequency_response import FrequencyResponse
from wirerope_mj.dynamics.frequency_response.result import save_tables
from wirerope_mj.dynamics.frequency_response.summary import LevelSummary, plain_summary
from wirerope_mj.engine.system.model_files import model_table, write_model
from wirerope_mj.foundation.directions import plain_direction
from wirerope_mj.foundation.tables import Table
from wirerope_mj.runs.folder import atomic_run
from wirerope_mj.runs.page import REPORT

FORMAT = 1
SETTINGS, SUMMARY = "settings.toml", "frequency_response.json"
# Name of such a folder in messages, and the files by which one is known.
KIND, MARKS = "frequency response", (SETTINGS, SUMMARY)
# Files of the charts, by their ids.
PICTURES = {
    "amplitude": "frequency_response.png", "transmissibility": "transmissibility.png", "orbit-loops": "loops.png",
}  # fmt: skip
_PACKAGES = ("wirerope-mj", "mujoco", "numpy", "scipy", "numba", "pyarrow", "rerun-sdk", "matplotlib")


def write_frequency_response(
    result: FrequencyResponse,
    findings: list[LevelSummary],
    content: Content,
    folder: Path,
    *,
    force: bool = False,
) -> None:
    """Write a frequency response as `folder`, atomically.

    Args:
        result: what was computed.
        findings: what is read off it, level by level.
        content: what it says.
        folder: must not exist, or be empty, or hold a frequency response that `force` replaces.
        force: whether one that is there is replaced.

    Raises:
        RecordError: the folder exists and must not be replaced.
    """
    with atomic_run(folder, force=force, kind=KIND, marks=MARKS) as temporary:
        model = write_model(result.system, temporary / "model")
        settings = _settings(result, model_table(result.system, model))
        (temporary / SETTINGS).write_text(tomli_w.dumps(settings), encoding="utf-8")
        tables = {block.id: block.to_dict() for block in content.blocks() if isinstance(block, Table)}
        levels = [plain_summary(one) for one in findings]
        summary_content = {"format": FORMAT, "headline": content.verdict.text, "levels": levels, "tables": tables}
        (temporary / SUMMARY).write_text(
            json.dumps(summary_content, indent=2, allow_nan=False) + "\n", encoding="utf-8"
        )
        save_tables(result, temporary)
        _write_views(result, findings, content, temporary)


def _settings(result: FrequencyResponse, model: dict[str, str]) -> dict[str, Any]:
    """Return every input with nothing left open, and the versions that computed it."""
    options = result.options
    start, stop = options.range
    assert options.response_direction is not None
    content: dict[str, Any] = {
        "format": FORMAT,
        "name": result.name,
        "written": datetime.now(UTC).replace(microsecond=0),
        "model": model,
        "question": {
            "accelerations": list(options.accelerations),
            "method": options.method,
            "direction": plain_direction(options.direction),
            "payload": options.payload,
            "response_direction": plain_direction(options.response_direction),
            "start": start,
            "stop": stop,
            "range_from": options.range_from,
        },
    }
    if options.method != "sweep":
        parts = ("periods", "largest_step", "smallest_step")
        content["continuation"] = {part: getattr(options, part) for part in parts}
        if options.smoothing is not None:
            content["continuation"]["smoothing"] = options.smoothing
    if options.method != "continuation":
        content["sweep"] = {"rate": options.rate}
    return content | {"versions": {name: version(name) for name in _PACKAGES}}


def _write_views(result: FrequencyResponse, findings: list[LevelSummary], content: Content, folder: Path) -> None:
    # Here, because matplotlib and rerun take longer to import than checking the options.
    from wirerope_mj.views.plots.png_chart import save_charts
    from wirerope_mj.views.report import report_html

    title = f"{result.name}, base {dict(content.facts)['Base']}"
    charts = {block.id: block for block in content.blocks() if isinstance(block, Chart)}
    for name, picture in PICTURES.items():
        if name in charts:
            save_charts([charts[name]], folder / picture, title=title)
    (folder / REPORT).write_text(report_html(content), encoding="utf-8")
    if result.branches:
        from wirerope_mj.views.recording.branch import record_branches

        record_branches(result, findings, content, folder / "run.rrd")
