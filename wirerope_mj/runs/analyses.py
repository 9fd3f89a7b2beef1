"""Modes, frequency responses and comparisons as folders: settings, summary, pictures, and the model as it was used."""

import json
from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

import tomli_w

from wirerope_mj.content.blocks import Chart, Content, Section, Statement
from wirerope_mj.dynamics.frequency_response import FrequencyResponse
from wirerope_mj.dynamics.frequency_response.result import BRANCHES, SWEEPS, save_tables
from wirerope_mj.dynamics.frequency_response.summary import LevelSummary, plain_summary
from wirerope_mj.dynamics.modes import Modes
from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.model_files import model_table, write_model
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.atomic_files import atomic_folder, json_text
from wirerope_mj.foundation.directions import plain_direction
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.exports import Exported
from wirerope_mj.foundation.parquet_files import read_table
from wirerope_mj.foundation.tables import Column, Table
from wirerope_mj.runs.page import REPORT

FORMAT = 1
SETTINGS = "settings.toml"
# Names of such folders in messages, and the files by which they are known.
MODES_KIND, MODES_MARKS = "folder of modes", (SETTINGS, "modes.json")
COMPARISON_KIND, COMPARISON_MARKS = "comparison", ("comparison.json", REPORT)
KIND, MARKS = "frequency response", (SETTINGS, "frequency_response.json")
# Files of the charts, by their ids.
PICTURES = {"amplitude": "frequency_response.png", "transmissibility": "transmissibility.png", "orbit-loops": "loops.png"}
_PACKAGES = ("wirerope-mj", "mujoco", "numpy", "scipy", "numba", "rerun-sdk")


def write_modes(system: System, name: str, results: Sequence[Modes], folder: Path, *, force: bool = False) -> None:
    """Write the modes of a system as `folder`, atomically: at small amplitudes, which are recorded, and larger ones.

    `name` is the model's. RecordError if the folder exists and is not one of modes that `force` replaces.
    """
    with atomic_folder(folder, force=force, kind=MODES_KIND, marks=MODES_MARKS) as temporary:
        amplitudes = [modes.amplitude for modes in results if modes.amplitude is not None]
        _write_settings(temporary, name, system, {"question": {"history": results[0].history, "amplitudes": amplitudes}})
        said = {"format": FORMAT, "results": [modes.to_dict() for modes in results]}
        (temporary / MODES_MARKS[1]).write_text(json_text(said), encoding="utf-8")
        # Here, because rerun takes longer to import than checking the options.
        from wirerope_mj.dynamics.modes.animation import animated_modes
        from wirerope_mj.views.recording.frequencies import record_modes

        record_modes(animated_modes(system, results[0]), temporary / "run.rrd", title=name, larger=results[1:])


def write_frequency_response(
    result: FrequencyResponse, findings: list[LevelSummary], content: Content, folder: Path, *, force: bool = False
) -> None:
    """Write a frequency response, its figures at each level, and its content as `folder`, atomically.

    RecordError if the folder exists and is not one of a frequency response that `force` replaces.
    """
    with atomic_folder(folder, force=force, kind=KIND, marks=MARKS) as temporary:
        options = result.options
        start, stop = options.range
        assert options.response_direction is not None
        stored: Entries = {  # the options that count for the method
            "question": {
                "accelerations": list(options.accelerations), "method": options.method,
                "direction": plain_direction(options.direction), "payload": options.payload,
                "response_direction": plain_direction(options.response_direction),
                "start": start, "stop": stop, "range_from": options.range_from,
            }
        }  # fmt: skip
        if options.method != "sweep":
            parts = ("periods", "largest_step", "smallest_step")
            stored["continuation"] = {part: getattr(options, part) for part in parts}
            if options.smoothing is not None:
                stored["continuation"]["smoothing"] = options.smoothing
        if options.method != "continuation":
            stored["sweep"] = {"rate": options.rate}
        _write_settings(temporary, result.name, result.system, stored, "pyarrow")
        tables = {block.id: block.to_dict() for block in content.blocks() if isinstance(block, Table)}
        levels = [plain_summary(finding) for finding in findings]
        said = {"format": FORMAT, "headline": content.verdict.text, "levels": levels, "tables": tables}
        (temporary / MARKS[1]).write_text(json_text(said), encoding="utf-8")
        save_tables(result, temporary)
        # Here, because rerun and the page take longer to import than checking the options.
        from wirerope_mj.views.pictures import save_pictures
        from wirerope_mj.views.report import report_html

        title = f"{result.name}, base {dict(content.facts)['Base']}"
        charts = {block.id: block for block in content.blocks() if isinstance(block, Chart)}
        for name, picture in PICTURES.items():
            if name in charts:
                save_pictures([charts[name]], temporary / picture, title=title)
        (temporary / REPORT).write_text(report_html(content), encoding="utf-8")
        if result.branches:
            from wirerope_mj.views.recording.frequencies import record_branches

            record_branches(result, findings, content, temporary / "run.rrd")


def write_comparison(
    content: Content, folder: Path, record: Callable[[Path], object] | None = None, *, force: bool = False
) -> None:
    """Write what differs between runs or jobs as `folder`, atomically: figures, page, and what `record` writes as recording.

    RecordError if the folder exists and is not one of a comparison that `force` replaces.
    """
    with atomic_folder(folder, force=force, kind=COMPARISON_KIND, marks=COMPARISON_MARKS) as temporary:
        figures = {"format": FORMAT, **content.to_dict(*(section.id for section in content.sections))}
        (temporary / COMPARISON_MARKS[0]).write_text(json_text(figures), encoding="utf-8")
        from wirerope_mj.views.report import report_html  # late: the page takes longer to import than checking the options

        (temporary / REPORT).write_text(report_html(content), encoding="utf-8")
        if record is not None:
            record(temporary / "run.rrd")


def is_frequency_response(folder: Path) -> bool:
    return all((folder / mark).is_file() for mark in MARKS)


def stored_response(folder: Path) -> tuple[Content, Exported]:
    """Read the tables of a frequency response's folder: its branches, or else its sweeps, as tables to export.

    RecordError if a file is damaged.
    """
    path = folder / MARKS[1]
    try:
        stored = json.loads(path.read_text(encoding="utf-8"))
        tables = [
            Table(
                name, table["title"], [Column(column["heading"], column["shown_in"]) for column in table["columns"]],
                table["rows"], note=table.get("note", ""),
            )
            for name, table in stored["tables"].items()
        ]  # fmt: skip
        content = Content(
            title=f"{folder.name}: frequency response", verdict=Statement("headline", stored["headline"]),
            sections=(Section("tables", "", lambda: tables),),
        )  # fmt: skip
    except (ValueError, KeyError, TypeError) as error:
        raise RecordError(f"{path}: this is not what `wirerope frf` writes: {error}") from None
    file = next(file for file in (folder / BRANCHES, folder / SWEEPS) if file.is_file())
    read = read_table(file, kind="a table of a frequency response", remedy="Compute it again by `wirerope frf`.")
    names = [name for name in read.column_names if not name.startswith("unknown/")]
    columns = [read.column(name).to_numpy(zero_copy_only=False) for name in names]
    units = {"frequency": "Hz"} | dict.fromkeys(("acceleration", "amplitude", "base_amplitude", "residual"), "m/s^2")

    def unit(name: str) -> str:
        return units.get(name) or ("m/s^2" if name.startswith("bodies/") else "m" if name.startswith("mounts/") else "")

    return content, Exported(
        names=names, units=[unit(name) for name in names], column=columns.__getitem__, blocks=lambda: iter([columns]),
        about={"model": folder.name},
    )  # fmt: skip


def _write_settings(folder: Path, name: str, system: System, tables: Mapping[str, object], *packages: str) -> None:
    """Write the model as used, every resolved input, and the versions that computed it."""
    settings = {
        "format": FORMAT, "name": name, "written": datetime.now(UTC).replace(microsecond=0),
        "model": model_table(system, write_model(system, folder / "model")), **tables,
        "versions": {package: version(package) for package in (*_PACKAGES, *packages)},
    }  # fmt: skip
    (folder / SETTINGS).write_text(tomli_w.dumps(settings), encoding="utf-8")
