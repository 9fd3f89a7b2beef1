"""Figures of every kind are laid out once and drawn once, whatever they are written as."""

from io import BytesIO

import pytest
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from wirerope_mj.views.plots.plain_figure import PlainFigure


@pytest.fixture
def passes(monkeypatch):
    """Return the passes over figures, "layout" or "draw", in their order."""
    done = []
    draw, execute = Figure.draw, ConstrainedLayoutEngine.execute
    monkeypatch.setattr(Figure, "draw", lambda *given: (done.append("draw"), draw(*given))[1])
    monkeypatch.setattr(ConstrainedLayoutEngine, "execute", lambda *given: (done.append("layout"), execute(*given))[1])
    return done


def a_figure():
    figure = PlainFigure(layout="constrained")
    panel = figure.subplots()
    panel.plot([0.0, 1.0], [0.0, 1000.0], label="deck")
    panel.set_ylabel("force [kN]")
    figure.legend(loc="outside upper center")
    return figure


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_a_figure_is_laid_out_once_and_drawn_once(passes, ending):
    a_figure().savefig(BytesIO(), format=ending)
    assert passes == ["layout", "draw"]


def test_a_figure_written_again_keeps_its_layout(passes):
    figure = a_figure()
    figure.savefig(BytesIO())
    figure.savefig(BytesIO(), dpi=200)
    assert passes == ["layout", "draw", "draw"]


def test_the_layout_is_that_of_matplotlib():
    figure, usual = a_figure(), a_figure()
    figure.savefig(BytesIO())
    Figure.savefig(usual, BytesIO())
    assert figure.axes[0].get_position().bounds == usual.axes[0].get_position().bounds
