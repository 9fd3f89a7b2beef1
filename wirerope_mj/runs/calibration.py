"""A calibration as one folder: page, summary, draws, the calibrated model with its isolators, and a run of the first test."""

from pathlib import Path

from wirerope_mj.content.blocks import Content
from wirerope_mj.engine.system.model_files import write_whole
from wirerope_mj.foundation.atomic_files import atomic_folder, json_text
from wirerope_mj.foundation.parquet_files import write_rows
from wirerope_mj.runs.page import REPORT
from wirerope_mj.studies.calibration.calibrate import Calibration
from wirerope_mj.studies.calibration.isolators import calibrated_isolators, calibrated_system
from wirerope_mj.views.report import report_html

SUMMARY, DRAWS = "calibration.json", "draws.parquet"
KIND, MARKS = "calibration", (SUMMARY,)
_SECTIONS = ("values", "answer", "prediction", "channels", "known-together", "read-from")


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
