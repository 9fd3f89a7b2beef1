"""The pages name every key that the classes of TOML files have, and the schemas that ship say what they say."""

import inspect
import json
import re
import tomllib
from pathlib import Path

import jsonschema
import pytest

from wirerope_mj.cli import main
from wirerope_mj.foundation.resources import catalogue_folder, scenarios_folder
from wirerope_mj.motions.registry import SPOKEN_MOTIONS
from wirerope_mj.mounts.laws import LAWS
from wirerope_mj.runs.job_file import REPORTED
from wirerope_mj.runs.schemas import FILES, SHIPPED, file_schema

pytestmark = pytest.mark.quick

ROOT = Path(__file__).parents[2]
PAGE, LAWS_PAGE = ((ROOT / "docs" / name).read_text(encoding="utf-8") for name in ("toml_files.md", "laws.md"))
NAMED = {*re.findall(r"`\[*([\w.-]+)\]*`", PAGE + LAWS_PAGE), *SPOKEN_MOTIONS}  # whose options are those of docs/shock.md
UNIT = r"(m|mm|cm|in|um|ft|N|daN|kN|lbf|lb|kip|kgf|N_per_mm|lb_per_in|J)"


def keys_in(content):
    """Yield every key of a schema."""
    for part in content if isinstance(content, list) else content.values():
        if isinstance(part, dict | list):
            yield from keys_in(part)
    yield from content.get("properties", {}) if isinstance(content, dict) else ()


@pytest.mark.parametrize("kind", FILES)
def test_every_key_of_a_file_is_on_a_page(kind):
    keys = set(keys_in(file_schema(kind)))
    known = NAMED | {name.rpartition(".")[2] for name in NAMED}  # such as document.history
    assert {*REPORTED} <= NAMED
    assert not {key for key in keys if key not in known and re.sub(f"_{UNIT}(_{UNIT})?$", "", key) not in known}


@pytest.mark.parametrize("name", LAWS)
def test_a_law_stands_there_with_all_its_parameters(name):
    (row,) = [line for line in LAWS_PAGE.splitlines() if f" | `{name}`: " in line]
    assert set(inspect.signature(LAWS[name]).parameters) <= set(re.findall(r"`(\w+)`", row))


@pytest.mark.parametrize("kind", FILES)
def test_a_schema_that_ships_is_that_of_the_classes(kind):
    """`python -m wirerope_mj.runs.schemas` writes them."""
    assert json.loads((SHIPPED / f"{kind}.json").read_text(encoding="utf-8")) == file_schema(kind)
    jsonschema.Draft202012Validator.check_schema(file_schema(kind))
    assert f"`{kind}.json`" in PAGE


def test_every_file_that_ships_keeps_its_schema():
    sheets = catalogue_folder() / "datasheets"
    isolators = {path for path in catalogue_folder().rglob("*.toml") if path.parent != sheets}
    files = {
        "isolator": isolators,
        "datasheet": {*sheets.glob("*.toml")},
        "levels": {*(scenarios_folder() / "levels").glob("*")},
    }
    assert all(map(len, files.values()))
    for kind, paths in files.items():
        validator = jsonschema.Draft202012Validator(file_schema(kind))
        for path in paths:
            validator.validate(tomllib.loads(path.read_text(encoding="utf-8")))


def test_the_command_writes_them_where_editors_find_them(tmp_path, capsys):
    assert main(["schemas", str(tmp_path / "schemas")]) == 0
    assert str(tmp_path / "schemas" / "job.json") in capsys.readouterr().out
    assert {path.name for path in (tmp_path / "schemas").iterdir()} == {f"{kind}.json" for kind in FILES}
    assert main(["schemas", str(tmp_path / "schemas")]) == 2
    assert "isolator.json: the file exists; --force replaces it" in capsys.readouterr().err
    assert main(["schemas", str(tmp_path / "schemas"), "--force"]) == 0
