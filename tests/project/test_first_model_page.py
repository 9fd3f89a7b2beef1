"""The page of the first model: its tables and its commands as they stand, without Python."""

import json
import re
import shlex
from pathlib import Path

import pytest

from wirerope_mj.cli import main
from wirerope_mj.foundation.resources import models_folder

PAGE = (Path(__file__).parents[2] / "docs" / "first_model.md").read_text(encoding="utf-8")
TABLES = {text.split()[1]: text for text in re.findall(r"```csv\n(.*?)```", PAGE, flags=re.DOTALL)}
COMMANDS = [line for block in re.findall(r"```bash\n(.*?)```", PAGE, flags=re.DOTALL) for line in block.splitlines()]


@pytest.mark.slow
def test_tables_become_a_report_in_at_most_twelve_commands(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name, text in TABLES.items():
        Path(name).write_text(text, encoding="utf-8")
    assert len(COMMANDS) <= 12
    for command in COMMANDS:
        program, *arguments = shlex.split(command)
        assert program == "wirerope"
        assert main(arguments) == 0, command
    assert Path("runs/shock/report.html").is_file()
    assert Path("statics.json").is_file()
    printed = capsys.readouterr().out
    of_weight = re.findall(r"^m\d +(?:virgin|relaxed) +(?:\S+ +){4}(\S+) ", printed, flags=re.MULTILINE)
    assert of_weight == ["16.7"] * 24  # six mounts, on the first loading and relaxed, after `new` and after `statics`
    bounce = re.search(r"^\d +bounce z +([\d.]+)", printed, flags=re.MULTILINE)
    assert bounce
    assert float(bounce[1]) == pytest.approx(12.1, abs=0.05)  # the page says so
    sentence = "Beyond acceleration/genset = 6 g: 2 of 128 variants, 1.6 % (0.2 % to 5.5 % at 95 % confidence)."
    assert sentence in printed  # as the page says; the limit is that of the run
    assert "Stops are struck in 65 of 128" in printed
    assert "beyond 100 % in 0 of 128" in printed
    assert "limit 6 g" in json.loads(Path("runs/shock/summary.json").read_text())["verdicts"][0]


def test_the_tables_of_the_page_are_those_of_the_template():
    for name in ("mounts", "masses", "stops", "points", "forces"):
        shipped = (models_folder() / "templates" / "genset" / f"{name}.csv").read_text(encoding="utf-8")
        rows = [[line for line in text.splitlines() if not line.startswith("#")] for text in (shipped, TABLES[f"{name}.csv"])]
        assert rows[0] == rows[1]
