"""`draw` shows on matplotlib's axes what the report shows between its own."""

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.content.blocks import Chart, Curve, Field, Panel
from wirerope_mj.views.figure import chart_of


@pytest.fixture(autouse=True)
def no_windows(monkeypatch):
    mpl.use("Agg")
    yield
    plt.close("all")


X = np.linspace(1.0, 100.0, 50)
FULL = Panel(
    curves=[
        Curve(x=X, y=X, name="$5 mount", kind=0), Curve(x=X, y=2.0 * X, name="base", kind="base", dash="dashed"),
        Curve(x=X, y=3.0 * X, name="dots", kind=1, marks=True),
        Curve(x=X[:3], y=np.arange(3.0), name="bars", kind=2, bars=0.5, ends=np.column_stack([X[:3] - 1.0, X[:3] + 1.0])),
    ],
    ylabel="force [kN]", xlabel="frequency [Hz]", title="a $ title", limits=[("limit", 50.0)], xlimits=[("rated", 20.0)],
    dots=[(2.0, 3.0)], notes=[(2.0, 3.0, "here $", True)], bands=[("band", 3.0, 5.0)], log="x", xlim=(1.0, 100.0),
    yticks=[(0.0, "first"), (50.0, "second")],
    field=Field(x=X[:3], y=np.arange(3.0), values=np.array([[1.0, np.nan], [2.0, 3.0]]), name="used [%]", limit=2.5),
)  # fmt: skip


def results():
    system = wr.load_system("shock_table")
    pulse = wr.HalfSine(peak=50.0, duration=0.011, direction="z", start=0.01)
    response = wr.simulate(system, pulse, duration=0.1, timestep=1e-3)
    time, acceleration = response.time, response.bodies["block"].acceleration[:, 2]
    device = wr.load_isolator("enidine_wr12_400")
    loops = wr.cyclic_test(device.axial, amplitudes=[0.002, 0.005])
    return {
        "response": response, "isolator": device, "loops": loops, "loop": loops[0],
        "srs": wr.shock_response_spectrum(time, acceleration, np.geomspace(2.0, 80.0, 20)),
        "psd": wr.power_spectral_density(time, acceleration), "panel": FULL, "chart": Chart(rows=[[FULL, FULL], [FULL]]),
    }  # fmt: skip


@pytest.mark.quick
def test_every_curve_of_the_report_is_drawn_with_its_name():
    for name, result in results().items():
        figure, chart = wr.draw(result), chart_of(result)
        panels = [panel for row in chart.rows for panel in row]
        assert len(figure.axes) == len(panels), name
        for axes, panel in zip(figure.axes, panels, strict=True):
            drawn = [line.get_xydata() for line in axes.lines]
            for curve in panel.curves:
                wanted = np.column_stack([curve.x, curve.y])
                bars = np.column_stack([[bar.get_width() for bar in axes.patches], [bar.get_y() for bar in axes.patches]])
                assert any(np.array_equal(wanted, line) for line in drawn) or len(bars) >= len(wanted), (name, curve.name)
            names = {text.get_text() for text in (axes.get_legend().get_texts() if axes.get_legend() else ())}
            assert {curve.name for curve in panel.curves if curve.name} <= names, name
            assert (axes.get_xlabel(), axes.get_ylabel(), axes.get_title()) == (panel.xlabel, panel.ylabel, panel.title)
        figure.draw_without_rendering()  # no dollar sign is read as a formula


def test_a_panel_is_drawn_on_axes_that_are_there():
    figure, axes = mpl.pyplot.subplots()
    assert wr.draw(FULL, axes) is figure
    assert axes.get_xscale() == "log"
    assert [text.get_text() for text in axes.get_yticklabels()] == ["first", "second"]
    with pytest.raises(ValueError, match="`ax` takes one panel, and this chart has 2"):
        wr.draw(Chart(rows=[[FULL, FULL]]), axes)


def test_what_has_no_chart_is_refused():
    with pytest.raises(ValueError, match="nothing is known to draw of a dict"):
        wr.draw({})
