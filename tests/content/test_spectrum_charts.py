"""Charts of spectra: what the lines are, where the diagonals of the four-way paper lie, and files."""

import math

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.content.spectrum_charts import four_way_chart, power_densities_chart, shock_spectra_chart
from wirerope_mj.views.pictures import save_pictures

pytestmark = pytest.mark.quick

G = wr.STANDARD_GRAVITY
TIME = np.arange(4001) / 2000.0


def spectra():
    pulse = np.where(TIME < 0.011, 150.0 * np.sin(np.pi * TIME / 0.011), 0.0)
    ringing = 40.0 * np.exp(-8.0 * TIME) * np.sin(2.0 * np.pi * 7.0 * TIME)
    return {"base": wr.shock_response_spectrum(TIME, pulse), "rack": wr.shock_response_spectrum(TIME, ringing)}


def densities():
    rng = np.random.default_rng(1)
    return {name: wr.power_spectral_density(TIME, rng.normal(size=TIME.size)) for name in ("base", "rack")}


def panel_of(chart):
    ((panel,),) = chart.rows
    return panel


def named(chart):
    return {curve.name: curve for curve in panel_of(chart).curves if curve.name}


def test_four_way_paper_shows_pseudo_velocities():
    shown, drawn = spectra(), named(four_way_chart(spectra()))
    assert set(drawn) == {"base", "rack"}
    for name, curve in drawn.items():
        np.testing.assert_array_equal(curve.y, shown[name].pseudo_velocity)
        np.testing.assert_array_equal(curve.x, shown[name].frequencies)


def test_every_labelled_diagonal_goes_through_its_own_label():
    """A displacement d is the pseudo-velocity 2 pi f d, an acceleration a / (2 pi f)."""
    panel = panel_of(four_way_chart(spectra()))
    assert {text.split()[1] for _, _, text, _ in panel.notes} == {"mm", "g"}
    for f, v, text, _ in panel.notes:
        number, unit = text.split()
        found = v / (2.0 * math.pi * f) / 1e-3 if unit == "mm" else 2.0 * math.pi * f * v / G
        assert found == pytest.approx(float(number), rel=1e-9)


def test_diagonals_stay_on_the_paper_at_45_degrees():
    chart = four_way_chart(spectra())
    panel = panel_of(chart)
    for curve in panel.curves:
        if not curve.name:
            (x0, x1), (y0, y1) = np.log10(curve.x), np.log10(curve.y)
            assert abs(y1 - y0) == pytest.approx(x1 - x0)
            for values, (low, high) in ((curve.x, panel.xlim), (curve.y, panel.ylim)):
                assert (values >= low * (1.0 - 1e-9)).all()
                assert (values <= high * (1.0 + 1e-9)).all()


def test_accelerations_are_in_g_beside_a_test_spectrum():
    drawn = named(shock_spectra_chart(spectra(), test=([10.0, 100.0], [G, 10.0 * G])))
    np.testing.assert_allclose(drawn["base"].y * G, spectra()["base"].maximax)
    np.testing.assert_allclose(drawn["test spectrum"].y, [1.0, 10.0])


def test_densities_say_their_rms_and_how_well_they_are_known():
    found = densities()
    drawn = named(power_densities_chart(found))
    label = next(label for label in drawn if label.startswith("rack"))
    assert float(label.split()[1]) * G == pytest.approx(float(found["rack"].rms), rel=5e-3)  # three digits
    assert label.endswith(f"±{100.0 * found['rack'].standard_error:.0f} %")
    np.testing.assert_allclose(drawn[label].y * G**2, found["rack"].density[1:])


def test_a_base_that_rests_is_drawn_as_empty_paper(tmp_path):
    still = {"base": wr.shock_response_spectrum(TIME, np.zeros_like(TIME))}
    save_pictures([four_way_chart(still), shock_spectra_chart(still)], tmp_path / "still.png")


def test_several_directions_at_once_are_refused():
    three = {"rack": wr.shock_response_spectrum(TIME, np.ones((TIME.size, 3)))}
    with pytest.raises(ValueError, match=r"'rack' must be of one acceleration, got the shape \(\d+, 3\)"):
        four_way_chart(three)
