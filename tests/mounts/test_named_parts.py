"""Every part of the vendors' tables by its name, in Python and in every command, fitted when it is asked for."""

import json
import re

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.mounts.vendor_parts import find_isolator, law_values, shipped_file, vendor_parts

FITTED = [part for part in vendor_parts() if shipped_file(part) is None and part.height is not None]


@pytest.mark.slow
@pytest.mark.parametrize("part", FITTED, ids=lambda part: part.name)
def test_a_part_has_the_shock_stiffness_and_the_ratings_of_its_row(part):
    isolator = wr.load_isolator(part.name)
    stated = part.modes["compression"]
    assert isolator.name == part.name
    assert isolator.limits.static_load == stated.static_load
    assert isolator.limits.travel.compression == stated.travel
    # a virgin path to the rated travel, by the law's own integration; the fit shows nine digits
    shock = -law_values.virgin_force(isolator.axial, -stated.travel) / stated.travel
    assert shock == pytest.approx(stated.shock, rel=1e-7)


def test_a_name_is_a_file_first_then_the_catalogue_then_a_row(here):
    assert find_isolator("cb1500-30").name == "CB1500-30"
    assert find_isolator("CB1400-30").stem == "socitec_cb1400_30"
    wr.load_isolator("enidine_wr16_400").save(here / "CB1500-30.toml")
    assert wr.load_isolator("CB1500-30").name == "Enidine WR16-400"


def test_a_part_of_which_too_little_is_stated_says_what(here):
    with pytest.raises(wr.ModelError, match=r"WR36-200: the table does not state its height"):
        wr.load_isolator("WR36-200")


def test_a_slip_is_answered_with_the_nearest_names():
    with pytest.raises(wr.ModelError, match=r"Nearest: .*CB1500-30"):
        wr.load_isolator("CB1500-3")


def test_a_model_names_a_part_where_a_file_stands_otherwise():
    mjcf = (
        '<mujoco><option gravity="0 0 -9.80665" integrator="RK4"/><worldbody>'
        '<body name="deck"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="10"/><site name="b"/></body>'
        '<body name="box"><joint type="slide" axis="0 0 1"/><geom size=".1" mass="300" contype="0" conaffinity="0"/>'
        '<site name="p"/></body></worldbody><custom><text name="isolator/i" data="CB1500-30"/><tuple name="mount/m">'
        '<element objtype="site" objname="p"/><element objtype="site" objname="b"/>'
        '<element objtype="text" objname="isolator/i"/></tuple></custom></mujoco>'
    )
    system = wr.load_system(mjcf)
    mount = wr.equilibrium(system).mounts["m"]
    assert system.mounts["m"].isolator == wr.load_isolator("CB1500-30")
    assert mount.force[2] == pytest.approx(-300 * wr.STANDARD_GRAVITY, rel=1e-9)


def test_the_list_names_every_part_and_where_it_is_from(capsys):
    assert main(["isolators", "--all"]) == 0
    lines = capsys.readouterr().out.splitlines()
    for part in vendor_parts():
        row = next(line for line in lines if line.split()[:1] == [part.name])
        made = "shipped" if shipped_file(part) else "fitted" if part.height else "-"
        assert row.rstrip().endswith(made)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mass", "shock", "travel"), [(600.0, "15 g 11 ms half-sine", 0.06), (40.0, "20 g 11 ms half-sine", 0.04)]
)
def test_the_part_that_a_selection_ranks_first_is_shaken_in_two_more_commands(here, capsys, mass, shock, travel):
    options = ["--mass", f"{mass}", "--mounts", "4", "--shock", shock, "--travel", f"{1e3 * travel:g}"]
    assert main(["select", *options]) == 0
    name = re.search(r"first by \w+: 4 (\S+),", capsys.readouterr().out)[1]
    part = next(one for one in vendor_parts() if one.name == name)
    feet = [f"m{2 * i + j + 1}, {600 * i - 300}, {600 * j - 300}, 100, {name}" for i, j in np.ndindex(2, 2)]
    (here / "mounts.csv").write_text("\n".join(["name, x [mm], y [mm], z [mm], isolator", *feet]))
    columns = "name, mass [kg], x [mm], y [mm], z [mm], size_x [mm], size_y [mm], size_z [mm]"
    (here / "masses.csv").write_text(f"{columns}\nbox, {mass}, 0, 0, 300, 600, 600, 400\n")
    assert main(["new", "box", "--mounts", "mounts.csv", "--masses", "masses.csv"]) == 0
    assert (here / "box" / "isolators" / f"{shipped_file(part) or name}.toml").exists()
    words = shock.removesuffix(" half-sine") + " z"
    assert main(["shock", "box/box.xml", "--half-sine", words, "--out", "run"]) in (0, 1)  # 1: a limit is exceeded
    verdicts = json.loads((here / "run" / "summary.json").read_text())["judged"]
    judged = [one for one in verdicts if one["subject"] == "m1"]
    assert any(one["limit"] == part.modes["compression"].travel for one in judged)
