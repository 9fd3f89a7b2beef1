"""Every figure that a catalogue file states is found again in the file's own laws."""

import math
import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numba import njit

from wirerope_mj.cli import main
from wirerope_mj.foundation.errors import ConvergenceError, ModelError
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.foundation.units import STANDARD_GRAVITY
from wirerope_mj.mounts.laws.registry import asymmetric_bouc_wen
from wirerope_mj.mounts.rope_loop import RopeLoop
from wirerope_mj.mounts.test_rig import cyclic_test
from wirerope_mj.mounts.vendor_parts import load_isolator
from wirerope_mj.mounts.vendor_parts.comparison import compare
from wirerope_mj.mounts.vendor_parts.law_values import Secant, relaxed_force, secant
from wirerope_mj.mounts.vendor_parts.secants import ElasticShape, fit_damped, fit_secants
from wirerope_mj.mounts.vendor_parts.sheet import read_datasheet, two_stiffnesses
from wirerope_mj.mounts.vendor_parts.sheet_fit import fit_datasheet

FILES = {path.stem: path for path in sorted(catalogue_folder().glob("*.toml"))}
SHEETS = {path.stem: path for path in sorted((catalogue_folder() / "datasheets").glob("*.toml"))}

# Vendor figures typed here once more in SI units, so that neither a data sheet nor a file can drift unseen:
# compression travel, Kv, Ks; shear travel, Kv, Ks; amplitude of Kv in both; static load; damping range.
STIFFNESS = {
    "enidine_wr12_400": (0.0401, 242e3, 110e3, 0.0422, 77e3, 77e3, (0.002807, 0.002954), 1068.0, (0.05, 0.15)),
    "enidine_wr16_400": (0.0432, 613e3, 278e3, 0.0452, 173e3, 173e3, (0.003024, 0.003164), 2869.0, (0.05, 0.15)),
    "enidine_wr16_700": (0.0599, 340e3, 137e3, 0.0569, 81e3, 81e3, (0.004193, 0.003983), 1957.0, (0.05, 0.15)),
    "enidine_wr20_600": (0.0495, 821e3, 356e3, 0.0521, 215e3, 215e3, (0.003465, 0.003647), 4204.0, (0.05, 0.15)),
    "socitec_cb1400_15": (
        0.03556,
        1142703.0,
        464086.0,
        0.04064,
        258312.0,
        189137.0,
        (0.00254, 0.00254),
        4160.0,
        (0.15, 0.20),
    ),
    "socitec_cb1400_30": (
        0.06096,
        394035.4,
        158489.8,
        0.06096,
        98071.03,
        73553.27,
        (0.00254, 0.00254),
        2610.0,
        (0.15, 0.20),
    ),
}
# Static force and deflection, shock force and deflection, resonance; compression, then shear and roll.
POINTS = {
    "socitec_cb1390_20": ((2820.0, 0.0068, 8460.0, 0.036, 6.0), (1410.0, 0.0096, 6740.0, 0.032, 6.5)),
    "socitec_cb1390_30": ((1980.0, 0.0073, 5960.0, 0.039, 6.2), (994.0, 0.0104, 5730.0, 0.042, 5.9)),
}
# The files hold nine digits and the damping search stops at 1e-13 of a yield deflection: 1e-6 is far above both.
EXACT = 1e-6
COMPARED_IN_SHEAR = {"socitec_cb1400_15"}  # its shear is fitted to a rack that the catalogue contradicts


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
    assert leaves(fit_datasheet(SHEETS[name]).to_dict()) == nearly(isolator(name))


def nearly(isolator):
    """Return the leaves of an isolator to eight digits: files hold nine, and the ninth depends on the processor."""
    expected = leaves(isolator.to_dict())
    return {key: pytest.approx(x, rel=2e-8) if isinstance(x, float) else x for key, x in expected.items()}


def leaves(content, path=""):
    """Return the values in dictionaries and lists by their paths."""
    if not isinstance(content, dict | list | tuple):
        return {path: content}
    entries = content.items() if isinstance(content, dict) else enumerate(content)
    return {key: leaf for name, value in entries for key, leaf in leaves(value, f"{path}/{name}").items()}


@pytest.mark.parametrize("name", STIFFNESS)
def test_secant_of_the_stated_amplitude_is_the_vibration_stiffness(name):
    part = isolator(name)
    _, axial, _, _, shear, _, amplitudes, _, _ = STIFFNESS[name]
    for law, amplitude, expected in ((part.axial, amplitudes[0], axial), (part.shear, amplitudes[1], shear)):
        if law is part.shear and name in COMPARED_IN_SHEAR:
            continue
        assert cyclic_test(law, amplitude)[0].secant_stiffness == pytest.approx(expected, rel=EXACT)


@pytest.mark.parametrize("name", STIFFNESS)
def test_secant_at_the_rated_travel_is_the_shock_stiffness(name):
    part = isolator(name)
    compression, _, axial, travel, _, shear, _, _, _ = STIFFNESS[name]
    assert -force_at(part.axial, -compression) / compression == pytest.approx(axial, rel=EXACT)
    if name not in COMPARED_IN_SHEAR:
        assert force_at(part.shear, travel) / travel == pytest.approx(shear, rel=EXACT)
        assert -force_at(part.shear, -travel) / travel == pytest.approx(shear, rel=EXACT)


@pytest.mark.quick
@pytest.mark.parametrize("name", STIFFNESS)
def test_damping_ratio_of_the_vibration_stiffness_is_the_sheets_and_at_1_mm_not_below_the_vendors_range(name):
    """VMC's range, 15 to 20 %, holds at 2.5 mm along the axis; at 1 mm its two parts have 11 to 14 %."""
    part, stated = isolator(name), read_datasheet(SHEETS[name])
    lowest, highest = STIFFNESS[name][-1]
    assert stated.damping_range == (lowest, highest)
    for law in part.axes.values():
        assert (lowest if "enidine" in name else 0.11) < cyclic_test(law, 1e-3)[0].damping_ratio < highest
    amplitude = STIFFNESS[name][6][0]
    assert stated.damping_amplitude == pytest.approx(amplitude, rel=1e-9)
    assert cyclic_test(part.axial, amplitude)[0].damping_ratio == pytest.approx(stated.compression.damping_target, rel=EXACT)


def fit_of_line(x, y):
    """R^2 of a straight line."""
    return np.corrcoef(x, y)[0, 1] ** 2


@pytest.mark.quick
@pytest.mark.parametrize("name", STIFFNESS)
def test_stiffness_is_linear_in_1_over_amplitude(name):
    """As measured on a rope in compression (Adv. Mech. Eng. 2021, 16878140211028058), where R^2 exceeds 0.95.

    VMC's two parts reach it. Enidine's do not: their damping is placed at 2.8 to 4.2 mm, below which the stiffness levels off.
    """
    amplitudes = np.linspace(1e-3, 15e-3, 15)
    stiffness = [loop.secant_stiffness for loop in cyclic_test(isolator(name).axial, list(amplitudes))]
    reached = {
        "enidine_wr12_400": 0.836,
        "enidine_wr16_400": 0.830,
        "enidine_wr16_700": 0.791,
        "enidine_wr20_600": 0.802,
    }
    found = fit_of_line(1.0 / amplitudes, stiffness)
    assert found > 0.95 if name not in reached else found == pytest.approx(reached[name], abs=1e-3)


@pytest.mark.parametrize("name", SHEETS)
def test_axial_curve_has_a_third_of_the_rope_loops_asymmetry(name):
    part, sheet = isolator(name), read_datasheet(SHEETS[name])
    loop = RopeLoop(sheet.shape)
    x = sheet.compression.travel * np.array([-1.0, -0.5, -0.2, 0.2, 0.5])
    spring = part.axial.laws[0]
    whole = replace(spring, k3=3.0 * spring.k3, c=3.0 * spring.c)
    elastic = np.array([relaxed_force(whole, deflection) for deflection in x]) / spring.k1
    wanted = loop.state(0.0, x).axial_force / loop.stiffness()[1, 1]
    # Ni's F2 (x + kappa x^3) has the elastica's secants to 1.6 % at worst (WR16-700); its own least squares says so.
    assert elastic == pytest.approx(wanted, rel=0.02)
    assert any("tension" in sentence and "rope loop" in sentence for sentence in part.provenance.assumed)


@pytest.mark.parametrize("name", SHEETS)
def test_the_scatter_of_the_asymmetry_reaches_from_none_to_that_of_the_rope_loop(name):
    """Two standard deviations above the third of it is the whole; what the bars leave open, 0.4 of it, adds a little."""
    part = isolator(name)
    assert part.spread.parameters == ("axial.laws[0].c", "axial.laws[1].c")
    covariance = np.array(part.spread.covariance)
    assert np.ptp(covariance) == 0.0  # both scales have one asymmetry
    deviation, c = np.sqrt(covariance[0, 0]), part.axial.laws[0].c
    assert c < deviation < 1.2 * c


@pytest.mark.parametrize("name", POINTS)
def test_force_deflection_points_are_met(name):
    part = isolator(name)
    compression, shear = POINTS[name]
    static, deflection, shock, travel, _ = compression
    assert -force_at(part.axial, -deflection) == pytest.approx(static, rel=EXACT)
    assert -force_at(part.axial, -travel) == pytest.approx(shock, rel=EXACT)
    static, deflection, shock, travel, frequency = shear
    # Three figures for two scales: the fit makes the largest error the least, 4.9 % for the -20 and 1.3 % for the -30.
    assert force_at(part.shear, deflection) == pytest.approx(static, rel=0.05)
    assert force_at(part.shear, travel) == pytest.approx(shock, rel=0.05)


@pytest.mark.quick
@pytest.mark.parametrize("name", SHEETS)
def test_both_sags_under_the_rated_load_stay_within_the_rated_travel(name):
    part = isolator(name)
    load, travel = part.limits.static_load, part.limits.travel.compression
    depths = np.linspace(0.0, travel, 4001)
    virgin = np.interp(load, -part.axial.trace(-depths).force, depths)
    relaxed = -relaxed_sag(part.axial, load, travel)
    # Long vibration lets z relax. Friction carries up to half of the rated load: the sag of three parts doubles.
    most = {"enidine_wr16_700": 2.03, "socitec_cb1390_20": 2.03, "socitec_cb1390_30": 2.07}
    assert 1.0 < relaxed / virgin < most.get(name, 2.0)
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


@pytest.mark.slow
def test_shaker_isolator_resonates_at_36_2_hz_at_half_a_g():
    law = isolator("sdof_36hz").axial
    frequency, peak = resonance(law, 0.5, np.arange(35.4, 37.1, 0.2))
    # The parabola on a grid of 0.2 Hz finds the peak within a few hundredths.
    assert frequency == pytest.approx(36.2, abs=0.05)
    assert 4.0 < peak / (0.5 * STANDARD_GRAVITY) < 8.0


@pytest.mark.slow
def test_shaker_resonance_moves_left_as_the_level_rises():
    law = isolator("sdof_36hz").axial
    weak, _ = resonance(law, 0.25, np.arange(36.8, 38.5, 0.2))
    strong, _ = resonance(law, 1.0, np.arange(32.4, 34.1, 0.2))
    assert weak == pytest.approx(37.6, abs=0.1)  # as the file states
    assert strong == pytest.approx(33.2, abs=0.1)


@pytest.mark.parametrize("asymmetry", [None, 12.0])
@pytest.mark.parametrize("shock", [200e3, 400e3])
def test_any_pair_of_stiffnesses_is_fitted(shock, asymmetry):
    stated = two_stiffnesses(0.04, 600e3, shock)
    law = fit_damped(stated, ElasticShape(asymmetry=asymmetry, cubic=150.0), damping=0.08, amplitude=1e-3)
    assert cyclic_test(law, 0.0028)[0].secant_stiffness == pytest.approx(600e3, rel=EXACT)
    assert -force_at(law, -0.04) / 0.04 == pytest.approx(shock, rel=EXACT)
    assert cyclic_test(law, 1e-3)[0].damping_ratio == pytest.approx(0.08, rel=EXACT)


def test_of_more_than_two_secants_the_largest_error_is_the_least():
    stated = tuple(
        Secant(deflection=x, stiffness=k, steady=steady)
        for x, k, steady in ((0.0025, 258e3, True), (0.0125, 163e3, True), (0.0208, 239e3, False))
    )
    law = fit_secants(stated, ElasticShape(asymmetry=None, cubic=500.0), 7e-4)
    errors = np.array([secant(law, one) / one.stiffness - 1.0 for one in stated])
    # Two scales and three figures: at the least largest error all three are equal in size and change their signs.
    assert np.abs(errors) == pytest.approx(np.abs(errors).max(), rel=1e-4)
    assert np.sign(errors).tolist() == [-1.0, 1.0, -1.0]


@pytest.mark.quick
def test_damping_out_of_reach_is_said_with_what_can_be_reached():
    stated = two_stiffnesses(0.04, 600e3, 300e3)
    with pytest.raises(ConvergenceError, match=r"damping ratio of 0\.6 .* damping ratios reach 0\.\d+ to 0\.\d+"):
        fit_damped(stated, ElasticShape(asymmetry=12.0, cubic=150.0), damping=0.6, amplitude=1e-3)


def test_secants_without_a_passive_law_are_said_with_what_they_ask_for():
    stated = two_stiffnesses(0.04, 300e3, 600e3)
    with pytest.raises(ConvergenceError, match=r"no passive law has the secants 300 N/mm .*ask for -\d+"):
        fit_secants(stated, ElasticShape(asymmetry=None, cubic=100.0), 1e-3)


def test_command_writes_the_file_and_prints_the_table(tmp_path, capsys):
    name = "enidine_wr12_400"
    assert main(["isolators", "fit", str(SHEETS[name]), str(tmp_path / "a.toml")]) == 0
    assert leaves(load_isolator(tmp_path / "a.toml").to_dict()) == nearly(isolator(name))
    printed = capsys.readouterr()
    assert re.search(r"45 degrees +shock stiffness +N/mm +65 +\d", printed.out)
    assert not printed.err


def test_table_judges_any_isolator_against_a_sheet():
    rows = compare(SHEETS["enidine_wr12_400"], isolator("enidine_wr16_400"))
    shock = next(row for row in rows if row.name == "shock stiffness")
    assert shock.vendor == pytest.approx(110.0)
    assert shock.error > 0.5  # a far stiffer mount


@pytest.mark.quick
@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("travel_mm = 40.1", "", r"\[compression\] `travel_mm` or `travel_in` is missing"),
        (
            "travel_mm = 40.1",
            "travel_mm = -40.1",
            r"\[compression\] `travel_mm` must be a finite number from 1e-09 to 1e\+09, got",
        ),
        (
            "travel_mm = 40.1",
            "travel_mm = true",
            r"\[compression\] `travel_mm` must be a finite number from 1e-09 to 1e\+09, got",
        ),
        (
            "travel_mm = 40.1",
            "travel_mm = 40.1\ncolour = 1",
            r"\[compression\] `colour` is unknown; known: travel_mm, travel_in",
        ),
        ("damping_target = 0.11", "", r"give either `damping_target` or `yield_deflection_mm`"),
        ("rope_mm = 9.5", "", r"`rope_mm` or `rope_in` is missing"),
        ("loops = 8", "loops = 8.5", r"`loops` must be an integer > 0, got 8.5"),
        ("shock_stiffness_N_per_mm = 110", "", r"\[compression\] it must state at least two stiffnesses or points"),
        ("travel_mm = 40.1", "travel_mm = 40.1\ncompared = ['colour']", r"`compared` names 'colour', which the table"),
        (
            "travel_mm = 40.1",
            "travel_mm = 40.1\npoints_mm_N = [[1, -2]]",
            r"`points_mm_N` must be a list of lists of 2 finite numbers from 1e-09 to 1e\+09, got",
        ),
        ("damping_target = 0.11", "damping_target = 0.4", r"`damping_target` must lie in the range"),
        ("[shear]", "[sheer]", r"`sheer` is unknown; known: .* Did you mean `shear`"),
        ('name = "Enidine WR12-400"', "name = 12", r"`name` must be a text, got 12"),
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
    assert main(["isolators", "fit", str(sheet), str(out)]) == 2
    assert str(sheet) in capsys.readouterr().err
    assert not out.exists()
