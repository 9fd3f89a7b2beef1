"""The law from points of curves: closed forms, a vendor's curve, what is refused, and its places in files."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.foundation.errors import ModelError

pytestmark = pytest.mark.quick

CB1390 = {
    "deflection": [0.0, 6.8e-3, 36e-3], "force": [0.0, 2820.0, 8460.0], "symmetric": True,
    "amplitudes": [36e-3], "areas": [230.0], "yield_deflection": 1e-3,
}  # fmt: skip
"""Socitec CB1390-20 in compression: static and shock force at their deflections; the area is an example."""

PAGE = Path(__file__).parents[2] / "docs" / "laws.md"

LIMITS = {"deflection": [-0.01, 0.0, 0.01], "upper": [-100.0, 50.0, 300.0], "lower": [-200.0, -50.0, 100.0]}


def steady_area(law, amplitude):
    """Return the area of the cycle that the law closes on, of five."""
    work = law.trace([0.0] + [amplitude, -amplitude] * 5 + [amplitude]).work
    return work[-1] - work[-3]


def test_a_vendors_curve_is_traced_through_its_points_with_its_area():
    law = wr.Tabulated(**CB1390)
    points = np.array(CB1390["force"])
    traced = law.trace(CB1390["deflection"]).force
    # M holds the virgin curve less friction at the points: only rounding is between.
    np.testing.assert_allclose(traced, points, rtol=1e-12)
    mirrored = law.trace(-np.array(CB1390["deflection"])).force
    np.testing.assert_allclose(mirrored, -points, rtol=1e-12)
    # Ten lengths of memory separate the cycles: exp(-72).
    assert steady_area(law, 36e-3) == pytest.approx(230.0, rel=1e-11)


@pytest.mark.parametrize("amplitude", [1e-4, 1e-3, 5e-3, 0.03])
def test_area_of_constant_width_has_the_closed_form(amplitude):
    x_y = 1e-3
    law = wr.Tabulated(deflection=[-0.03, 0.03], upper=[-100.0, 300.0], lower=[-400.0, 0.0], yield_deflection=x_y)
    half, ratio = 150.0, amplitude / x_y
    path = [-amplitude, amplitude, -amplitude]
    loop = law.trace(path, initial_states=[-half * math.tanh(ratio)])
    expected = 4.0 * half * (amplitude - x_y * math.tanh(ratio))
    # The difference of the smallest amplitude cancels two digits; the elastic work of 4 J at the largest one is rounded.
    assert loop.work[-1] == pytest.approx(expected, rel=1e-11)
    assert loop.hysteretic_state[-1] == pytest.approx(loop.hysteretic_state[0], rel=1e-12)


def test_areas_of_several_amplitudes_are_met():
    sizes, areas = [5e-3, 10e-3, 36e-3], [5.0, 15.0, 80.0]
    law = wr.Tabulated(**{**CB1390, "amplitudes": sizes, "areas": areas})
    for size, area in zip(sizes, areas, strict=True):
        assert steady_area(law, size) == pytest.approx(area, rel=1e-11)
    np.testing.assert_allclose(law.trace(CB1390["deflection"]).force, CB1390["force"], rtol=1e-12)


def test_constant_width_is_vaiana_and_rosatis_law():
    x = np.linspace(-0.04, 0.04, 9)
    spring = 1e5 * x + 2e7 * x**3
    law = wr.Tabulated(deflection=x, upper=spring + 200.0, lower=spring - 200.0, yield_deflection=2e-3)
    elastic = wr.Tabulated(deflection=x, force=spring)
    other = wr.VaianaRosati(kb=0.0, f0=200.0, alpha=500.0)
    path = np.cumsum(np.random.default_rng(0).normal(size=400)) * 1e-3
    path *= 0.039 / np.abs(path).max()
    path[0] = 0.0
    loop, alone, friction = law.trace(path), elastic.trace(path), other.trace(path)
    # Rounding of forces of 6 kN and of works of 80 J.
    np.testing.assert_allclose(loop.force, alone.force + friction.force, rtol=0, atol=1e-11)
    np.testing.assert_allclose(loop.work, alone.work + friction.work, rtol=0, atol=1e-10)
    assert not elastic.trace(path).hysteretic_state.any()


@pytest.mark.parametrize("seed", range(60))
def test_friction_alone_never_gives_work(seed):
    """Widths that jump between nothing and much, and M = 0, whose potential would hide what friction gives."""
    rng = np.random.default_rng(seed)
    below, above = np.cumsum(rng.exponential(1.0, (2, rng.integers(1, 7))), axis=1)
    x = np.concatenate([-below[::-1], [0.0], above])
    half = rng.exponential(1.0, x.size) ** 3 * (rng.random(x.size) < 0.6)
    law = wr.Tabulated(deflection=x, upper=half, lower=-half, yield_deflection=10.0 ** rng.uniform(-3.0, 2.0), extrapolate=True)
    path = np.concatenate([[0.0], rng.normal(size=40) * rng.exponential(3.0)])
    work = law.trace(path).work
    assert work.min() >= -1e-12 * np.abs(work).max()  # rounding of its sum


def test_limit_curves_are_reached():
    law = wr.Tabulated(**LIMITS, yield_deflection=1e-4)
    loop = law.trace([0.0, 0.01, -0.01, 0.01])
    # A hundred yield deflections: exp(-100).
    np.testing.assert_allclose(loop.force[1:], [300.0, -200.0, 300.0], rtol=1e-12)


@pytest.mark.parametrize("sides", [{"force": [0.0, 60.0, 200.0]}, {"force": [0.0, 60.0, 200.0], "curve": "mid"}])
def test_symmetric_points_are_mirrored(sides):
    friction = {"amplitudes": [4e-3], "areas": [0.5], "yield_deflection": 1e-3}
    half = wr.Tabulated(deflection=[0.0, 4e-3, 0.01], symmetric=True, **sides, **friction)
    both = {key: [-v for v in value[:0:-1]] + value if key == "force" else value for key, value in sides.items()}
    whole = wr.Tabulated(deflection=[-0.01, -4e-3, 0.0, 4e-3, 0.01], **both, **friction)
    path = [0.0, 9e-3, -5e-3, 1e-3, -0.01]
    np.testing.assert_allclose(half.trace(path).force, whole.trace(path).force, rtol=0, atol=1e-11)


def test_beyond_the_table_the_end_slope_goes_on_if_that_is_stated():
    law = wr.Tabulated(**LIMITS, yield_deflection=1e-4, extrapolate=True)
    f = law.trace([0.0, 0.01, 0.02, 0.03]).force
    assert f[3] - f[2] == pytest.approx(f[2] - f[1], rel=1e-12)
    shut = wr.Tabulated(**LIMITS, yield_deflection=1e-4)
    with pytest.raises(
        ValueError, match=r"a deflection of 0.02 m is outside the table .* -0.01 to 0.01 m. `extrapolate = true`"
    ):
        shut.trace([0.0, 0.02])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"upper": [-100.0, -60.0, 300.0]}, r"`upper` must not lie below `lower`: at 0 m it lies 10 N below"),
        ({"deflection": [-0.01, 0.01, 0.0]}, "`deflection` must increase strictly, got 0.01 before 0"),
        ({"deflection": [0.0], "upper": [1.0], "lower": [0.0]}, "`deflection` must have at least 2 points, got 1"),
        ({"upper": [1.0]}, "`upper` must have one entry for each `deflection`, 3, got 1"),
        ({"deflection": [0.01, 0.02, 0.03]}, "`deflection` must reach from below zero to above, got 0.01 to 0.03 m"),
        ({"deflection": [0.0, 0.02, 0.03]}, "from zero on only if `symmetric` mirrors the points or `extrapolate`"),
        ({"force": [0.0, 1.0, 2.0]}, "give either `upper` and `lower`, the limit curves, or `force`"),
        ({"lower": []}, "`lower` must have one entry for each `deflection`, 3, got 0"),
        ({"yield_deflection": 0.0}, "`yield_deflection` must be > 0 for a law with hysteresis"),
        ({"areas": [1.0]}, "`areas` must have one entry for each of `amplitudes`, 0, got 1"),
        ({"areas": [1.0], "amplitudes": [0.01]}, "`areas` go with `force`"),
        ({"symmetric": True}, "`deflection` must begin at 0 where `symmetric` mirrors it, got -0.01 m"),
        ({"symmetric": 1.0}, "`symmetric` must be true or false, got 1.0"),
        ({"curve": "shock"}, "`curve` must be one of 'virgin', 'mid'"),
        ({"upper": "1, 2, 3"}, r"`upper` must be a list of finite numbers \[N\], got '1, 2, 3'"),
        ({"upper": [0.0, math.nan, 1.0]}, r"`upper` must be a list of finite numbers \[N\], got"),
        ({"upper": [400.0, 50.0, -100.0], "lower": [300.0, -50.0, -200.0], "yield_deflection": 1.0}, "must not fall at zero"),
    ],
)  # fmt: skip
def test_bad_curves_are_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        wr.Tabulated(**{**LIMITS, "yield_deflection": 1e-3, **changes})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"force": [10.0, 2820.0, 8460.0]}, '"virgin" curve must contain `deflection` 0 with `force` 0'),
        ({"areas": [-1.0]}, "every entry of `areas` must be > 0, got -1"),
        ({"amplitudes": [5e-3, 5e-3], "areas": [1.0, 2.0]}, "`amplitudes` must increase strictly"),
        ({"amplitudes": [6e-3, 60e-3], "areas": [5.0, 60.0]}, "`amplitudes` must end within the table, at 0.036 m, got 0.06 m"),
        ({"amplitudes": [5e-3, 36e-3], "areas": [5.0, 6.0]}, "smaller cycles make .* J of a cycle of 0.036 m already, .* 6 J"),
    ],
)  # fmt: skip
def test_bad_areas_are_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        wr.Tabulated(**{**CB1390, **changes})


FILE = """name = "CB1390-20"
[axial]
law = "tabulated"
symmetric = true
yield_deflection_mm = 1.0
amplitudes_mm = [36.0]
areas = [230]
"""


@pytest.mark.parametrize(
    "points",
    [
        "deflection_mm,force_daN\n0,0\n6.8,282\n36,846\n",
        "# a comment\ndeflection [mm]; force [kN]\n0;0\n6.8;2.82\n36;8.46\n",
    ],
)
def test_an_isolator_file_has_the_points_beside_it_or_in_it(tmp_path, points):
    (tmp_path / "curve.csv").write_text(points)
    (tmp_path / "a.toml").write_text(FILE + 'points = "curve.csv"\n')
    (tmp_path / "b.toml").write_text(FILE + "deflection_mm = [0, 6.8, 36]\nforce_daN = [0, 282, 846]\n")
    first, second = wr.load_isolator(tmp_path / "a.toml"), wr.load_isolator(tmp_path / "b.toml")
    assert first == second
    assert first.axial == wr.Tabulated(**CB1390)
    (tmp_path / "elsewhere").mkdir()
    first.save(tmp_path / "elsewhere" / "saved.toml")  # complete in itself
    assert wr.load_isolator(tmp_path / "elsewhere" / "saved.toml") == first


def test_the_page_enters_that_curve_in_under_ten_lines(tmp_path):
    text = re.search(r"```toml\n(\[axial\].*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)[1]
    assert len(text.splitlines()) < 10
    (tmp_path / "a.toml").write_text('name = "a"\n' + text)
    assert wr.load_isolator(tmp_path / "a.toml").axial == wr.Tabulated(**CB1390)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ("deflection,force_N\n0,0\n", 'curve.csv, line 1: column "deflection" has no unit'),
        ("deflection_mm,force_t\n0,0\n", 'column "force" has the unknown unit "t"'),
        (
            "deflection_mm,load_N\n0,0\n",
            'line 1: column "load_N" is not known; a curve has deflection, force, upper, lower',
        ),
        ("deflection_mm,force_N\n0,0\n1\n", "line 3: 1 cells where the header has 2 columns"),
        ("deflection_mm,force_N\n0,zero\n", 'line 2: "zero" in column "force" is not a number'),
        ("deflection_mm,force_N,force_kN\n0,0,0\n", 'column "force" appears twice'),
        ("", "the file is empty"),
        ("deflection_mm,force_N\n0,0\n", "`deflection` must have at least 2 points, got 1"),
        ("deflection_mm\n0\n1\n", "give either `upper` and `lower`"),
        (None, "curve.csv: no such file. A curve is a table with a header"),
    ],
)
def test_bad_files_of_points_are_refused(tmp_path, points, message):
    if points is not None:
        (tmp_path / "curve.csv").write_text(points)
    (tmp_path / "a.toml").write_text(FILE + 'points = "curve.csv"\n')
    with pytest.raises(ModelError, match=message) as error:
        wr.load_isolator(tmp_path / "a.toml")
    assert re.search(r"a\.toml, line \d+: \[axial\] ", str(error.value))


def test_what_stands_twice_or_without_a_file_is_refused(tmp_path):
    (tmp_path / "a.toml").write_text(FILE + "yield_deflection = 1e-3\n")
    with pytest.raises(ModelError, match=r"\[axial\] `yield_deflection` is stated twice"):
        wr.load_isolator(tmp_path / "a.toml")
    (tmp_path / "a.toml").write_text(FILE + "deflection_yd = [0, 3.6]\nforce_N = [0, 8460]\n")
    with pytest.raises(
        ModelError, match=r"\[axial\] `deflection_yd` is unknown; known: deflection, deflection_m, deflection_mm"
    ):
        wr.load_isolator(tmp_path / "a.toml")
    with pytest.raises(ModelError, match="`points` names a file, but this isolator was not read from a file"):
        wr.Isolator.from_dict({"name": "a", "axial": {"law": "tabulated", "points": "curve.csv"}})


def test_a_table_reaches_as_far_as_the_rated_travel():
    law = wr.Tabulated(**LIMITS, yield_deflection=1e-3)
    assert wr.Isolator(name="a", axial=law).axial == law  # a rating is not compulsory
    wr.Isolator(name="a", axial=law, limits=wr.Limits(travel=wr.Travel(compression=0.01)))
    with pytest.raises(ValueError, match=r"its table ends .* inside the rated travel of 0.02 m"):
        wr.Isolator(name="a", axial=law, limits=wr.Limits(travel=wr.Travel(tension=0.02)))
    lopsided = wr.Tabulated(deflection=[-0.03, 0.0, 0.01], force=[-300.0, 0.0, 100.0])
    assert lopsided.travel_ends == (0.03, 0.01)
    wr.Isolator(name="a", axial=lopsided, limits=wr.Limits(travel=wr.Travel(compression=0.03)))
    one_sided = wr.Tabulated(deflection=[-0.03, 0.0], force=[-300.0, 0.0], extrapolate=True)
    assert one_sided.trace([0.0, 0.02]).force[-1] == pytest.approx(200.0)
