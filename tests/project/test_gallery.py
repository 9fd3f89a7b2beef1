"""The gallery: what its captions state holds, by closed forms, and its page is what its command writes."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq, minimize_scalar
from scipy.special import hyp2f1

import wirerope_mj as wr
from wirerope_mj.dynamics.single_mass.balance import harmonic_balance

GALLERY = Path(__file__).parents[2] / "docs" / "gallery"
pytestmark = [
    pytest.mark.slow,  # all figures are computed anew, sweeps and branches among them
    pytest.mark.skipif(not GALLERY.is_dir(), reason="the gallery stands in a checkout only"),
]

HERE = {f"3.{number}" for number in (*range(1, 11), *range(12, 23))} | {"S.1", "S.2"}
# Peak force and area of closed loops, alpha = n = 1, from an event-split integration: (beta, gamma, amplitude).
REFERENCE = {
    (0.8, 0.2, 1): (0.7488105660, 0.8309464386),
    (0.8, 0.2, 2): (0.9608865002, 3.8868885201),
    (0.5, 0.5, 1): (0.7215354572, 0.5932447550),
    (0.5, 0.5, 2): (0.9525215090, 3.2826167390),
    (0.5, -0.5, 2): (2.6934413590, 4.4808609183),
}
TYPES = {"3.1": (0.8, 0.2), "3.2": (0.2, 0.8), "3.3": (0.5, 0.5), "3.4": (0.8, -1.0), "3.5": (0.5, -0.5)}


@pytest.fixture(scope="module")
def gallery():
    """Return the gallery's figures by number."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(GALLERY))
        from figures import all_figures

        yield {figure.number: figure for figure in all_figures()}


def reach(z, total, n=1.0):
    """Return the deflection over which |z| grows from 0 at the slope 1 - total |z|^n."""
    return z * hyp2f1(1.0, 1.0 / n, 1.0 + 1.0 / n, total * z**n)


def closed_loop(beta, gamma, amplitude, n=1.0):
    """Return peak force and area of the closed loop with alpha = 1, by its integrals."""
    bound = (1.0 / (beta + gamma)) ** (1.0 / n) if beta + gamma > 0.0 else 50.0
    peak = brentq(lambda z: reach(z, gamma - beta, n) + reach(z, gamma + beta, n) - 2.0 * amplitude, 0.0, bound * (1.0 - 1e-13))
    area = quad(lambda z: z / (1.0 - (beta + gamma) * z**n) - z / (1.0 + (beta - gamma) * z**n), 0.0, peak)[0]
    return peak, 2.0 * area


def test_gallery_holds_every_figure_that_shows_numbers(gallery):
    assert set(gallery) == HERE
    page = (GALLERY / "README.md").read_text(encoding="utf-8")
    assert "3.11" in page.split("## Not here")[1]


def test_page_is_what_the_command_writes(gallery):
    from figures.page import page

    # Numbers in it are rounded to four digits at most, so that another machine writes the same.
    assert (GALLERY / "README.md").read_text(encoding="utf-8") == page(list(gallery.values())), (
        "run `python docs/gallery/build.py` and commit what it writes"
    )


def test_pictures_are_there_and_light(gallery):
    sizes = {path.name: path.stat().st_size for path in GALLERY.glob("*.png")}
    assert set(sizes) == {figure.file for figure in gallery.values()}
    assert max(sizes.values()) < 150_000
    assert sum(sizes.values()) < 1_500_000


@pytest.mark.parametrize("number", sorted(HERE))
def test_every_figure_draws_panels_with_units(gallery, number):
    picture = gallery[number].draw()
    for panel in picture.axes:
        assert panel.get_title()
        # The normalised panel of 3.10 names the ratios that it shows.
        assert "[" in panel.get_xlabel() or " / " in panel.get_xlabel()
        assert "[" in panel.get_ylabel() or " / " in panel.get_ylabel()
        assert len(panel.get_lines()) > 2  # more than the two lines through the origin


@pytest.mark.parametrize("number", TYPES)
def test_five_types_slope_at_zero_and_jumps(gallery, number):
    beta, gamma = TYPES[number]
    n = gallery[number].numbers
    # The place of zero force is interpolated between samples 3e-3 apart: the slope there is off by 1e-6 to 1e-5.
    assert n["slope_at_zero_rising"] == pytest.approx(1.0, abs=1e-5)
    assert n["slope_at_zero_falling"] == pytest.approx(1.0, abs=1e-5)
    # Tangents at the reversal are extrapolated from samples 5e-6 of the amplitude apart.
    assert n["jump"] == pytest.approx(2.0 * beta * n["peak_2"], rel=1e-6)
    assert n["loading"] == pytest.approx(1.0 - (beta + gamma) * n["peak_2"], rel=1e-6)
    assert n["unloading"] == pytest.approx(1.0 + (beta - gamma) * n["peak_2"], rel=1e-6)


def test_five_types_are_told_apart_by_their_slopes(gallery):
    slopes = {number: (gallery[number].numbers["loading"], gallery[number].numbers["unloading"]) for number in TYPES}
    assert all(slopes[number][0] < 0.1 for number in ("3.1", "3.2", "3.3"))  # softening
    assert slopes["3.4"][0] > 1.5  # hardening
    assert slopes["3.5"][0] == pytest.approx(1.0, abs=1e-6)  # quasi-linear
    assert slopes["3.1"][1] > 1.5
    assert slopes["3.2"][1] < 0.5
    assert slopes["3.3"][1] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("number", TYPES)
@pytest.mark.parametrize("amplitude", [1, 2])
def test_five_types_peak_and_area(gallery, number, amplitude):
    n = gallery[number].numbers
    peak, area = closed_loop(*TYPES[number], amplitude)
    found = n[f"peak_{amplitude}"], n[f"area_{amplitude}"]
    # Both close the loop to 1e-10 of its force.
    assert found == pytest.approx((peak, area), rel=1e-8)
    reference = REFERENCE.get((*TYPES[number], amplitude))
    if reference is not None:
        assert found == pytest.approx(reference, rel=2e-9)  # ten decimals are given


def test_hardening_type_grows_thicker_than_in_proportion(gallery):
    n = gallery["3.4"].numbers
    assert n["area_2"] / n["area_1"] > 2.0 * 2.0  # a loop that only scaled would give four
    assert wr.BoucWen(alpha=1.0, beta=0.8, gamma=-1.0, n=1.0).z_max == math.inf


def test_negative_beta_generates_energy_and_is_refused():
    assert closed_loop(-0.1, 0.5, 1.0)[1] < 0.0
    with pytest.raises(ValueError, match="`beta` must be > 0"):
        wr.BoucWen(alpha=1.0, beta=-0.1, gamma=0.5, n=1.0)


def test_redundant_pair_differs_in_area_and_not_in_peak_force(gallery):
    n = gallery["3.6"].numbers
    for amplitude in (1, 2):
        (force, area), (other_force, other_area) = (REFERENCE[b, g, amplitude] for b, g in ((0.8, 0.2), (0.5, 0.5)))
        assert n[f"force_{amplitude}"] == pytest.approx(force / other_force - 1.0, abs=1e-8)
        assert n[f"area_{amplitude}"] == pytest.approx(area / other_area - 1.0, abs=1e-8)
    assert n["force_1"] < 0.04
    assert n["area_1"] == pytest.approx(0.40, abs=0.005)
    assert n["first_loading"] < 1e-14
    # Small loops: W = 4 beta alpha A^3 / 3, so that the areas differ as 0.8 and 0.5; A = 0.05 is that small to 1e-3.
    assert n["small_area"] == pytest.approx(0.8 / 0.5 - 1.0, abs=1e-3)
    assert closed_loop(0.8, 0.2, 0.01)[1] == pytest.approx(4.0 * 0.8 * 0.01**3 / 3.0, rel=0.02)
    amplitudes = np.geomspace(0.2, 2.0, 60)
    worst = max(closed_loop(0.8, 0.2, a)[0] / closed_loop(0.5, 0.5, a)[0] - 1.0 for a in amplitudes)
    assert n["worst_force"] == pytest.approx(worst, abs=1e-4)  # both look at a grid, at a flat maximum
    assert 0.1 < n["along_1"] < 0.2  # forces apart inside the loop, where the areas are made


def test_peak_falls_and_damping_rises_with_beta_and_with_gamma(gallery):
    n = gallery["3.7"].numbers
    cases = {"beta": [(b, 0.2) for b in (0.2, 0.5, 0.8, 1.1)], "gamma": [(0.8, g) for g in (-1.0, -0.4, 0.2, 0.8)]}
    for name, pairs in cases.items():
        for place, (beta, gamma) in enumerate(pairs):
            peak, area = closed_loop(beta, gamma, 2.0)
            found = n[f"{name}_{place}_force"], n[f"{name}_{place}_area"]
            assert found == pytest.approx((peak, area), rel=1e-8)
            # From samples 1.2e-4 of the amplitude apart.
            assert n[f"{name}_{place}_jump"] == pytest.approx(2.0 * beta * peak, rel=1e-4)
        assert (np.diff([n[f"{name}_{place}_force"] for place in range(4)]) < 0.0).all()
        assert (np.diff([n[f"{name}_{place}_damping"] for place in range(4)]) > 0.0).all()
    assert n["beta_3_area"] < n["beta_2_area"] > n["beta_0_area"]  # not throughout
    assert (np.diff([n[f"gamma_{place}_area"] for place in range(4)]) < 0.0).all()
    # From hardening to softening: a straight line of slope alpha would end at the force that zero bending gives.
    loading = [1.0 - (b + g) * n[f"gamma_{place}_force"] for place, (b, g) in enumerate(cases["gamma"])]
    assert loading[0] > 1.0 > loading[1]


def symmetric_secant(amplitude):
    """Return the secant stiffness of the law of figure 3.8 in closed form, from its figures in the caption."""
    alpha, beta, gamma, k1, k3 = 2e5, 1200.0, 300.0, 5e4, 4e9

    def swept(z):
        return sum(-math.log1p(-total * z / alpha) / total for total in (gamma - beta, gamma + beta))

    z = brentq(lambda z: swept(z) - 2.0 * amplitude, 0.0, alpha / (beta + gamma) * (1.0 - 1e-13), xtol=1e-12)
    return z / amplitude + k1 + k3 * amplitude**2


def test_soft_hardening_has_a_least_secant_stiffness(gallery):
    n = gallery["3.8"].numbers
    least = minimize_scalar(symmetric_secant, bounds=(1e-3, 4e-3), method="bounded", options={"xatol": 1e-9})
    # The minimum is flat: a spline through amplitudes 75 um apart finds its value better than its place.
    assert n["least_amplitude"] == pytest.approx(least.x, rel=1e-3)
    assert n["least_stiffness"] == pytest.approx(least.fun, rel=1e-5)
    assert n["first_stiffness"] == pytest.approx(symmetric_secant(0.05e-3), rel=1e-8)
    assert n["last_stiffness"] == pytest.approx(symmetric_secant(5e-3), rel=1e-8)
    assert n["first_stiffness"] > 1.3 * n["least_stiffness"] < n["last_stiffness"]


def test_bouc_wen_law_never_softens_first_and_hardens_then(gallery):
    from figures import soft_hardening

    assert gallery["3.8"].numbers["plain_found"] == 0
    x = np.linspace(0.0, 4e-3, 2001)
    for beta, gamma in soft_hardening.PLAIN:
        # 1/K over s = z0^n: each term of the integral is convex in s, so no maximum of 1/K and no minimum of K.
        top = min(4.0, 0.999 / max(beta + gamma, 1e-9))
        s = np.linspace(0.01, top, 400)
        inverse = np.array([reach(v, gamma + beta) + reach(v, gamma - beta) for v in s]) / (2.0 * s)
        assert (np.diff(inverse, 2) > -1e-12).all()
        # The thesis' own argument: for z > 0 the slope goes one way only.
        slope = np.diff(soft_hardening.plain(beta, gamma).trace(x).force)
        change = np.diff(slope) / slope.max()
        assert (change < 1e-8).all() or (change > -1e-8).all()
    slope = np.diff(soft_hardening.SYMMETRIC.trace(x).force)
    assert 0 < np.argmin(slope) < slope.size - 1
    assert slope[0] > 1.5 * slope.min() < slope[-1]


def test_hardening_overlap_tells_ni_from_bouc_wen(gallery):
    n = gallery["3.9"].numbers
    assert n["overlap_ni"] < 0.02
    assert n["overlap_hardening"] > 0.2
    # With z > 0 on both paths the gap is e^(-(beta + gamma) x), times F2 = 2^(200 x) for Ni's law. Samples are 12 um apart.
    assert n["growth_ni"] == pytest.approx(math.exp(-2500.0 * 0.5e-3) * 2.0 ** (200.0 * 0.5e-3), rel=1e-3)
    assert n["growth_hardening"] == pytest.approx(math.exp(0.2 * 0.5), rel=1e-3)
    assert n["overlap_ni"] < n["overlap_saturating"] < 0.1


def test_alpha_is_the_slope_at_zero_and_scales_the_loop(gallery):
    n = gallery["3.10"].numbers
    peak, area = closed_loop(0.5, -0.4, 2.0)
    for alpha in (0.5, 1.0, 2.0):
        # The place of zero force is interpolated between samples 3e-2 apart.
        assert n[f"slope_{alpha:g}"] == pytest.approx(alpha, rel=1e-4)
        assert n[f"force_{alpha:g}"] == pytest.approx(alpha * peak, rel=1e-8)
        assert n[f"area_{alpha:g}"] == pytest.approx(alpha * area, rel=1e-8)


def test_larger_n_is_sharper_and_elasto_plastic_in_the_limit(gallery):
    n = gallery["3.10"].numbers
    widths = []
    for exponent in (0.5, 1.0, 2.0, 10.0, 100.0):
        begin, end = (share ** (1.0 / exponent) for share in (0.1, 0.9))
        widths.append(n[f"width_{exponent:g}"])
        # In units of x_y = z_max / alpha; the slope is found between 20001 samples.
        assert widths[-1] == pytest.approx(reach(end, 1.0, exponent) - reach(begin, 1.0, exponent), rel=1e-4)
        assert n[f"bound_{exponent:g}"] == pytest.approx(10.0 ** (1.0 / exponent), rel=1e-12)
    for exponent in (
        0.5,
        1.0,
        2.0,
        10.0,
    ):  # at n = 100 the peak is the bound, and the integrals of the reference diverge
        assert n[f"n_area_{exponent:g}"] == pytest.approx(closed_loop(0.5, -0.4, 2.0, exponent)[1], rel=1e-6)
    assert (np.diff(widths) < 0.0).all()
    # What is left of the corners shrinks as 1/n: three per cent at n = 100.
    assert n["n_area_100"] == pytest.approx(n["ideal_area"], rel=0.03)
    assert n["unloading_10"] == pytest.approx(10.0, rel=0.01)


def test_hysteretic_force_saturates_and_elastic_force_is_odd(gallery):
    n = gallery["3.18"].numbers
    assert n["bound"] == pytest.approx(2e5 / 2500.0, rel=1e-12)
    assert n["z_share"] == pytest.approx(1.0 - math.exp(-2500.0 * 4e-3), rel=1e-9)
    assert n["z_largest"] <= n["bound"]
    assert n["f1_tension"] == pytest.approx(1.1e5 * 4e-3 - 1.5e7 * 4e-3**2 + 1.5e9 * 4e-3**3, rel=1e-9)
    assert n["f1_compression"] == pytest.approx(-n["f1_tension"], rel=1e-9)


def test_factor_is_one_at_zero_and_only_the_product_of_its_parameters_acts(gallery):
    n = gallery["3.19"].numbers
    assert n["f2_zero"] == 1.0
    assert n["f2_tension"] == pytest.approx(2.0 ** (200.0 * 4e-3), rel=1e-12)
    assert n["f2_tension"] * n["f2_compression"] == pytest.approx(1.0, rel=1e-12)
    from dataclasses import replace

    from figures.modified import LAW

    x = 4e-3 * np.sin(np.linspace(0.0, 10.0, 101))
    same = replace(LAW, b=math.e, c=LAW.c * math.log(LAW.b))
    np.testing.assert_allclose(same.trace(x).force, LAW.trace(x).force, rtol=1e-12, atol=1e-10)


def rising_z(x, peak):
    """Return z [N] on the rising branch of the loop of +-4 mm of figures 3.18 to 3.20, that begins at -peak."""
    alpha, beta, gamma = 2e5, 2000.0, 500.0
    travelled, q = x + 4e-3, alpha / (beta - gamma)
    to_zero = math.log1p(peak / q) / (beta - gamma)
    if travelled < to_zero:
        return q - (peak + q) * math.exp(-(beta - gamma) * travelled)
    return alpha / (beta + gamma) * (1.0 - math.exp(-(beta + gamma) * (travelled - to_zero)))


def test_factor_hardens_tension_and_softens_compression(gallery):
    n = gallery["3.20"].numbers
    assert n["product_error"] < 1e-9  # [N]: F = F2 (z + F1) along the whole path
    assert n["tip_plain"] == pytest.approx(n["bound"] + n["f1_tension"], rel=1e-6)  # z is saturated to 5e-9
    ratio = n["f2_tension"] / n["f2_compression"]
    assert n["tip_tension"] / -n["tip_compression"] == pytest.approx(ratio, rel=1e-9)
    assert n["tip_tension"] > n["tip_plain"] > -n["tip_compression"]
    rate = 200.0 * math.log(2.0)
    for at in (-4, -2, 2, 4):
        x, sign = at * 1e-3, math.copysign(1.0, at)
        fade = math.exp(-2500.0 * abs(x))
        total = sign * 80.0 * (1.0 - fade) + 1.1e5 * x - sign * 1.5e7 * x**2 + 1.5e9 * x**3
        slope = 2e5 * fade + 1.1e5 - 3e7 * abs(x) + 4.5e9 * x**2
        # Central differences over 2e-6 of the deflection lose six digits of the force.
        assert n[f"tangent_{at}"] == pytest.approx(math.exp(rate * x) * (slope + rate * total), rel=1e-6)
    assert n["tangent_4"] > 1.3 * n["tangent_2"]
    assert n["tangent_-4"] < 0.5 * n["tangent_-2"]


def test_factor_changes_the_area_of_the_loop(gallery):
    n = gallery["3.20"].numbers
    peak = brentq(lambda z: rising_z(4e-3, z) - z, 0.0, 80.0)
    for key, rate in (("area", 200.0 * math.log(2.0)), ("area_plain", 0.0)):
        area = quad(lambda x, rate=rate: math.exp(rate * x) * (rising_z(x, peak) + rising_z(-x, peak)), -4e-3, 4e-3, limit=200)[
            0
        ]
        # The quadrature meets a kink of the slope on each branch.
        assert n[key] == pytest.approx(area, rel=1e-6)
    assert n["area"] > n["area_plain"]


# 1 kg on Bouc and Wen's law in kN and m, base 9.81 m/s^2: (alpha, beta, gamma, n)
DYNAMIC = {
    ("3.12", "beta_0.5"): (1.0, 0.5, -0.4, 1.0),
    ("3.12", "beta_1.1"): (1.0, 1.1, -0.4, 1.0),
    ("3.13", "gamma_0.4"): (1.0, 0.8, 0.4, 1.0),
    ("3.14", "half"): (1.0, 0.5, 0.5, 1.0),
    ("3.14", "most"): (1.0, 0.8, 0.2, 1.0),
    ("3.15", "alpha_2"): (2.0, 0.5, -0.4, 1.0),
    ("3.16", "n_0.5"): (1.0, 0.5, -0.4, 0.5),
    ("3.16", "n_2"): (1.0, 0.5, -0.4, 2.0),
}


@pytest.mark.parametrize(("number", "name"), DYNAMIC)
def test_resonances_are_those_of_harmonic_balance(gallery, number, name):
    n = gallery[number].numbers
    alpha, beta, gamma, power = DYNAMIC[number, name]
    unit = 1000.0 ** (1.0 - power)
    law = wr.BoucWen(alpha=1000.0 * alpha, beta=beta * unit, gamma=gamma * unit, n=power)
    amplitudes = [
        harmonic_balance(law, mass=1.0, frequency=share * n[f"{name}_frequency"], acceleration=9.81, harmonics=9, samples=256)
        for share in (0.99, 1.0, 1.01)
    ]
    before, at, behind = (orbit.amplitude for orbit in amplitudes)
    # 128 steps in a period and 9 harmonics: each is off by some 1e-4; the parabola over +-0.4 % by 1e-4 too.
    assert n[f"{name}_amplitude"] == pytest.approx(at, rel=1e-3)
    assert at > max(before, behind)
    assert n[f"{name}_unstable"] == 0.0


def falls(values):
    return all(b < a for a, b in zip(values, values[1:], strict=False))


def test_resonances_follow_the_parameters_as_the_thesis_says(gallery):
    def over(number, names, quantity):
        return [gallery[number].numbers[f"{name}_{quantity}"] for name in names]

    betas, gammas = ("beta_0.5", "beta_0.8", "beta_1.1"), ("gamma_-0.4", "gamma_0", "gamma_0.4")
    alphas, powers = ("alpha_0.5", "alpha_1", "alpha_2"), ("n_0.5", "n_1", "n_2", "n_10")
    for number, names in (("3.12", betas), ("3.13", gammas)):
        assert falls(over(number, names, "amplitude"))
        assert falls(over(number, names, "frequency"))
    assert falls(over("3.15", alphas[::-1], "amplitude"))
    assert falls(over("3.15", alphas[::-1], "frequency"))
    assert falls(over("3.16", powers, "frequency"))
    assert falls(over("3.16", powers[::-1], "amplitude"))
    half, most = over("3.14", ("half", "most"), "amplitude"), over("3.14", ("half", "most"), "frequency")
    assert half[0] / half[1] == pytest.approx(1.22, abs=0.01)
    assert most[1] / most[0] == pytest.approx(1.014, abs=0.001)
    # All sweeps go up: their peaks come later and are lower.
    assert min(np.subtract(over("3.12", betas, "swept_frequency"), over("3.12", betas, "frequency"))) > 0.1
    assert max(np.subtract(over("3.12", betas, "swept_amplitude"), over("3.12", betas, "amplitude"))) < 0.0


def test_resonance_grows_with_the_root_of_alpha(gallery):
    n = gallery["3.15"].numbers
    for alpha in (0.5, 1.0, 2.0):
        estimate = math.sqrt(3.0 * math.pi * 9.81 * 1000.0 * alpha / (4.0 * 0.5))
        # Equivalent linearisation at small amplitudes; these are a fifth of the bound.
        assert n[f"alpha_{alpha:g}_amplitude"] == pytest.approx(estimate, rel=0.07)
    assert n["alpha_2_amplitude"] / n["alpha_0.5_amplitude"] == pytest.approx(2.0, rel=0.04)


def test_large_exponents_ring_on_at_the_frequency_of_the_spring(gallery):
    n, own = gallery["3.17"].numbers, math.sqrt(1000.0) / (2.0 * math.pi)
    ratio = 10.0 / own
    # A linear mass from rest: forced a / (r^2 - 1), free a r / (r^2 - 1) with r = f / f_0; the loop of n = 10 loses nothing.
    assert n["large_forced"] == pytest.approx(9.81 / (ratio**2 - 1.0), rel=1e-3)
    assert n["large_own"] == pytest.approx(n["linear"], rel=1e-3)
    assert n["linear"] == pytest.approx(9.81 * ratio / (ratio**2 - 1.0))
    assert n["beside_own_frequency"] == pytest.approx(own, abs=0.01)  # not 4.75 Hz, half of what it is excited with
    assert n["beside_own"] == pytest.approx(9.81 * (9.5 / own) / ((9.5 / own) ** 2 - 1.0), rel=1e-3)
    assert n["small_own"] < 1e-3
    assert n["large_multiplier"] == pytest.approx(1.0, abs=1e-5)
    assert n["small_multiplier"] == pytest.approx(0.62, abs=0.01)
    # Energy A^2/2 alpha, loop 4 beta alpha^n A^(n+2) / (n+2), in kN and m.
    assert n["loss_half"] == pytest.approx(8.0 * 0.5 * 0.01**0.5 / 2.5)
    assert n["loss_one"] == pytest.approx(8.0 * 0.5 * 0.01 / 3.0)


def test_beat_of_forced_and_free_motion_stands_still_at_twice_the_own_frequency(gallery):
    n = gallery["3.17"].numbers
    assert n["ragged_beside"] > 10.0 * n["ragged_twice"]
    # Within 0.1 Hz the forced share itself changes by 0.2 Hz of 10, twice, and by a little more for the resonance below.
    assert n["ragged_twice"] < 0.06


def test_sweep_at_a_large_exponent_holds_what_the_resonance_left(gallery):
    n = gallery["3.16"].numbers
    assert n["n_10_swept_10"] > 100.0 * n["n_10_steady_10"]
    assert n["n_0.5_swept_10"] < 1.3 * n["n_0.5_steady_10"]
    assert n["n_10_steady_10"] == pytest.approx(9.81 / ((10.0 / 5.0329) ** 2 - 1.0), rel=1e-3)


def modified(*, symmetric=False):
    parts = {"alpha": 1e5, "beta": 500.0, "gamma": 0.0, "n": 1.0, "k1": 9.35e4, "k2": 0.0, "k3": 2e9}
    return wr.SymmetricBoucWen(**parts) if symmetric else wr.AsymmetricBoucWen(**parts, b=math.e, c=100.0)


def test_modified_law_softens_with_the_level(gallery):
    n = gallery["3.21"].numbers
    assert falls([n[f"frequency_{place}"] for place in range(4)])
    for place, level in ((1, 0.2), (2, 1.0)):
        orbit = harmonic_balance(
            modified(), mass=3.5, frequency=n[f"frequency_{place}"], acceleration=level * 9.80665, gravity=9.80665,
            harmonics=9, samples=256,
        )  # fmt: skip
        assert n[f"amplitude_{place}"] == pytest.approx(orbit.amplitude, rel=1e-3)
        assert n[f"unstable_{place}"] == 0.0
    assert n["swept_frequency"] > n["frequency_1"]
    assert n["swept_amplitude"] == pytest.approx(n["amplitude_1"], rel=0.01)


def test_superharmonics_lie_near_a_half_and_a_third(gallery):
    n = gallery["3.22"].numbers
    assert n["frequency_1"] == pytest.approx(36.2, abs=0.05)
    for order, thesis in ((2, 18.2), (3, 12.2)):
        assert n[f"ratio_{order}"] == pytest.approx(order, rel=0.011)
        assert n[f"frequency_{order}"] == pytest.approx(thesis, rel=0.005)
        orbit = harmonic_balance(
            modified(), mass=3.5, frequency=n[f"frequency_{order}"], acceleration=0.2 * 9.80665, gravity=9.80665, harmonics=15,
            samples=256,
        )  # fmt: skip
        # The gallery's motions have 42 steps in a period, and the resonance is narrow.
        assert n[f"amplitude_{order}"] == pytest.approx(orbit.harmonics[order], rel=0.03)
    assert n["symmetric_2"] < 1e-3
    assert n["symmetric_3"] > 0.3
