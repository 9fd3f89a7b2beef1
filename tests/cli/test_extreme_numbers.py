"""Numbers and texts at the ends of what a computer holds: one message, no line of code, nothing quoted over pages."""

import warnings

import numpy as np
import pytest
from commands import refused

import wirerope_mj as wr
from wirerope_mj.cli.app import _warnings_shown
from wirerope_mj.foundation.payload_limits import limit_from_text
from wirerope_mj.studies.calibration.fit import Coordinates

pytestmark = pytest.mark.quick

TINY, HUGE = ("5e-324", "1e-300"), ("1e300", "1e12")
LONG = "x" * 20_000
SHEET = """curve = "shock"
name = "a part"
source = "a sheet"
yield_deflection_mm = 1.0
static_load_N = 100.0
[compression]
shock_mm_N = [[1, 120], [5, 400], [10, 900]]
areas_mm_J = [[5, 2]]
travel_mm = 10.0
"""


@pytest.mark.parametrize("number", [*TINY, *HUGE])
@pytest.mark.parametrize("phrase", ["{} Hz 800 kg", "10 Hz {} kg", "{} kHz 800 kg 4 %", "10 Hz {} t x"])
def test_a_deck_that_no_deck_is_like_is_refused_with_what_one_is(number, phrase, capsys):
    text = refused(capsys, "modes", "shock_table", "--deck", phrase.format(number))
    assert "of a deck panel is from" in text or "must be > 0" in text


@pytest.mark.parametrize("number", [*TINY, "1e300"])
@pytest.mark.parametrize("key", ["yield_deflection_mm = 1.0", "static_load_N = 100.0", "travel_mm = 10.0", "5, 2]", "[1, 120]"])
def test_a_data_sheet_with_a_number_that_nobody_states_is_refused_at_its_key(number, key, here, capsys):
    changed = f"5, {number}]" if key == "5, 2]" else f"[1, {number}]" if key[0] == "[" else f"{key.split(' ')[0]} = {number}"
    (here / "sheet.toml").write_text(SHEET.replace(key, changed))
    assert "from 1e-09 to 1e+09" in refused(capsys, "isolators", "fit", "sheet.toml", "out.toml") or key[0] in "5["
    assert not (here / "out.toml").exists()


def test_a_rated_travel_in_metres_under_a_key_in_mm_is_named(here, capsys):
    (here / "sheet.toml").write_text(SHEET.replace("travel_mm = 10.0", "travel_mm = 0.01"))
    assert "is its unit another?" in refused(capsys, "isolators", "fit", "sheet.toml", "out.toml")


@pytest.mark.parametrize("number", [*TINY, "1e300"])
@pytest.mark.parametrize("limit", ["acceleration/rack = {} g", "clearance/rack = 1 1 {} mm"])
def test_a_limit_that_nothing_can_keep_or_exceed_is_refused(number, limit):
    with pytest.raises(ValueError, match="is from .* or 0 for none"):
        limit_from_text(limit.format(number))


@pytest.mark.parametrize(
    "text",
    [
        LONG, f"mount/*/stiffness = {LONG}", f"{LONG} = Uniform(1, 2)", f"a = Normal(1, 0.1, {LONG}",
        f"a = Normal({20_000 * '('}", f"a = Normal({20_000 * '-'}1, 2)", f"a = Normal(1, 2, {LONG}=3)",
        f"body/{LONG}/mass = Uniform(1, 2)",
    ],
)  # fmt: skip
def test_a_long_text_is_not_quoted_over_pages(text, here, capsys):
    said = refused(capsys, "study", "shock_table", "--vary", text, "--variants", "2", "--out", "s")
    assert len(said) < 1500
    assert (
        len(refused(capsys, "shock", "shock_table", "--half-sine", "5 g 11 ms z", "--limit", f"acceleration/{text} = 1 g"))
        < 3000
    )
    assert len(refused(capsys, "modes", "shock_table", "--deck", text)) < 1500


def test_warnings_of_libraries_are_one_line_without_code(capsys):
    with _warnings_shown():
        warnings.simplefilter("always")
        for _ in range(2):
            warnings.warn("overflow encountered in divide", RuntimeWarning, stacklevel=1)
    assert capsys.readouterr().err == "wirerope: warning: RuntimeWarning of a library: overflow encountered in divide\n"


def test_values_that_scatter_along_fewer_directions_than_there_are_have_coordinates():
    prior = wr.studies.calibration.fit.Prior(
        names=("a", "b"), units=("", ""), quantiles=lambda p: np.stack([1.0 + p[:, 0] + p[:, 1]] * 2, axis=1)
    )
    fit = type("Fit", (), {"normals": np.zeros(2), "covariance": np.eye(2)})()
    coordinates = Coordinates(prior, fit)
    u = np.array([[0.3, -0.1], [-0.1, 0.3]])
    bent = coordinates.from_normals(u)
    np.testing.assert_allclose(bent[0], bent[1], atol=1e-9)  # one value, one place: rounding of slopes
    assert np.abs(bent[0]).max() > 0.05


def test_a_deviation_below_the_digits_of_its_mean_is_refused():
    with pytest.raises(ValueError, match="no number holds values so close together"):
        wr.Normal(1.0, 5e-324, relative=True)


@pytest.mark.parametrize("duration", ["1e400", "nan", "-1.0", "5e-324"])
def test_a_job_of_no_duration_that_ends_is_refused_when_it_is_read(duration, here):
    text = f'model = "shock_table"\n[simulate]\nduration = {duration}\n[[case]]\nname = "a"\nhalf-sine = "5 g 11 ms z"\n'
    (here / "job.toml").write_text(text)
    with pytest.raises(wr.ModelError, match="`duration` must be"):
        wr.load_job(here / "job.toml")


@pytest.mark.parametrize("make", [lambda: wr.Normal(1.0, 1e308, relative=True), lambda: wr.Uniform(-1e308, 1e308)])
def test_a_distribution_whose_values_are_no_numbers_is_refused(make):
    with pytest.raises(ValueError, match="small enough for numbers|apart, got"):
        make()
