"""docs/cabinet.md: its numbers are those of its script, and what it names as causes are the causes."""

import dataclasses
import re
import runpy
from pathlib import Path

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.foundation.resources import catalogue_folder

pytestmark = pytest.mark.slow  # the script of the page fits a sheet and shakes its rack

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/cabinet.md").read_text(encoding="utf-8")
TABLES = runpy.run_path(str(ROOT / "docs/page_tables.py"))

# Socitec's sheet of the rack as it was transcribed: sag [mm], modes [Hz], displacements [mm], accelerations [g].
SHEET = [0.613, 10.42, 6.98, 11.68, 15.89, 20.79, 15.22, 7.05, 5.96, 7.17]


@pytest.fixture(scope="module")
def page():
    """Return the names that the page's script leaves behind."""
    return TABLES["computed"](PAGE)


@pytest.fixture(scope="module")
def along_x(page):
    """Return displacement [mm] and acceleration [g], both senses, travels below and behind [mm] and pitch by case."""
    names = ("model", "smooth", "pitch", "upright", "upright, smooth")
    return dict(zip(names, np.array(page["along_x"][1:]), strict=True))


def test_the_tables_are_what_the_script_computes(page):
    assert TABLES["rewritten"](PAGE, page["tables"]) == PAGE


def test_the_sheet_is_written_as_it_was_transcribed(page):
    np.testing.assert_array_equal([row[0] for row in page["rack"]][:10], SHEET)
    assert page["along_x"][0] == (SHEET[4], SHEET[7])
    assert [row[0] for row in page["others"]] == [1.4, 18.1, 7.4, 10.5, 1.2, 19.5, 8.1, 11.3]


def test_all_else_is_equal(page):
    """The rack upright has the free rack's mass, mounts, places and laws, and three coordinates instead of six."""
    free, upright = page["model"], page["upright"]
    assert free.model.nv - upright.model.nv == 3
    np.testing.assert_array_equal(free.model.body_mass, upright.model.body_mass)
    np.testing.assert_array_equal(free.model.site_pos, upright.model.site_pos)
    assert {n: m.isolator for n, m in free.mounts.items()} == {n: m.isolator for n, m in upright.mounts.items()}


def test_without_friction_a_mount_loads_the_same_and_loses_next_to_nothing(page):
    isolator = page["single"]["cb1400_15"]
    smooth = page["frictionless"]["cb1400_15"]
    for axis in ("axial", "shear", "roll"):
        rope, bare = getattr(isolator, axis), getattr(smooth, axis)
        path = np.linspace(0.0, -0.02, 21)
        np.testing.assert_allclose(bare.trace(path).force, rope.trace(path).force, rtol=1e-9)
        kept, lost = (wr.cyclic_test(law, [0.0125])[0].dissipated_energy for law in (bare, rope))
        # The trace of beta counts once the rest to the bound is as small: the finer scale, a ninth of the friction, reaches
        # its bound to rounding and stays there when the mount turns.
        assert 0.0 <= kept < 0.12 * lost


def test_what_is_left_of_the_friction_does_not_matter(page):
    """A trace of beta a thousand times as large gives the same first swing to 1 %: the finer scale leaves its bound earlier."""
    more = page["guided"](page["free"], {
        name: dataclasses.replace(part, **{
            axis: wr.Parallel(laws=[dataclasses.replace(law, beta=1e3 * law.beta) for law in getattr(part, axis).laws])
            for axis in ("axial", "shear", "roll")
        })
        for name, part in page["frictionless"].items()
    })  # fmt: skip
    np.testing.assert_allclose(page["shock"](more, 0)[:2], page["along_x"][2][:2], rtol=1e-2)


def test_the_first_swing_is_the_largest(page):
    """Of all shocks of the first table, by the run's own peaks over half a second; the samples miss 1e-3 of a peak."""
    for system, column in ((page["model"], 1), (page["upright"], 3)):
        for axis in range(3):
            largest, farthest = 0.0, 0.0
            for sense in (1, -1) if axis == 0 else (1,):
                step = wr.VelocityStep(velocity=sense * page["velocity"], direction="xyz"[axis])
                response = wr.simulate(system, step, duration=0.5, timestep=5e-5)
                peak = response.peaks.bodies["rack"].acceleration
                largest = max(largest, peak.maximum[axis], -peak.minimum[axis])
                moved = (response.bodies["rack"].position - response.base.displacement)[:, axis]
                farthest = max(farthest, 1e3 * np.abs(moved - moved[0]).max())
            assert page["rack"][7 + axis][column] == pytest.approx(largest / wr.STANDARD_GRAVITY, rel=1e-3)
            assert page["rack"][4 + axis][column] == pytest.approx(farthest, rel=1e-3)


def test_pitch_alone_makes_the_free_rack_of_the_upright_one(along_x):
    """Three slides and a hinge about y leave 1 % of any peak open, and the rack upright misses most by more than that."""
    free, pitch, upright = along_x["model"], along_x["pitch"], along_x["upright"]
    np.testing.assert_allclose(pitch[:4], free[:4], rtol=0.01)
    np.testing.assert_allclose(pitch[6], free[6], rtol=0.01)
    assert (np.abs(upright[:4] / free[:4] - 1.0) > 0.02).all()
    assert upright[6] == 0.0


def test_pitch_changes_more_than_damping_does(along_x):
    """Displacement and acceleration, forwards and backwards: the same friction and no pitch, the same pitch and no friction."""
    by_pitch = np.abs(along_x["upright"] - along_x["model"])[:4]
    by_damping = np.abs(along_x["smooth"] - along_x["model"])[:4]
    assert (by_pitch > by_damping).all()


def test_translations_meet_the_sheet_within_a_tenth(page):
    """Nine of the rack, and its sag within 0.1 mm; of the two others sag, y and z by the secant and by the first harmonic."""
    assert np.abs([row[4] for row in page["rack"][1:10]]).max() < 10.0
    assert abs(page["rack"][0][3] - page["rack"][0][0]) < 0.1
    secant, harmonic = (np.array(page["others"])[[0, 2, 3, 4, 6, 7], column] for column in (2, 4))
    assert np.abs(secant).max() < 10.0
    assert np.abs(harmonic).max() < 10.0


def test_what_the_page_calls_fitted_is_what_the_file_was_fitted_to():
    """The rack's mode and shock along y, on ten mounts in shear; nothing else of the sheet."""
    stated = wr.load_isolator(catalogue_folder() / "socitec_cb1400_15.toml").provenance.fitted_to
    force = 850.0 * SHEET[8] * wr.STANDARD_GRAVITY / 10.0
    stiffness = 850.0 * (2.0 * np.pi * SHEET[2]) ** 2 / 10.0
    assert f"{SHEET[5]:g} mm {force:.0f} N" in stated
    assert f"{1e-3 * stiffness:.1f} N/mm" in stated
    for value in (0.613, 10.42, 11.68, 15.89, 15.22, 7.05, 7.17):
        assert str(value) not in stated


def test_upright_the_same_friction_meets_the_vendor(page):
    """Within a tenth along x; free to pitch, the acceleration is not."""
    displacement, acceleration = page["rack"][4], page["rack"][7]
    for value in (displacement[4], acceleration[4]):
        assert abs(value) < 10.0
    assert acceleration[2] < -10.0


def test_upright_the_first_swing_knows_no_friction(along_x):
    # Up to its peak, a loading from zero across the sag; 1e-4 is the integration's error.
    np.testing.assert_allclose(along_x["upright, smooth"][:4], along_x["upright"][:4], rtol=1e-4)


def test_the_foot_swings_out_and_the_top_does_not(along_x):
    free = along_x["model"]
    displacement, below, behind = free[0], free[4], free[5]
    assert below > 1.3 * displacement > displacement > 1.3 * behind


def test_the_stabilisers_turn_before_the_centre_of_mass(page):
    """What friction takes in the free rack it takes after that."""
    step = wr.VelocityStep(velocity=page["velocity"], direction="x")
    response = wr.simulate(page["model"], step, duration=0.06, timestep=2e-5, sample_rate=5000.0)
    centre = (response.bodies["rack"].position - response.base.displacement)[:, 0]
    behind = response.mounts["s2"].deflection[:, 2]
    assert response.time[behind.argmin()] < response.time[centre.argmin()] - 0.005  # 8 ms of a quarter period of 25


def test_stiffness_sits_above_the_centre_of_mass(page):
    """Four stabilisers along their axis against six mounts in roll, about the heights that the page states."""
    found = page["model"].mounts
    isolator = found["s1"].isolator
    axial, roll = (wr.cyclic_test(getattr(isolator, a), [0.0125])[0].secant_stiffness for a in ("axial", "roll"))
    body = page["model"].model.body("rack")
    centre = body.pos[2] + body.ipos[2]  # as modelled, before it sags
    above, below = found["s1"].position[2] - centre, centre - found["m01"].position[2]
    assert [f"{above:.2f}", f"{below:.2f}"] == re.findall(r"(0\.\d\d) m (?:above|below)", PAGE.replace("\n  ", " "))
    assert 4.0 * axial > 6.0 * roll
    assert 4.0 * axial * above > 6.0 * roll * below


def test_a_shock_that_stretches_first_moves_less_and_shakes_more(page):
    rows = np.array(page["rack"])
    for column in (1, 3):
        assert rows[10, column] < rows[6, column]
        assert rows[11, column] > rows[9, column]


def test_along_z_the_other_racks_are_stiffer_than_along_x(page):
    """More mounts on their axis: translations cannot have x above z, as the sheets have it."""
    rows = np.array(page["others"])
    for x, z in ((1, 3), (5, 7)):
        assert (rows[x, [1, 3]] < rows[z, [1, 3]]).all()
        assert rows[x, 0] > 1.5 * rows[z, 0]


def test_tables_of_another_shape_are_refused():
    page = "| a | b |\n|---|---|\n| x | +1.00 |"
    assert TABLES["rewritten"](page, [[(-2.346,)]]).endswith("| x | -2.35 |")
    assert TABLES["rewritten"](page, [[(-1e-9,)]]).endswith("| x | +0.00 |")
    with pytest.raises(ValueError, match="fewer numbers"):
        TABLES["rewritten"](page, [[()]])
    with pytest.raises(ValueError, match="1 more numbers"):
        TABLES["rewritten"](page, [[(1.0, 2.0)]])
    with pytest.raises(ValueError, match="no computed row"):
        TABLES["rewritten"](page, [[]])
    with pytest.raises(ValueError, match="1 tables, 2 were computed"):
        TABLES["rewritten"](page, [[(1.0,)], []])
