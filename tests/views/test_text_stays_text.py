"""Names that a spreadsheet would compute, by IEC 81346 or in malice, are text in every file that is written for one."""

import csv

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.content.blocks import Content, Section, Statement
from wirerope_mj.engine.flexible import FlexiblePart, load_flexible
from wirerope_mj.engine.flexible.files import save_flexible
from wirerope_mj.foundation.exports import Exported, write_export
from wirerope_mj.foundation.tables import Column, Mark, Table
from wirerope_mj.views.workbook import write_workbook

MOUNT, POINT, CASE = "=F1+C1-K3", "@SUM(1,2)", "=cmd|'calc.exe'!A1"
NAMES = [MOUNT, POINT, CASE, "+K3", "-K3", "=1+2", "\t=3", "#N/A", "#DIV/0!", "=F1\x07"]
TABLES = {
    "masses": "name, mass [kg], x [mm], y [mm], z [mm], size_x [mm], size_y [mm], size_z [mm]\n"
    f"{MOUNT}, 420, 0, 0, 600, 800, 800, 1000\n",
    "mounts": "name, x [mm], y [mm], z [mm], isolator\n"
    + "".join(f"{n}, {x}, {y}, 54, enidine_wr16_700\n" for n, x, y in (
        (MOUNT, -300, -300), ("-K2", 300, -300), ("+K3", -300, 300), ("@K4", 300, 300))),
    "points": f"name; x [mm]; y [mm]; z [mm]\n{POINT}; 0; 0; 1000\n",
}  # fmt: skip


def formulas(path):
    """Return the cells of a file that a spreadsheet would compute."""
    if path.suffix == ".xlsx":
        openpyxl = pytest.importorskip("openpyxl")
        cells = [cell for sheet in openpyxl.load_workbook(path) for row in sheet.iter_rows() for cell in row]
        texts = [cell for cell in cells if isinstance(cell.value, str)]
        assert texts
        return [cell.value for cell in texts if cell.data_type != "s" or cell.value.startswith("=") and not cell.quotePrefix]
    with path.open(newline="", encoding="utf-8") as file:
        return [cell for row in csv.reader(file) for cell in row if cell[:1] in tuple("=+-@\t\r") and not number(cell)]


def number(cell):
    try:
        return np.isfinite(float(cell))
    except ValueError:
        return False


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    folder = tmp_path_factory.mktemp("named")
    for name, text in TABLES.items():
        (folder / f"{name}.csv").write_text(text, encoding="utf-8")
    assert main(["new", str(folder / "cabinet"), "--tables", str(folder)]) == 0
    return folder / "cabinet" / "cabinet.xml"


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps
def test_runs_studies_and_jobs_export_names_as_text(model, tmp_path, capsys):
    pytest.importorskip("openpyxl")
    pulse = wr.HalfSine(peak=50.0, duration=0.011, direction="z")
    wr.run_scenario(wr.Scenario("=1+1", str(model), pulse, {"duration": 0.05, "timestep": 1e-3}), tmp_path / "run")
    study = wr.Study(
        model=str(model), motion=pulse, duration=0.05, timestep=1e-3, vary={f"mount/{MOUNT}/stiffness": wr.Uniform(0.5, 1.5)},
        variants=2,
    )  # fmt: skip
    study.run(tmp_path / "study", workers=1)
    (tmp_path / "job.toml").write_text(
        f'name = "=1+1"\nmodel = "{model}"\n[simulate]\nduration = 0.05\ntimestep = 1e-3\n'
        f'[[case]]\nname = "{CASE}"\nhalf-sine = "5 g 11 ms z"\n[limits]\n"acceleration/{POINT}" = "9 g"\n',
        encoding="utf-8",
    )
    wr.run_job(tmp_path / "job.toml", tmp_path / "job", workers=1)
    for source, endings in (("run", ("xlsx", "csv")), ("study", ("xlsx", "csv")), ("job", ("xlsx",))):
        for ending in endings:
            out = tmp_path / f"{source}.{ending}"
            channels = ["--channels", "points/*/acceleration/z"] if source == "run" else []
            assert main(["export", str(tmp_path / source), str(out), *channels]) == 0, capsys.readouterr().err
            assert formulas(out) == []


def test_every_place_of_a_workbook_and_every_text_of_a_csv_file_is_typed(tmp_path):
    pytest.importorskip("openpyxl")
    table = Table(
        title=NAMES[0], columns=[Column(name) for name in NAMES], rows=[NAMES, [Mark(name, "exceeded") for name in NAMES]],
        note=NAMES[1], id="t",
    )  # fmt: skip
    content = Content(
        title=NAMES[0], verdict=Statement(text=NAMES[1]), facts=tuple((name, name) for name in NAMES),
        sections=tuple(Section(id=str(n), title=name, build=lambda name=name: (Statement(text=name, items=(name,)), table))
                       for n, name in enumerate(NAMES)),
    )  # fmt: skip
    columns = [np.array([*NAMES, None], object), np.arange(len(NAMES) + 1.0) - 5.0]
    samples = Exported(names=NAMES[:2], units=["", "m"], column=columns.__getitem__, blocks=lambda: iter([columns]), about={})
    write_workbook(content, samples, tmp_path / "all.xlsx")
    assert formulas(tmp_path / "all.xlsx") == []
    write_export(samples, tmp_path / "all.csv")
    assert formulas(tmp_path / "all.csv") == []
    with (tmp_path / "all.csv").open(newline="", encoding="utf-8") as file:
        assert [float(row[1]) for row in list(csv.reader(file))[1:]] == columns[1].tolist()


def test_points_of_a_flexible_part_are_text_and_read_back(tmp_path):
    names = [MOUNT, "@top", "-5", "'plain"]
    part = FlexiblePart(
        frequencies=[10.0], damping=[0.01], participation=[[1.0, 0.0, 0.0]],
        points={name: [0.1 * n, 0.0, 0.0] for n, name in enumerate(names)}, shapes={name: [[0.0, 0.0, 1.0]] for name in names},
    )  # fmt: skip
    save_flexible(part, tmp_path / "part")
    assert [formulas(tmp_path / "part" / file) for file in ("points.csv", "shapes.csv")] == [[], []]
    assert list(load_flexible(tmp_path / "part").points) == names
