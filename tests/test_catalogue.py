"""Every figure that a catalogue file states is found again in the file's own laws."""

import math
import subprocess
import sys
from functools import cache

import numpy as np
import pytest
from numba import njit

from wirerope_mj.bench import cyclic_test
from wirerope_mj.errors import ConvergenceError, ModelError
from wirerope_mj.identification.datasheet import compare, fit_datasheet, main
from wirerope_mj.identification.figures import relaxed_force, relaxed_stiffness
from wirerope_mj.identification.shapes import Points, Stiffnesses, fit_points, fit_stiffnesses
from wirerope_mj.identification.vendor import read_datasheet
from wirerope_mj.isolator import load_isolator
from wirerope_mj.laws.kernels import asymmetric_bouc_wen
from wirerope_mj.resources import catalogue_folder
from wirerope_mj.units import STANDARD_GRAVITY

FILES = {path.stem: path for path in sorted(catalogue_folder().glob("*.toml"))}
SHEETS = {path.stem: path for path in sorted((catalogue_folder() / "datasheets").glob("*.toml"))}

# Vendor figures typed here once more in SI units, so that neither a data sheet nor a file can drift unseen:
# compression travel, Kv, Ks; shear travel, Kv, Ks; static load; damping range.
STIFFNESS = {
    "enidine_wr12_400": (0.0401, 242e3, 110e3, 0.0422, 77e3, 77e3, 1068.0, (0.05, 0.15)),
    "enidine_wr16_400": (0.0432, 613e3, 278e3, 0.0452, 173e3, 173e3, 2869.0, (0.05, 0.15)),
    "enidine_wr16_700": (0.0599, 340e3, 137e3, 0.0569, 81e3, 81e3, 1957.0, (0.05, 0.15)),
    "enidine_wr20_600": (0.0495, 821e3, 356e3, 0.0521, 215e3, 215e3, 4204.0, (0.05, 0.15)),
    "socitec_cb1400_15": (0.03556, 1142703.0, 464086.0, 0.04064, 258312.0, 189137.0, 4160.0, (0.15, 0.20)),
}
# Static force and deflection, shock force and deflection, resonance; compression, then shear and roll.
POINTS = {
    "socitec_cb1390_20": ((2820.0, 0.0068, 8460.0, 0.036, 6.0), (1410.0, 0.0096, 6740.0, 0.032, 6.5)),
    "socitec_cb1390_30": ((1980.0, 0.0073, 5960.0, 0.039, 6.2), (994.0, 0.0104, 5730.0, 0.042, 5.9)),
}
# 45 degrees: travel, Kv, Ks of the vendor and the relative errors of the fitted axes as the files state them.
DIAGONAL = {
    "enidine_wr12_400": (0.0559, 159e3, 65e3, 0.003, 0.415),
    "enidine_wr16_400": (0.0610, 349e3, 138e3, 0.126, 0.613),
    "enidine_wr16_700": (0.0848, 193e3, 68e3, 0.091, 0.629),
    "enidine_wr20_600": (0.0711, 468e3, 177e3, 0.107, 0.592),
}
# The files hold nine digits and the damping search stops at 1e-13 of a share: 1e-6 is far above both.
EXACT = 1e-6


@cache
def isolator(name):
    return load_isolator(FILES[name])


def force_at(law, deflection):
    """Force on the first loading."""
    return law.trace([0.0, deflection]).force[-1]


def relaxed_sag(law, load, travel):
    """Deflection < 0 at which the law with z = 0 carries the load, by bisection."""
    low, high = -travel, 0.0
    for _ in range(60):
        middle = (low + high) / 2.0
        low, high = (middle, high) if relaxed_force(law, middle) < -load else (low, middle)
    return middle


def test_catalogue_has_the_parts_that_the_models_use():
    assert set(FILES) >= set(STIFFNESS) | set(POINTS) | {"rubber_horizontal", "sdof_36hz"}
    assert set(SHEETS) == set(STIFFNESS) | set(POINTS)


@pytest.mark.parametrize("name", FILES)
def test_file_loads_and_says_where_it_comes_from(name):
    provenance = isolator(name).provenance
    assert provenance.source
    assert provenance.fitted_to
    assert provenance.assumed
    assert provenance.kind == ("catalogue" if name in SHEETS else "illustrative")


@pytest.mark.parametrize("name", SHEETS)
def test_file_is_what_its_data_sheet_gives(name):
    assert fit_datasheet(SHEETS[name]).to_dict() == isolator(name).to_dict()


@pytest.mark.parametrize("name", STIFFNESS)
def test_tangent_at_the_origin_is_the_vibration_stiffness(name):
    part = isolator(name)
    _, axial, _, _, shear, _, _, _ = STIFFNESS[name]
    for law, expected in ((part.axial, axial), (part.shear, shear), (part.roll, shear)):
        h = 1e-9  # softening over the step is h / x_y = 1e-7 of the slope
        assert (force_at(law, h) - force_at(law, -h)) / (2.0 * h) == pytest.approx(expected, rel=1e-6)
        assert law.initial_stiffness == pytest.approx(expected, rel=EXACT)


@pytest.mark.parametrize("name", STIFFNESS)
def test_secant_at_the_rated_travel_is_the_shock_stiffness(name):
    part = isolator(name)
    compression, _, axial, travel, _, shear, _, _ = STIFFNESS[name]
    assert -force_at(part.axial, -compression) / compression == pytest.approx(axial, rel=EXACT)
    for law in (part.shear, part.roll):
        assert force_at(law, travel) / travel == pytest.approx(shear, rel=EXACT)
        assert -force_at(law, -travel) / travel == pytest.approx(shear, rel=EXACT)


@pytest.mark.parametrize("name", STIFFNESS)
def test_damping_ratio_at_half_the_travel_lies_inside_the_vendors_range(name):
    part = isolator(name)
    compression, _, _, travel, _, _, _, (lowest, highest) = STIFFNESS[name]
    stated = read_datasheet(SHEETS[name]).damping
    for law, rated in ((part.axial, compression), (part.shear, travel), (part.roll, travel)):
        ratio = cyclic_test(law, rated / 2.0)[0].damping_ratio
        assert lowest < ratio < highest
        assert ratio == pytest.approx(stated, rel=EXACT)


@pytest.mark.parametrize("name", SHEETS)
def test_tension_is_stiffer_than_compression_by_the_assumed_ratio(name):
    part = isolator(name)
    travel = part.limits.travel.compression
    ratio = force_at(part.axial, travel) / -force_at(part.axial, -travel)
    assert 1.2 <= ratio <= 2.0
    assert ratio == pytest.approx(read_datasheet(SHEETS[name]).tension_ratio, rel=EXACT)
    assert any("sets c ln b" in sentence for sentence in part.provenance.assumed)


@pytest.mark.parametrize("name", POINTS)
def test_force_deflection_points_are_met(name):
    part = isolator(name)
    for law, stated in zip((part.axial, part.shear), POINTS[name], strict=True):
        static, deflection, shock, travel, _ = stated
        assert -force_at(law, -deflection) == pytest.approx(static, rel=EXACT)
        assert -force_at(law, -travel) == pytest.approx(shock, rel=EXACT)
    assert part.roll == part.shear


@pytest.mark.parametrize("name", POINTS)
def test_small_vibration_about_the_relaxed_sag_has_the_stated_resonance(name):
    part = isolator(name)
    for law, stated in zip((part.axial, part.shear), POINTS[name], strict=True):
        static, _, _, travel, frequency = stated
        stiffness = relaxed_stiffness(law, relaxed_sag(law, static, travel))
        found = math.sqrt(stiffness * STANDARD_GRAVITY / static) / (2.0 * math.pi)
        assert found == pytest.approx(frequency, rel=EXACT)


@pytest.mark.parametrize("name", SHEETS)
def test_both_sags_under_the_rated_load_stay_within_the_rated_travel(name):
    part = isolator(name)
    load, travel = part.limits.static_load, part.limits.travel.compression
    depths = np.linspace(0.0, travel, 4001)
    virgin = np.interp(load, -part.axial.trace(-depths).force, depths)
    relaxed = -relaxed_sag(part.axial, load, travel)
    # Long vibration lets z relax: 1.7 to 3 times the virgin sag, and still below half of the rated travel.
    assert 1.7 < relaxed / virgin < 3.0
    assert relaxed < travel / 2.0


@pytest.mark.parametrize("name", SHEETS)
def test_force_grows_with_deflection_all_over_the_rated_travel(name):
    part = isolator(name)
    for axis, law in part.axes.items():
        travel = max(value for value in part.rated_travel(axis) if value is not None)
        for sign in (-1.0, 1.0):
            path = sign * np.linspace(0.0, travel, 200)
            assert (np.diff(sign * law.trace(path).force) > 0.0).all()
            assert (np.diff([sign * relaxed_force(law, x) for x in path]) > 0.0).all()


@pytest.mark.parametrize("name", DIAGONAL)
def test_stiffness_at_45_degrees_comes_out_with_the_stated_error(name):
    part = isolator(name)
    travel, vibration, shock, vibration_error, shock_error = DIAGONAL[name]
    share = math.sqrt(0.5)

    def along(deflection):
        return share * (force_at(part.roll, share * deflection) - force_at(part.axial, -share * deflection))

    tangent = along(1e-9) / 1e-9
    secant = along(travel) / travel
    assert tangent / vibration - 1.0 == pytest.approx(vibration_error, abs=6e-4)  # three decimals above
    assert secant / shock - 1.0 == pytest.approx(shock_error, abs=6e-4)
    stated = part.provenance.check_45
    assert stated["vibration_stiffness_relative_error"] == pytest.approx(tangent / vibration - 1.0, abs=6e-5)
    assert stated["shock_stiffness_relative_error"] == pytest.approx(secant / shock - 1.0, abs=6e-5)


@pytest.mark.parametrize(
    ("name", "static", "deflection", "shock", "travel", "frequency"),
    [
        ("socitec_cb1390_20", 2110.0, 0.0096, 5470.0, 0.055, 5.2),
        ("socitec_cb1390_30", 1490.0, 0.0117, 3990.0, 0.059, 5.2),
    ],
)
def test_points_at_45_degrees_come_out_with_the_stated_error(name, static, deflection, shock, travel, frequency):
    part = isolator(name)
    share = math.sqrt(0.5)

    def along(depth, force=force_at):
        return share * (force(part.roll, share * depth) - force(part.axial, -share * depth))

    stated = part.provenance.check_45
    assert stated["static_force_relative_error"] == pytest.approx(along(deflection) / static - 1.0, abs=6e-5)
    assert stated["shock_force_relative_error"] == pytest.approx(along(travel) / shock - 1.0, abs=6e-5)
    depths = np.linspace(0.0, travel, 8001)
    sag = np.interp(static, [along(depth, relaxed_force) for depth in depths], depths) * share
    stiffness = (relaxed_stiffness(part.axial, -sag) + relaxed_stiffness(part.roll, sag)) / 2.0
    found = math.sqrt(stiffness * STANDARD_GRAVITY / static) / (2.0 * math.pi)
    assert stated["resonance_relative_error"] == pytest.approx(found / frequency - 1.0, abs=6e-5)


def test_shear_softens_first_and_hardens_later():
    law = isolator("enidine_wr16_400").shear
    secants = [loop.secant_stiffness for loop in cyclic_test(law, [0.0005, 0.015, 0.045])]
    assert secants[1] < 0.9 * secants[0]
    assert secants[2] > 1.1 * secants[1]


def test_rubber_has_its_stated_frequency_and_loss_factor_and_no_axial_force():
    part = isolator("rubber_horizontal")
    assert part.axial is None
    assert part.roll == part.shear
    omega = math.sqrt(part.roll.k / 500.0)
    assert omega / (2.0 * math.pi) == pytest.approx(6.0, rel=1e-5)  # k is written with six digits
    assert omega * part.roll.c / part.roll.k == pytest.approx(0.15, rel=1e-5)


@njit
def steady_peak(p, mass, frequency, amplitude, cycles, steps):
    """Largest |absolute acceleration| [m/s^2] in the last cycle of a base sine, classical Runge-Kutta from rest."""
    h, omega = 1.0 / (frequency * steps), 2.0 * math.pi * frequency
    y, zdot, z, k = np.zeros(3), np.zeros(1), np.zeros(1), np.zeros((4, 3))
    largest = 0.0
    for step in range(cycles * steps):
        for stage in range(4):
            share = 0.0 if stage == 0 else (1.0 if stage == 3 else 0.5)
            state = y + share * h * k[stage - 1] if stage > 0 else y
            z[0] = state[2]
            force = asymmetric_bouc_wen(p, 0, state[0], state[1], z, 0, zdot, 0)
            base = amplitude * math.sin(omega * (step + share) * h)
            k[stage] = np.array([state[1], -force / mass - 9.80665 - base, zdot[0]])
            if stage == 0 and step >= (cycles - 1) * steps:
                largest = max(largest, abs(force / mass + 9.80665))
        y = y + h / 6.0 * (k[0] + 2.0 * k[1] + 2.0 * k[2] + k[3])
    return largest


def resonance(law, level, frequencies):
    """Frequency [Hz] of the largest peak, refined by the parabola through its neighbours, and the peak."""
    p = law.kernel_parameters()
    # 150 cycles at a damping ratio of 6 % and more leave exp(-50) of the start; 200 steps a cycle hold h^4.
    peaks = np.array([steady_peak(p, 3.5, f, level * STANDARD_GRAVITY, 150, 200) for f in frequencies])
    top = int(np.argmax(peaks))
    assert 0 < top < len(peaks) - 1
    bend, slope, _ = np.polyfit(frequencies[top - 1 : top + 2] - frequencies[top], peaks[top - 1 : top + 2], 2)
    return frequencies[top] - slope / (2.0 * bend), peaks[top]


def test_shaker_isolator_resonates_at_36_2_hz_at_half_a_g():
    law = isolator("sdof_36hz").axial
    frequency, peak = resonance(law, 0.5, np.arange(35.4, 37.1, 0.2))
    # The parabola on a grid of 0.2 Hz finds the peak within a few hundredths.
    assert frequency == pytest.approx(36.2, abs=0.05)
    assert 4.0 < peak / (0.5 * STANDARD_GRAVITY) < 8.0


def test_shaker_resonance_moves_left_as_the_level_rises():
    law = isolator("sdof_36hz").axial
    weak, _ = resonance(law, 0.25, np.arange(36.8, 38.5, 0.2))
    strong, _ = resonance(law, 1.0, np.arange(32.4, 34.1, 0.2))
    assert weak == pytest.approx(37.6, abs=0.1)  # as the file states
    assert strong == pytest.approx(33.2, abs=0.1)


@pytest.mark.parametrize("ratio", [None, 1.5])
@pytest.mark.parametrize("shock", [300e3, 700e3])
def test_any_pair_of_stiffnesses_is_fitted_softening_or_hardening(shock, ratio):
    stated = Stiffnesses(travel=0.04, vibration=600e3, shock=shock, damping=0.08)
    law = fit_stiffnesses(stated, ratio)
    assert law.initial_stiffness == pytest.approx(600e3, rel=EXACT)
    assert -force_at(law, -0.04) / 0.04 == pytest.approx(shock, rel=EXACT)
    assert cyclic_test(law, 0.02)[0].damping_ratio == pytest.approx(0.08, rel=EXACT)


def test_damping_out_of_reach_is_said_with_what_can_be_reached():
    stated = Stiffnesses(travel=0.04, vibration=600e3, shock=300e3, damping=0.6)
    with pytest.raises(ConvergenceError, match=r"damping ratio of 0\.6 .* damping ratios reach 0\.\d+ to 0\.\d+"):
        fit_stiffnesses(stated, 1.5)


def test_conflicting_points_are_said_with_their_distance():
    stated = Points(static_force=2820.0, static_deflection=0.0068, shock_force=8460.0, travel=0.036, resonance=3.0)
    with pytest.raises(ConvergenceError, match=r"has 3 Hz.*nearest misses that stiffness by \d+"):
        fit_points(stated, 1.5)


def test_command_writes_the_file_and_prints_the_table(tmp_path):
    name = "enidine_wr12_400"
    command = [sys.executable, "-m", "wirerope_mj.identification.datasheet", SHEETS[name], tmp_path / "a.toml"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert load_isolator(tmp_path / "a.toml") == isolator(name)
    assert "45 degrees   shock stiffness" in done.stdout
    assert "+41.46 %" in done.stdout
    assert not done.stderr


def test_table_judges_any_isolator_against_a_sheet():
    rows = compare(SHEETS["enidine_wr12_400"], isolator("enidine_wr16_400"))
    shock = next(row for row in rows if row.name == "shock stiffness")
    assert shock.vendor == pytest.approx(110.0)
    assert shock.error > 0.5  # a far stiffer mount


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("travel_mm = 40.1", "", r"\[compression\] `travel_mm` or `travel_in` is missing"),
        ("travel_mm = 40.1", "travel_mm = -40.1", r"\[compression\] `travel_mm` must be a finite number > 0"),
        ("travel_mm = 40.1", "travel_mm = true", r"\[compression\] `travel_mm` must be a finite number > 0"),
        ("travel_mm = 40.1", "travel_mm = 40.1\ncolour = 1", r"\[compression\] `colour` is not known"),
        ("damping_target = 0.11", "", r"`damping_target` is missing: two stiffnesses do not fix"),
        ("damping_target = 0.11", "damping_target = 0.4", r"`damping_target` must lie in the range"),
        ("[shear]", "[sheer]", r"the table \[shear\] is missing"),
        ('name = "Enidine WR12-400"', "name = 12", r"`name` must be a string, got 12"),
        ("[compression]", "[compression", r"not valid TOML: .*line"),
    ],
)
def test_wrong_data_sheet_is_named_with_table_key_and_rule(tmp_path, capsys, old, new, message):
    text = SHEETS["enidine_wr12_400"].read_text()
    assert old in text
    sheet, out = tmp_path / "sheet.toml", tmp_path / "out.toml"
    sheet.write_text(text.replace(old, new, 1))
    with pytest.raises(ModelError, match=message):
        fit_datasheet(sheet)
    assert main([str(sheet), str(out)]) == 2
    assert capsys.readouterr().err.startswith(str(sheet))
    assert not out.exists()
