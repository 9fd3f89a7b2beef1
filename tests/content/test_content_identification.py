"""Charts of a fit: what their panels hold, that their marks stand in the page, and that they can be read."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest

from wirerope_mj.content.blocks import WIDTH, Chart, Curve, Panel
from wirerope_mj.content.identification import DRAWN_LOOPS, fit_chart, measures_chart, residual_chart
from wirerope_mj.mounts.identification.result import FittedLoop
from wirerope_mj.mounts.laws import Loop
from wirerope_mj.views.plots.svg_chart import chart_svg

POINTS = (-5e-3, -0.3e-3, 0.0)


def ellipse(amplitude, point, size=1e5):
    """Return a loop about a point that its rig holds to a micrometre."""
    angle = np.linspace(0.0, 2.0 * np.pi, 101)
    force, deflection = size * amplitude * np.sin(angle + 0.2), point + 1e-6 + amplitude * np.sin(angle)
    measured, fitted = (Loop.from_samples(deflection, ratio * force) for ratio in (1.0, 1.01))
    return FittedLoop(measured=measured, fitted=fitted, zero=0.0)


FITS = [ellipse(amplitude, point) for amplitude in (1e-3, 4e-3, 12e-3) for point in POINTS]


def panels_of(chart):
    return [panel for row in chart.rows for panel in row]


@pytest.mark.quick
def test_operating_points_are_those_of_the_test_and_no_places_of_a_grid():
    titles = [panel.title for panel in panels_of(fit_chart(FITS))]
    assert [title.split(":")[0] for title in titles[:3]] == [f"±1 about {point} mm" for point in ("-5", "-0.3", "0")]


@pytest.mark.quick
def test_operating_points_are_told_apart_by_colour():
    energy, stiffness = panels_of(measures_chart(FITS))
    assert [curve.name for curve in energy.curves] == [
        f"{what} about {point} mm" for point in ("-5", "-0.3", "0") for what in ("measured", "fitted")
    ]
    kinds = [curve.kind for curve in energy.curves]
    assert kinds[::2] == kinds[1::2]
    assert len(set(kinds)) == 3
    # An ellipse encloses pi a F_a sin(0.2); its secant runs between the tips, F_a cos(0.2) apart.
    for panel, exact in (
        (energy, [np.pi * 1e5 * a**2 * np.sin(0.2) for a in (1e-3, 4e-3, 12e-3)]),
        (stiffness, 3 * [100.0 * np.cos(0.2)]),
    ):
        # 100 chords enclose less than the circle by (2 pi / 100)^2 / 6 = 0.07 %.
        np.testing.assert_allclose(panel.curves[0].y, exact, rtol=1e-3)
        np.testing.assert_allclose(panel.curves[1].y, 1.01 * panel.curves[0].y)


@pytest.mark.quick
def test_residuals_of_all_loops_stand_on_one_scale_with_the_mean_of_each_branch():
    panels = panels_of(residual_chart(FITS))
    assert len({panel.ylim for panel in panels}) == 1
    up, down, samples = panels[-1].curves
    assert samples.marks
    np.testing.assert_allclose(sorted(samples.y), sorted(100.0 * FITS[-1].residual[:-1]))
    assert (np.diff(up.x) >= 0.0).all()
    assert (np.diff(down.x) <= 0.0).all()
    assert up.y.mean() > 0.0 > down.y.mean()  # 1 % too wide a loop is so on both sides


@pytest.mark.quick
def test_of_many_loops_twelve_are_drawn_from_the_smallest_to_the_largest():
    many = [ellipse(amplitude, 0.0) for amplitude in np.linspace(1e-3, 8.4e-3, 18)]
    panels = panels_of(fit_chart(many))
    assert len(panels) == DRAWN_LOOPS == 12
    assert panels[0].title.startswith("±1 mm")
    assert panels[-1].title.startswith("±8.4 mm")


@pytest.mark.quick
def test_a_single_fitted_value_is_a_line_that_can_be_seen():
    (energy, _) = panels_of(measures_chart(FITS[:1]))
    measured, fitted = energy.curves
    assert measured.x.size == 1
    assert np.ptp(fitted.x) > 0.0
    np.testing.assert_allclose(fitted.y, 1.01 * measured.y[0])


@pytest.mark.quick
def test_weak_forces_are_read_in_newtons():
    assert {panel.unit for panel in panels_of(fit_chart([ellipse(1e-3, 0.0, size=1e4)]))} == {"N"}
    assert {panel.unit for panel in panels_of(fit_chart(FITS))} == {"kN"}


@pytest.mark.quick
@pytest.mark.parametrize("draw", [fit_chart, residual_chart, measures_chart])
@pytest.mark.parametrize("fits", [FITS, FITS[:1]])
def test_a_chart_is_well_formed_and_stays_within_its_width(draw, fits):
    root = ElementTree.fromstring(chart_svg(draw(fits)))
    space = "{http://www.w3.org/2000/svg}"
    for path in root.iter(f"{space}path"):
        if path.get("data-name"):
            x = [float(pair[0]) for pair in re.findall(r"(-?[\d.]+) (-?[\d.]+)", path.get("d"))]
            assert min(x) >= 0.0
            assert max(x) <= WIDTH
    for text in root.iter(f"{space}text"):
        assert 0.0 <= float(text.get("x")) <= WIDTH


@pytest.mark.quick
def test_marks_are_dots_at_their_samples():
    x = np.array([0.0, 1.0, 0.5])
    chart = Chart(rows=[[Panel(curves=[Curve(x=x, y=x, name="dots", kind=0, marks=True)], ylabel="", ylim=(0.0, 1.0))]])
    (path,) = re.findall(r'<path ([^>]*data-name="dots"[^>]*)/>', chart_svg(chart))
    assert 'stroke-linecap="round"' in path
    low, middle, high = sorted(float(text) for text in re.findall(r"M([\d.]+) [\d.]+h", path))
    np.testing.assert_allclose((middle - low) / (high - low), 0.5, atol=1e-3)  # tenths of a pixel
