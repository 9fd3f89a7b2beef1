"""docs/toml_files.md names every key that the readers of TOML files know."""

import inspect
import re
from dataclasses import fields
from pathlib import Path

import pytest

from wirerope_mj.content.blocks import TEXTS, Document, Revision
from wirerope_mj.motions.spoken import SPOKEN_MOTIONS
from wirerope_mj.mounts.isolator import AXES, tables
from wirerope_mj.mounts.isolator.parts import Travel
from wirerope_mj.mounts.laws import LAWS
from wirerope_mj.mounts.vendor_parts import sheet as sheet_file
from wirerope_mj.runs import job_file, measured, scenario_file

PAGE = (Path(__file__).parents[2] / "docs" / "toml_files.md").read_text(encoding="utf-8")
NAMED = set(re.findall(r"`\[*([\w-]+)\]*`", PAGE))


@pytest.mark.quick
def test_every_key_of_an_isolator_file_is_there():
    keys = {*tables._KEYS, *AXES, *tables.PARTS, "law", "laws"}
    keys |= {field.name for part in tables.PARTS.values() for field in fields(part)} | {field.name for field in fields(Travel)}
    assert keys <= NAMED


@pytest.mark.quick
@pytest.mark.parametrize("name", LAWS)
def test_a_law_stands_there_with_all_its_parameters(name):
    (row,) = [line for line in PAGE.splitlines() if line.startswith(f"| `{name}` ")]
    assert set(inspect.signature(LAWS[name]).parameters) <= set(re.findall(r"`(\w+)`", row))


@pytest.mark.quick
def test_every_key_of_a_data_sheet_is_there():
    source = inspect.getsource(sheet_file)
    keys = set(re.findall(r'(?:quantity|number|text|texts|integer|pairs)\("(\w+)"', source))
    keys |= {f"{name}_{kind}" for kind in ("stiffness", "load") for name in ("vibration", "static", "shock")} - {
        "vibration_load", "static_stiffness",
    }  # fmt: skip
    assert keys | {"roll", "damping_range", "diagonal"} <= NAMED


@pytest.mark.quick
def test_every_key_of_levels_and_of_a_run_is_there():
    keys = {*SPOKEN_MOTIONS, "standard", "motion", "factor"}
    keys |= {key for table, known in scenario_file._TABLES.items() for key in (table, *known)}
    keys |= {*scenario_file._NEEDED, "format", "name", "question", "judge"}
    assert keys <= NAMED
    assert scenario_file.read_judge_table({}).keys() <= NAMED


@pytest.mark.quick
def test_every_key_of_a_map_of_a_measurement_is_there():
    assert {*measured._OPTIONS, "channels", "file", "name"} <= NAMED


@pytest.mark.quick
def test_every_key_of_a_job_is_there():
    keys = {*job_file._JOB, *job_file._CASE, *job_file.REPORTED, "files", "text", *TEXTS}
    keys |= {field.name for kind in (Document, Revision) for field in fields(kind)} - {"texts"}
    assert {f"document.{name}" for name in ("history", "text")} <= set(re.findall(r"`\[+([\w.]+)\]+`", PAGE))
    assert keys - {"case", "document", "history", "text"} <= NAMED
