"""Pictures of a fit: what their words say, and that they can be read."""

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from wirerope_mj.mounts.identification.result import FittedLoop
from wirerope_mj.views.plots.identification import fit_figure, measures_figure, residual_figure

POINTS = (-5e-3, -0.3e-3, 0.0)
NAME = "a name of an isolator that somebody found worth writing in full, with batch, bench and day, axial: bouc-wen"


def ellipse(amplitude, point):
    """Return a loop about a point that its rig holds to a micrometre."""
    angle = np.linspace(0.0, 2.0 * np.pi, 101)
    force = 1e5 * amplitude * np.sin(angle + 0.2)
    return FittedLoop(
        deflection=point + 1e-6 + amplitude * np.sin(angle), measured=force, fitted=1.01 * force, zero=0.0
    )


FITS = [ellipse(amplitude, point) for amplitude in (1e-3, 4e-3, 12e-3) for point in POINTS]


@pytest.mark.quick
def test_operating_points_are_those_of_the_test_and_no_places_of_a_grid():
    titles = [panel.get_title() for panel in fit_figure(FITS, title="t").axes]
    assert [title.split(":")[0] for title in titles[:3]] == [f"±1 about {point} mm" for point in ("-5", "-0.3", "0")]


@pytest.mark.quick
def test_operating_points_are_told_apart_by_mark_and_colour():
    figure = measures_figure(FITS, title="t")
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == [
        f"{what} about {point} mm" for point in ("-5", "-0.3", "0") for what in ("fitted", "measured")
    ]
    lines = figure.axes[0].lines
    assert [line.get_color() for line in lines[::2]] == [line.get_color() for line in lines[1::2]]
    assert len({(line.get_color(), line.get_marker()) for line in lines}) == 6


@pytest.mark.parametrize("draw", [fit_figure, residual_figure, measures_figure])
@pytest.mark.parametrize("fits", [FITS, FITS[:1]])
def test_a_long_title_stays_within_the_picture(draw, fits):
    figure = draw(fits, title=NAME)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    title = figure.get_suptitle()
    assert title.replace("\n", " ") == NAME
    box = figure._suptitle.get_window_extent(canvas.get_renderer())
    assert box.x0 >= 0.0
    assert box.x1 <= figure.bbox.width
