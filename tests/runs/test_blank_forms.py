"""Blank forms: made of the classes and columns that read them, with every key, and accepted as they are written."""

import csv
import tomllib
from dataclasses import MISSING, fields

import numpy as np
import pytest
from commands import refused
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.cli.cases import BLANK_JOB
from wirerope_mj.engine.from_tables.forms import _MEANING, blank_table
from wirerope_mj.engine.from_tables.read import COLUMNS
from wirerope_mj.foundation.schema import blank_form
from wirerope_mj.foundation.structure import Place, keys_of, structure, tables_in
from wirerope_mj.motions.registry import motion_from_phrase
from wirerope_mj.mounts.vendor_parts import vendor_parts
from wirerope_mj.mounts.vendor_parts.short_sheet import ShortSheet, fit_short, ratios, read_short_sheet
from wirerope_mj.runs.job_file import JobFile, load_job

pytestmark = pytest.mark.quick

FORMS = {"sheet": (ShortSheet, ()), "job": (JobFile, BLANK_JOB)}


def all_uncommented(text):
    """Take the # off every line that is a key or a heading; lines of prose have a space behind it."""
    lines = [line[1:] if line.startswith("#") and line[1:2] not in (" ", "") else line for line in text.splitlines()]
    return tomllib.loads("\n".join(lines))


def fields_in(kind, content):
    """Yield the fields of a class that no key of a table states, and those of the tables in it, as dotted names."""
    known = keys_of(kind)
    stated = {key if known[key].among else known[key].field for key in content}
    wanted = {key if found.among else found.field for key, found in known.items()}
    yield from wanted - stated
    for key, value in content.items():
        how, inner = tables_in(known[key].hint)
        if how is not float and isinstance(value, list | dict):
            yield from (f"{key}.{name}" for name in fields_in(inner, value[0] if isinstance(value, list) else value))


@pytest.mark.parametrize("name", FORMS)
def test_a_form_has_every_key_that_is_read_and_no_other(name):
    kind, filled = FORMS[name]
    content = all_uncommented(blank_form(kind, filled=filled))
    assert not list(fields_in(kind, content))


@pytest.mark.parametrize("name", FORMS)
def test_each_example_of_a_form_is_accepted(name):
    """One key after the other beside those that are filled in: a sheet's of two stiffnesses exclude each other."""
    kind, filled = FORMS[name]
    text = blank_form(kind, filled=filled)
    whole, base = all_uncommented(text), tomllib.loads(text)
    structure(kind, base, Place("form"))
    for key, value in whole.items():
        structure(kind, base | {key: value}, Place("form"))


@pytest.mark.parametrize("unit", ["lbf", "lb"])
def test_the_units_that_the_head_of_a_blank_sheet_names_are_read(tmp_path, unit):
    """1 lbf is 4.4482216152605 N, 1 lb/in is that over 25.4 mm."""
    path = tmp_path / "sheet.toml"
    assert main(["isolators", "blank", str(path)]) == 0
    keys = ["travel_in", "static_load_lbf", "stiffness_lb_per_in"]
    assert all(key in path.read_text(encoding="utf-8").partition("\n\n")[0] for key in keys)
    path.write_text(f'name = "a"\ntravel_in = 1.0\nstatic_load_{unit} = 5.0\nstiffness_lb_per_in = 45.0\n', encoding="utf-8")
    sheet = read_short_sheet(path)
    assert sheet.travel == pytest.approx(0.0254, rel=1e-12)
    assert sheet.static_load == pytest.approx(5.0 * 4.4482216152605, rel=1e-11)  # twelve digits are kept
    assert sheet.stiffness == pytest.approx(45.0 * 4.4482216152605 / 0.0254, rel=1e-11)


def test_a_form_without_an_example_is_a_fault_of_the_class():
    with pytest.raises(TypeError, match="needs an example"):
        blank_form(Place)
    assert all(item.default is MISSING or item.default is not None for item in fields(Place))  # what it is refused for: `file`


def test_the_blank_job_is_simulated_as_it_is(tmp_path, capsys):
    job = tmp_path / "job.toml"
    assert main(["cases", str(job), "--blank"]) == 0
    assert [case.name for case in load_job(job).cases] == ["vertical shock"]
    capsys.readouterr()
    assert "job.toml" in refused(capsys, "cases", job, "--blank")
    assert main(["cases", str(job), "--blank", "--force"]) == 0
    capsys.readouterr()
    assert "--blank" in refused(capsys, "cases", job, "--blank", "--pdf", "--force")


@pytest.mark.parametrize("kind", COLUMNS)
def test_a_blank_table_has_every_column_with_its_meaning(kind):
    lines = blank_table(kind).splitlines()
    needed, further = COLUMNS[kind]
    header = next(csv.reader([line for line in lines if not line.startswith("#")], skipinitialspace=True))
    assert [name.partition(" [")[0] for name in header] == [*needed, *further]
    prose = "\n".join(line for line in lines if line.startswith("#"))
    assert all(name in prose for name in (*needed, *further))
    assert _MEANING[kind].keys() <= {*needed, *further}


def test_blank_tables_make_a_model(tmp_path, capsys):
    tables, model = tmp_path / "tables", tmp_path / "camera"
    assert main(["new", str(tables), "--blank"]) == 0
    assert main(["new", str(model), "--tables", str(tables)]) == 0
    system = wr.load_system(model / "camera.xml")
    assert [name for name, mount in system.mounts.items() if not mount.isolator.is_stop] == ["m1", "m2", "m3", "m4"]
    assert (system.mounts["s1"].isolator.axial.gap_below, system.mounts["s1"].isolator.axial.k) == (0.015, 2e5)
    assert system.model.site("point/lens").pos == pytest.approx([0.06, 0.0, 0.06], abs=1e-12)
    assert float(system.model.body("camera").mass[0]) == pytest.approx(2.4, rel=1e-12)
    capsys.readouterr()
    assert "--blank" in refused(capsys, "new", tables, "--blank", "--name", "other")
    assert "mounts.csv" in refused(capsys, "new", tables, "--blank")
    assert main(["new", str(tables), "--blank", "--force"]) == 0


def test_three_figures_make_an_isolator_with_a_band(tmp_path, capsys):
    sheet, out = tmp_path / "sheet.toml", tmp_path / "isolator.toml"
    assert main(["isolators", "blank", str(sheet)]) == 0
    assert main(["isolators", "fit", str(sheet), str(out)]) == 0
    printed = capsys.readouterr().out
    isolator, stated = wr.load_isolator(out), read_short_sheet(sheet)
    # the three figures, by a cyclic test and by the file
    loop = wr.cyclic_test(isolator.axial, 0.07 * stated.travel)[0]
    assert loop.secant_stiffness == pytest.approx(stated.stiffness, rel=1e-6)  # nine digits of each parameter
    assert loop.damping_ratio == pytest.approx(0.12, rel=1e-6)
    assert isolator.limits.static_load == stated.static_load
    assert isolator.limits.travel.compression == stated.travel
    # what is assumed is said, and marked so, in the file and in the terminal
    assumed = " ".join(isolator.provenance.assumed)
    for text in ("0.43, band 0.34 to 0.55", "0.26, band 0.15 to 0.36", "0.12, band 0.05 to 0.2", "stiffness_of"):
        assert text in assumed
        assert text in " ".join(printed.split())
    assert isolator.geometry is None  # nothing is judged by sizes that nobody stated
    assert isolator.spread.parameters == ("axial.laws[0].c", "axial.laws[1].c")


def test_the_comments_of_the_form_say_what_is_assumed():
    text = blank_form(ShortSheet)
    for name, said in {
        "shock": "0.43 of",
        "shear": "0.26 of",
        "width": "1.2 heights",
        "rope": "0.12 heights",
        "bar": "0.21 heights",
    }.items():
        assert said in text
        assert f"{np.median(ratios()[name]):.2g}" == said.split()[0]
    assert f"{np.median(ratios()['height']):.0f}" == "2"  # twice the travel


@pytest.mark.slow
def test_the_bands_hold_the_parts_of_the_vendors_tables():
    """Nine in ten of them by construction; here of the force at the travel, of every sixteenth part from three figures."""
    inside, parts = [], [part for part in vendor_parts()[::16] if part.modes["compression"].static_load]
    for part in parts:
        stated = part.modes["compression"]
        sheet = ShortSheet(name=part.name, stiffness=stated.vibration, static_load=stated.static_load, travel=stated.travel)
        _, low, high = fit_short(sheet).bands()[-1]
        inside.append(low <= stated.shock * stated.travel <= high)
    assert sum(inside) >= len(inside) - 1


@pytest.mark.slow
@pytest.mark.parametrize("key", ["shock_stiffness", "shear_stiffness", "damping", "height"])
def test_what_a_sheet_states_is_not_assumed(key):
    value = {"shock_stiffness": 3500.0, "shear_stiffness": 2000.0, "damping": 0.15, "height": 0.04}[key]
    fit = fit_short(ShortSheet(name="a", stiffness=8e3, static_load=20.0, travel=0.02, **{key: value}))
    assert key.partition("_")[0] not in fit.assumed
    assert len(fit.assumed) == (3 if key == "height" else 2)
    assert (fit.isolator.geometry is not None) == (key == "height")


def test_a_damping_that_no_law_has_with_the_usual_friction_moves_the_shock_stiffness():
    """With 0.43 of the stiffness at the travel, rope friction loses more than 7 %."""
    fit = fit_short(ShortSheet(name="a", stiffness=8e3, static_load=20.0, travel=0.02, damping=0.07))
    assert fit.assumed["shock"].value > 0.45
    assert wr.cyclic_test(fit.isolator.axial, 1.4e-3)[0].damping_ratio == pytest.approx(0.07, rel=1e-6)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("travel_mm = 0", "`travel_mm`"), ("travel_mm = -20", "`travel_mm`"), ("travl_mm = 20", "Did you mean `travel_mm`"),
        ("travel_mm = 20\nshock_stiffness_N_per_mm = 9", "secants"), ("travel_mm = 20\ndamping = 0.9", "damping ratio"),
        ('travel_mm = 20\nstiffness_of = "shock"\nshock_stiffness_N_per_mm = 3', "leave one of them out"),
        ("travel_mm = 20\nheight_mm = 15", "`travel` of 20 mm in compression must be at most the"),
        ("travel_mm = 40\nheight_mm = 30\nbar_mm = 5", "20 mm between the bars, `height` of 30 mm less twice `bar` of 5 mm"),
        ("travel_mm = 20\nheight_mm = 36\nbar_mm = 5\nwidth_mm = 20", "the rope is taut"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_sheet_is_one_message_that_names_it(tmp_path, capsys, line, said):
    sheet = tmp_path / "sheet.toml"
    sheet.write_text(f'name = "a"\nstiffness_N_per_mm = 8\nstatic_load_N = 20\n{line}\n', encoding="utf-8")
    message = refused(capsys, "isolators", "fit", sheet, tmp_path / "out.toml")
    assert said in message
    assert "sheet.toml" in message


@pytest.mark.slow
def test_a_camera_on_four_mounts_of_three_figures_goes_through_random_vibration_in_six_commands(tmp_path, monkeypatch):
    """From a blank sheet to the rms on three axes and the isolation frequency, and along z beside SciPy's integration."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rv.csv").write_text("frequency [Hz], psd [g^2/Hz]\n10, 0.01\n100, 0.01\n300, 0.001\n", encoding="utf-8")
    commands = [
        ["isolators", "blank", "sheet.toml"],  # figures: 8 N/mm, 20 N, 20 mm
        ["isolators", "fit", "sheet.toml", "isolator.toml"],
        ["new", "tables", "--blank"],  # 2.4 kg on four mounts
        ["new", "camera", "--tables", "tables"],
        ["shock", "camera/camera.xml", "--psd", "rv.csv 3 s xyz seed 1", "--out", "run"],
        ["frf", "camera/camera.xml", "--acceleration-g", "0.5", "--start", "8", "--stop", "40", "--out", "frf"],
    ]
    for command in commands:
        assert main(command) == 0
        if command[0] == "new" and "--blank" in command:  # the isolator is that of the sheet
            table = tmp_path / "tables" / "mounts.csv"
            table.write_text(table.read_text(encoding="utf-8").replace("WR2-800", "../isolator.toml"), encoding="utf-8")
    run = wr.load_response(tmp_path / "run")
    assert all(np.std(run.bodies["camera"].acceleration[:, axis]) > 0.0 for axis in range(3))

    system, motion = wr.load_system("camera/camera.xml"), motion_from_phrase("psd", "rv.csv 3 s z seed 1")
    alone = wr.simulate(system, motion, duration=3.0, initial="unloaded", sample_rate=4000.0, accuracy=1e-5)
    law, mass = wr.load_isolator("isolator.toml").axial.laws, 2.4
    fine = np.arange(0.0, 3.0, 1.0 / 40000.0)
    base = CubicSpline(fine, motion.acceleration(fine)[:, 2])

    def rates(t, state):
        x, v, *z = state
        force = sum(np.exp(one.c * x) * (zi + one.k1 * x + one.k3 * x**3) for one, zi in zip(law, z, strict=True))
        slips = [one.alpha * v - one.beta * abs(v) * abs(zi) * zi for one, zi in zip(law, z, strict=True)]  # n = 2, gamma = 0
        return [v, -4.0 * force / mass - 9.80665 - float(base(t)), *slips]

    found = solve_ivp(rates, (0.0, 3.0), np.zeros(4), rtol=1e-7, atol=1e-9, t_eval=alone.time[:-1], max_step=1e-3)
    deflection = alone.mounts["m1"].deflection[:-1, 2]
    # both integrate a force with corners; 1e-5 of the peaks is the step's own accuracy
    assert np.abs(found.y[0] - deflection).max() < 1e-3 * np.abs(deflection).max()
